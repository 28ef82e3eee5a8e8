//! Promise: a flow `M z' = F(z, p)` has the equilibria, eigenvalues, Hopf points and normal forms of
//! the same flow with its rates solved for; singular mass matrices among them.

use crate::common::{close, first};
use tangency::core::continuation::{Branch, Continuation, Settings, SpecialPoint};
use tangency::core::failure::Failure;
use tangency::core::linalg::{SpectrumRequest, finite_eigenvalues};
use tangency::core::problem::{Dynamics, Names, ZeroProblem};
use tangency::core::scalar::Scalar;
use tangency::core::system::{Dense, Kind, Sparse, System};

/// A flow, and a matrix by which it is multiplied.
#[derive(Clone, Copy, Debug)]
struct Multiplied {
    flow: Flow,
    by: Matrix,
}

#[derive(Clone, Copy, Debug)]
enum Flow {
    /// CO oxidation, with cusps, Bogdanov–Takens points and generalised Hopf points.
    Oxidation,
    /// A fold–Hopf point at `p = q = 0`.
    FoldHopf,
    /// A double Hopf point at `p = q = 0`.
    DoubleHopf,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Matrix {
    Identity,
    /// Depends on the parameters.
    Constant,
    /// Depends on the states, too.
    Varying,
}

impl Flow {
    fn dimension(self) -> usize {
        if let Flow::DoubleHopf = self { 4 } else { 3 }
    }

    /// The equilibrium where the branch begins, and the values of the parameters `q` and `p`.
    fn start(self) -> (Vec<f64>, [f64; 2]) {
        match self {
            Flow::Oxidation => (vec![0.001137, 0.891483, 0.062345], [2.0, 0.4]),
            Flow::FoldHopf => (vec![-1.0, 0.0, 0.0], [0.0, 1.0]),
            Flow::DoubleHopf => (vec![0.0; 4], [-1.0, -0.5]),
        }
    }

