//! Promises without a matrix: the same products, solutions and folds as with matrices, and errors
//! instead of wrong results.

use crate::common::{Bratu, close};
use tangency::core::continuation::{Branch, Continuation, Settings};
use tangency::core::failure::Failure;
use tangency::core::linalg::{Border, Factors, Form, SpectrumRequest};
use tangency::core::problem::{Dynamics, Names, ZeroProblem};
use tangency::core::scalar::Scalar;
use tangency::core::system::{Dense, Kind, MatrixFree, Preconditioner, Sparse, System};

/// The inverse of the second difference with zero values at both ends, by two sums.
struct SecondDifference;

impl Preconditioner for SecondDifference {
    fn apply(&self, _z: &[f64], _p: &[f64], v: &mut [f64]) {
        let h = 1.0 / (v.len() + 1) as f64;
        let (mut slope, mut sum) = (0.0, 0.0);
        for v in v.iter_mut() {
            sum += h * slope;
            slope += h * *v;
            *v = sum;
        }
        let end = sum + h * slope;
        v.iter_mut().enumerate().for_each(|(i, v)| *v -= (i + 1) as f64 * h * end);
    }
}

/// A multiple of the identity.
struct Multiple(f64);

impl Preconditioner for Multiple {
    fn apply(&self, _z: &[f64], _p: &[f64], v: &mut [f64]) {
        v.iter_mut().for_each(|v| *v *= self.0);
    }
}

/// `r_i = a z_i + z_{i+1}² + p z_{i-1}/(i + 2)`, with cyclic indices: the matrix is not symmetric.
struct Ring(usize);

impl ZeroProblem for Ring {
    fn names(&self) -> Names {
        Names::new([("z", self.0)], ["a", "p"])
    }
    fn dynamics(&self) -> Dynamics {
        Dynamics::Flow
    }
    fn residual<T: Scalar>(&self, z: &[T], p: &[T], r: &mut [T]) {
        let n = self.0;
        for i in 0..n {
            let (next, before) = (z[(i + 1) % n], z[(i + n - 1) % n]);
            r[i] = p[0] * z[i] + next * next + p[1] * before / (i + 2) as f64;
        }
    }
}

/// Follows Bratu's problem past its fold.
fn followed(system: &mut dyn System) -> Branch {
    let settings = Settings { max_points: 30, ..Settings::default() };
    let solutions = Continuation::new(system).settings(settings);
    solutions.along("lambda", 0.0..=4.0).trace().expect("a branch")
}

#[test]
fn folds_are_those_of_sparse_matrices() {
    for n in [50, 100] {
        let free = followed(&mut MatrixFree::new(Bratu(n), SecondDifference));
        let sparse = followed(&mut Sparse::new(Bratu(n)));
        let [one, other] = [&free, &sparse].map(|it| it.of_kind(Kind::LP).next().expect("LP"));
        close(one.parameters[0], other.parameters[0], 1e-10);
        close(one.state[n / 2], other.state[n / 2], 1e-8);
        assert_eq!(free.points.len(), sparse.points.len());
        assert_eq!(free.method, "matrix-free");
        // Results that need a matrix are missing, with a reason.
        assert!(one.unstable.is_none() && free.points.iter().all(|it| it.unstable.is_none()));
        assert!(free.warnings.iter().any(|it| it.contains("branch points")), "{:?}", free.warnings);
    }
}

#[test]
fn bordered_systems_are_the_dense_ones() {
    let (n, m) = (30, 2);
    let x: Vec<f64> = (0..n).map(|i| (i as f64).sin()).chain([3.0, 0.5]).collect();
    let numbers = |count: usize, seed: f64| -> Vec<f64> {
        (0..count).map(|i| (seed + 1.7 * i as f64).cos()).collect()
    };
    let [columns, rows, corner] = [numbers(n * m, 1.0), numbers(n * m, 2.0), numbers(m * m, 3.0)];
    let border = Border { width: m, columns: &columns, rows: &rows, corner: &corner, units: &[] };
    let solutions = |system: &mut dyn System| {
        system.assemble(&x).expect("a matrix");
        let mut factors = Factors::default();
        system.factor(Form::Jacobian, border, &mut factors).expect("factors");
        let [mut plain, mut transposed] = [numbers(n + m, 4.0), numbers(n + m, 5.0)];
        factors.solve(&mut plain);
        factors.solve_transposed(&mut transposed);
        [plain, transposed].concat()
    };
    let free = solutions(&mut MatrixFree::new(Ring(n), Multiple(0.3)));
    let dense = solutions(&mut Dense::new(Ring(n)));
    free.iter().zip(&dense).for_each(|(a, b)| close(*a, *b, 1e-9));
}

#[test]
fn missing_results_have_reasons() {
    let mut system = MatrixFree::new(Bratu(20), SecondDifference);
    system.assemble(&[0.0; 21]).expect("a point");
    let oscillation = Form::Oscillation(1.0);
    let complex = system.factor(oscillation, Border::NONE, &mut Factors::default());
    assert!(matches!(complex, Err(Failure::Unsupported(reason)) if reason.contains("Hopf")));
    let spectrum =
        MatrixFree::new(Ring(20), Multiple(0.3)).spectrum(&[0.0; 22], SpectrumRequest::new(4));
    assert!(matches!(spectrum, Err(Failure::Undetermined(reason)) if reason.contains("stability")));
    // A preconditioner that loses its argument.
    let mut lost = MatrixFree::new(Bratu(20), Multiple(0.0));
    let outcome = Continuation::new(&mut lost).along("lambda", 0.0..=4.0).trace();
    let error = match outcome {
        Ok(branch) => format!("{:?} {:?}", branch.ends, branch.points.len()),
        Err(cause) => format!("{cause:?}"),
    };
    assert!(error.contains("Krylov method"), "{error}");
}