    fn rates<T: Scalar>(self, z: &[T], parameters: &[T]) -> Vec<T> {
        let [q, p] = [parameters[0], parameters[1]];
        match self {
            Flow::Oxidation => {
                let [x, y, s] = [z[0], z[1], z[2]];
                let free = T::one() - x - y - s;
                vec![
                    free * free * 5.0 - x * x * 2.0 - x * y * 10.0,
                    q * free - y * 0.1 - x * y * 10.0,
                    (free - p * s) * 0.0675,
                ]
            }
            Flow::FoldHopf => {
                let [v, x, y] = [z[0], z[1], z[2]];
                let square = x * x + y * y;
                vec![
                    v * v - p + square * 0.5 + x * v * x * 0.2,
                    (q + v) * x - y * 1.3 + x * y * 0.4 - x * square * 0.3,
                    x * 1.3 + (q + v) * y + x * x * 0.25 + v * y * 0.1,
                ]
            }
            Flow::DoubleHopf => {
                let [a, b, c, d] = [z[0], z[1], z[2], z[3]];
                vec![
                    q * a - b + a * c * 0.3 - a * (a * a + b * b) - a * c * c * 0.5,
                    a + q * b + c * c * 0.15,
                    p * c - d * 1.7 + a * a * 0.2 - c * (c * c + d * d) * 0.7 + c * b * b * 0.4,
                    c * 1.7 + p * d - a * d * 0.1,
                ]
            }
        }
    }
}

impl Matrix {
    fn times<T: Scalar>(self, z: &[T], p: &[T], v: &[T], products: &mut [T]) {
        let n = v.len();
        for (i, product) in products.iter_mut().enumerate() {
            *product = v[i];
            if self == Matrix::Identity {
                continue;
            }
            *product *= p[1] * 0.1 + 1.5 + 0.2 * i as f64;
            for (j, v) in v.iter().enumerate() {
                *product += *v * (0.2 * (1.0 + (3 * i + 5 * j) as f64).sin());
                if self == Matrix::Varying {
                    let (first, second) = (z[(i + j) % n], z[(i + 2 * j + 1) % n]);
                    *product += *v * (first * 0.15 + first * second * 0.1 + p[0] * first * 0.05);
                }
            }
        }
    }
}

impl ZeroProblem for Multiplied {
    fn names(&self) -> Names {
        let states = ["a", "b", "c", "d"].into_iter().take(self.flow.dimension());
        Names::new(states, ["q", "p"])
    }
    fn residual<T: Scalar>(&self, z: &[T], p: &[T], r: &mut [T]) {
        self.by.times(z, p, &self.flow.rates(z, p), r);
    }
    fn dynamics(&self) -> Dynamics {
        if self.by == Matrix::Identity { Dynamics::Flow } else { Dynamics::Implicit }
    }
    fn mass_product<T: Scalar>(&self, z: &[T], p: &[T], rates: &[T], products: &mut [T]) {
        self.by.times(z, p, rates, products);
    }
}

/// The branch of equilibria in `q`, and the curves of its Hopf points and its folds.
fn curves(flow: Flow, system: &mut dyn System) -> Vec<Branch> {
    let (z, [q, p]) = flow.start();
    let start = Continuation::new(&mut *system).from(&z).at("q", q).at("p", p);
    let mut all = vec![start.along("q", -1.0..=2.0).trace().unwrap()];
    for kind in [Kind::HB, Kind::LP] {
        let Some(point) = all[0].of_kind(kind).next() else { continue };
        let settings = Settings { max_points: 200, ..Settings::default() };
        let start = Continuation::new(&mut *system).restart(&all[0], point.label);
        let curve = start.hold(kind).along("p", -1.0..=2.0).along("q", -2.0..=3.0);
        all.push(curve.settings(settings).trace().unwrap());
    }
    all
}

/// Compares the special points of two branches: their parameters, eigenvalues and numbers.
fn compare(found: &Branch, expected: &Branch, tolerance: f64) {
    let kinds =
        |branch: &Branch| -> Vec<Kind> { branch.special.iter().map(|it| it.kind).collect() };
    assert_eq!(kinds(found), kinds(expected));
    for (found, expected) in found.special.iter().zip(&expected.special) {
        for (a, b) in found.parameters.iter().zip(&expected.parameters) {
            close(*a, *b, tolerance);
        }
        assert_eq!(found.unstable, expected.unstable, "{found:?}");
        let distance = |l: &(f64, f64), m: &(f64, f64)| (l.0 - m.0).hypot(l.1 - m.1);
        for l in &found.eigenvalues {
            let nearest = expected.eigenvalues.iter().map(|m| distance(l, m));
            // A double eigenvalue is determined to half of the digits only.
            let half = if expected.kind == Kind::BT { 1e-5 } else { 10.0 * tolerance };
            assert!(nearest.fold(f64::MAX, f64::min) < half, "{found:?}\n{expected:?}");
        }
        let names = |point: &SpecialPoint| -> Vec<String> {
            point.numbers.iter().map(|it| it.name.clone()).collect()
        };
        assert_eq!(names(found), names(expected));
        for (a, b) in found.numbers.iter().zip(&expected.numbers) {
            let size = b.value.abs().max(1.0);
            let close = (a.value - b.value).abs() <= 100.0 * tolerance * size;
            assert!(close, "{:?} {}: {} {}", found.kind, a.name, a.value, b.value);
        }
    }
}

/// Traces the curves of a flow, and compares them with the curves of the multiplied flow; the flow
/// must have special points of the given kinds.
fn changes_nothing(flow: Flow, kinds: &[Kind]) {
    let of = |by: Matrix| Multiplied { flow, by };
    let expected = curves(flow, &mut Dense::new(of(Matrix::Identity)));
    for kind in kinds {
        let points = expected.iter().flat_map(|branch| branch.of_kind(*kind));
        let counts: Vec<usize> = points.map(|point| point.numbers.len()).collect();
        assert!(!counts.is_empty() && !counts.contains(&0), "{kind:?}: {counts:?}");
    }
    for by in [Matrix::Constant, Matrix::Varying] {
        let systems: [Box<dyn System>; 2] =
            [Box::new(Dense::new(of(by))), Box::new(Sparse::new(of(by)))];
        for mut system in systems {
            let found = curves(flow, &mut *system);
            assert_eq!(found.len(), expected.len());
            for (found, expected) in found.iter().zip(&expected) {
                compare(found, expected, 1e-10);
            }
        }
    }
}

#[test]
fn a_regular_mass_matrix_does_not_change_bogdanov_takens_and_generalised_hopf_points() {
    changes_nothing(Flow::Oxidation, &[Kind::LP, Kind::HB, Kind::CP, Kind::BT, Kind::GH]);
}

#[test]
fn a_regular_mass_matrix_does_not_change_fold_hopf_points() {
    changes_nothing(Flow::FoldHopf, &[Kind::HB, Kind::ZH]);
}

#[test]
fn a_regular_mass_matrix_does_not_change_double_hopf_points() {
    changes_nothing(Flow::DoubleHopf, &[Kind::HB, Kind::HH]);
}

/// The pendulum in Cartesian coordinates, an index-3 system: `x' = u`, `y' = v`, `u' = −λ x − c u`,
/// `v' = −λ y − 1 − c v`, `0 = x² + y² − 1`. At rest below, its finite eigenvalues are the roots of `μ²
/// + c μ + 1`; at rest above, of `μ² + c μ − 1`.
struct Pendulum;

impl ZeroProblem for Pendulum {
    fn names(&self) -> Names {
        Names::new(["x", "y", "u", "v", "l"], ["c"])
    }
    fn residual<T: Scalar>(&self, z: &[T], p: &[T], r: &mut [T]) {
        let [x, y, u, v, l] = *z else { return };
        let g = T::one();
        r.copy_from_slice(&[u, v, -l * x - p[0] * u, -l * y - g - p[0] * v, x * x + y * y - 1.0]);
    }
    fn dynamics(&self) -> Dynamics {
        Dynamics::Implicit
    }
    fn mass_product<T: Scalar>(&self, _z: &[T], _p: &[T], rates: &[T], products: &mut [T]) {
        products.copy_from_slice(rates);
        products[4] = T::zero();
    }
}

#[test]
fn infinite_eigenvalues_of_index_three_are_left_out() {
    for (y, l, stiffness) in [(-1.0, 1.0, 1.0), (1.0, -1.0, -1.0)] {
        for sparse in [false, true] {
            let mut system: Box<dyn System> = if sparse {
                Box::new(Sparse::new(Pendulum))
            } else {
                Box::new(Dense::new(Pendulum))
            };
            let x = [0.0, y, 0.0, 0.0, l, 0.3];
            system.assemble(&x).unwrap();
            let request = SpectrumRequest::new(usize::MAX);
            let found = system.spectrum(&x, request).unwrap().unwrap();
            let discriminant: f64 = 0.09 - 4.0 * stiffness;
            let root = 0.5 * discriminant.abs().sqrt();
            let expected = match discriminant > 0.0 {
                true => [(-0.15 + root, 0.0), (-0.15 - root, 0.0)],
                false => [(-0.15, root), (-0.15, -root)],
            };
            assert_eq!(found.len(), 2, "{found:?}");
            for (found, expected) in found.iter().zip(expected) {
                close(found.0, expected.0, 1e-14);
                close(found.1, expected.1, 1e-14);
            }
        }
    }
}

#[test]
fn a_singular_pencil_is_refused() {
    // The unknown `y` occurs in no equation.
    let error = finite_eigenvalues(&[1.0, 2.0, 0.0, 0.0], &[1.0, 0.0, 0.0, 0.0], 2).unwrap_err();
    assert!(matches!(error, Failure::Undetermined(_)), "{error}");
}

/// A badly scaled regular matrix, for which `M⁻¹ A` loses digits.
#[test]
fn masses_of_different_sizes() {
    let found = finite_eigenvalues(&[-1.0, 0.0, 0.0, -2.0], &[1e-9, 0.0, 0.0, 1e9], 2).unwrap();
    close(found[0].0 / -2e-9, 1.0, 1e-15);
    close(found[1].0 / -1e9, 1.0, 1e-15);
    // det(A − λ M) = 1 + (13 + ε) λ + ε λ².
    let epsilon = 1e-9;
    let (a, m) = ([-1.0, 2.0, 3.0, -7.0], [1.0, 1.0, 1.0, 1.0 + epsilon]);
    let found = finite_eigenvalues(&a, &m, 2).unwrap();
    assert_eq!(found.len(), 2);
    close(found[0].0 * 13.0, -1.0, 1e-9);
    close(found[1].0 * epsilon / -13.0, 1.0, 1e-6);
}

/// Brusselators on a line that are coupled by diffusion, with the reaction as an algebraic unknown
/// `w = x² y` in every cell; without the algebraic unknowns for comparison.
struct Line {
    cells: usize,
    algebraic: bool,
}

impl ZeroProblem for Line {
    fn names(&self) -> Names {
        let n = self.cells;
        match self.algebraic {
            true => Names::new([("x", n), ("y", n), ("w", n)], ["b"]),
            false => Names::new([("x", n), ("y", n)], ["b"]),
        }
    }
    fn residual<T: Scalar>(&self, z: &[T], p: &[T], r: &mut [T]) {
        let n = self.cells;
        let laplacian = |u: &[T], i: usize| {
            let [left, right] = [u[i.saturating_sub(1)], u[(i + 1).min(n - 1)]];
            left - u[i] * 2.0 + right
        };
        let (x, y) = (&z[..n], &z[n..2 * n]);
        for i in 0..n {
            let reaction = if self.algebraic { z[2 * n + i] } else { x[i] * x[i] * y[i] };
            r[i] = reaction - (p[0] + 1.0) * x[i] + 1.0 + laplacian(x, i) * 3.0;
            r[n + i] = p[0] * x[i] - reaction + laplacian(y, i) * 7.0;
            if self.algebraic {
                r[2 * n + i] = reaction - x[i] * x[i] * y[i];
            }
        }
    }
    fn dynamics(&self) -> Dynamics {
        if self.algebraic { Dynamics::Implicit } else { Dynamics::Flow }
    }
    fn mass_product<T: Scalar>(&self, _z: &[T], _p: &[T], rates: &[T], products: &mut [T]) {
        products.copy_from_slice(rates);
        if self.algebraic {
            products[2 * self.cells..].fill(T::zero());
        }
    }
}

/// The first Hopf point is uniform: `b = 2`, `ω = 1`, `l₁ = −½/n` for `n` equal cells. The number of
/// unknowns is at most 240.
#[test]
fn algebraic_unknowns_in_every_cell() {
    for (cells, sparse) in [(4, false), (4, true), (80, true)] {
        for algebraic in [false, true] {
            let problem = Line { cells, algebraic };
            let mut z = vec![1.5; problem.names().dimension()];
            z[..cells].fill(1.0);
            let mut system: Box<dyn System> =
                if sparse { Box::new(Sparse::new(problem)) } else { Box::new(Dense::new(problem)) };
            let start = Continuation::new(&mut *system).from(&z).at("b", 1.5);
            let branch = start.along("b", 1.5..=2.002).trace().unwrap();
            let hopf = first(&branch, Kind::HB);
            close(hopf.parameters[0], 2.0, 1e-11);
            close(hopf.number("hopf_frequency").unwrap().value, 1.0, 1e-10);
            close(hopf.number("l1").unwrap().value * cells as f64, -0.5, 1e-9);
            close(hopf.number("growth_slope").unwrap().value, 0.5, 1e-9);
            assert_eq!(branch.points.last().unwrap().unstable, Some(2));
            let doubts = system.doubts();
            let uncertain = doubts.is_some_and(|doubts| doubts.contains("uncertain"));
            assert_eq!(uncertain, algebraic && cells == 80);
        }
    }
}
