//! Promises of sparse matrices: the same factors, derivatives and gradients as dense ones,
//! whatever the pattern; discretised fields of any size at a cost of O(n) and with the same points.

use crate::common::diffusive_brusselator::DiffusiveBrusselator;
use crate::common::{Bratu, agree, close};
use proptest::prelude::*;
use proptest::test_runner::{Config, TestRunner};
use std::f64::consts::PI;
use tangency::core::continuation::{Branch, Continuation, Settings};
use tangency::core::linalg::{Border, Factors, Form};
use tangency::core::problem::{Equilibria, Names, ZeroProblem};
use tangency::core::scalar::Scalar;
use tangency::core::system::{Dense, Functional, Kind, Sparse, System};

/// Unknowns that are coupled at random: `r_i = Σ a (z_j + z_j z_k/4) + p sin z_i`.
#[derive(Clone, Debug)]
struct Coupled {
    n: usize,
    terms: Vec<(usize, usize, usize, f64)>,
}

impl ZeroProblem for Coupled {
    fn names(&self) -> Names {
        Names::new([("z", self.n)], ["p", "q"]).with_monitors(["square"])
    }
    fn residual<T: Scalar>(&self, z: &[T], p: &[T], r: &mut [T]) {
        for (r, z) in r.iter_mut().zip(z) {
            *r = p[0] * z.sin() * p[1];
        }
        for &(i, j, k, a) in &self.terms {
            r[i] += (z[j] + z[j] * z[k] * 0.25) * a;
        }
    }
    fn monitors<T: Scalar>(&self, z: &[T], p: &[T], values: &mut [T]) {
        values[0] = z.iter().fold(p[1], |sum, z| sum + *z * *z);
    }
}

/// Couplings of a permutation, which makes the matrix regular without a diagonal, and others.
fn coupled() -> impl Strategy<Value = (Coupled, Vec<f64>, usize)> {
    (2..40_usize, 0..4_usize, any::<prop::sample::Index>()).prop_flat_map(|(n, width, turn)| {
        let turn = turn.index(n);
        let term = (0..n, 0..n, 0..n, -0.5..0.5);
        let terms = prop::collection::vec(term, 0..3 * n);
        let numbers = prop::collection::vec(-1.0..1.0, n + 2 + 2 * width * n + width * width);
        (terms, numbers).prop_map(move |(mut terms, numbers)| {
            terms.extend((0..n).map(|i| (i, (i + turn) % n, i, 2.0)));
            (Coupled { n, terms }, numbers, width)
        })
    })
}

#[test]
fn sparse_systems_are_the_dense_ones() {
    let mut runner = TestRunner::new(Config::with_cases(150));
    runner
        .run(&coupled(), |(problem, numbers, m)| {
            let n = problem.n;
            let (x, border) = numbers.split_at(n + 2);
            let (columns, rest) = border.split_at(m * n);
            let (rows, corner) = rest.split_at(m * n);
            let border = Border { width: m, columns, rows, corner, units: &[] };
            let (mut dense, mut sparse) = (Dense::new(problem.clone()), Sparse::new(problem));
            let systems: [&mut dyn System; 2] = [&mut dense, &mut sparse];
            let found = systems.map(|system| {
                system.assemble(x).unwrap();
                let mut factors = Factors::default();
                let regular = system.factor(Form::Jacobian, border, &mut factors).is_ok();
                let mut solutions = Vec::new();
                if regular {
                    let right: Vec<f64> = (0..n + m).map(|i| (i as f64).sin()).collect();
                    let [mut plain, mut transposed] = [right.clone(), right];
                    factors.solve(&mut plain);
                    factors.solve_transposed(&mut transposed);
                    solutions = [plain, transposed, vec![factors.determinant_sign()]].concat();
                }
                let (w, v) = (&x[..n], x);
                let of =
                    [Functional::First(w, v), Functional::Second(w, v), Functional::Monitor(0)];
                let gradients = of.map(|of| {
                    let mut out = vec![0.0; n + 2];
                    system.gradient(x, of, &[0, 1], &mut out).unwrap();
                    out
                });
                (solutions, gradients.concat())
            });
            let [(dense, gradients), (sparse, colored)] = found;
            agree(&colored, &gradients, 1e-12);
            prop_assert_eq!(dense.is_empty(), sparse.is_empty());
            // Nearly singular matrices have large solutions, of which few digits are certain.
            let size = dense.iter().fold(1.0, |most: f64, x| most.max(x.abs()));
            if size < 1e4 {
                agree(&sparse, &dense, 1e-8);
            }
            Ok(())
        })
        .unwrap();
}

#[test]
fn shifted_matrices_are_the_dense_ones() {
    let n = 12;
    let terms = (0..n).flat_map(|i| [(i, (i + 1) % n, i, 1.5), (i, i, i, -0.3)]).collect();
    let problem = Coupled { n, terms };
    let x: Vec<f64> = (0..n + 2).map(|i| (1.7 * i as f64).cos()).collect();
    let vector = |seed: f64| (0..2 * n).map(|i| (seed * i as f64).sin()).collect::<Vec<_>>();
    let (columns, rows) = (vector(1.1), vector(0.7));
    let border = Border { width: 1, columns: &columns, rows: &rows, corner: &[], units: &[] };
    let (mut dense, mut sparse) = (Dense::new(problem.clone()), Sparse::new(problem));
    let systems: [&mut dyn System; 2] = [&mut dense, &mut sparse];
    let [expected, found] = systems.map(|system| {
        system.assemble(&x).unwrap();
        let mut factors = Factors::default();
        system.factor(Form::Oscillation(0.8), border, &mut factors).unwrap();
        let [mut plain, mut transposed] = [0, 1].map(|k| vec![1.0 + f64::from(k); 2 * n + 2]);
        factors.solve(&mut plain);
        factors.solve_transposed(&mut transposed);
        [plain, transposed].concat()
    });
    agree(&found, &expected, 1e-12);
}

/// `z_i = max(z_{i−1}, p)`-like couplings: which unknown an equation depends on is chosen.
struct Chosen(usize);

impl ZeroProblem for Chosen {
    fn names(&self) -> Names {
        Names::new([("z", self.0)], ["p"])
    }
    fn residual<T: Scalar>(&self, z: &[T], p: &[T], r: &mut [T]) {
        let n = self.0;
        for i in 0..n {
            let other = if p[0].real() < 0.5 { z[(i + 1) % n] } else { z[(i + 7) % n] };
            r[i] = z[i] * 3.0 + other - p[0];
        }
    }
}

#[test]
fn patterns_grow_where_equations_choose() {
    let (n, mut sparse) = (30, Sparse::new(Chosen(30)));
    for p in [0.2, 0.8, 0.3] {
        let x: Vec<f64> = (0..n).map(|i| i as f64).chain([p]).collect();
        sparse.assemble(&x).unwrap();
        let mut factors = Factors::default();
        sparse.factor(Form::Jacobian, Border::NONE, &mut factors).unwrap();
        // Rows have the sum 4.
        let mut ones = vec![4.0; n];
        factors.solve(&mut ones);
        agree(&ones, &vec![1.0; n], 1e-14);
    }
}

/// Couplings of neighbours in a square, with pseudo-random factors. Every third equation does not
/// contain its own unknown, so that pivots lie outside the diagonal.
#[derive(Clone)]
struct Grid {
    rows: usize,
    columns: usize,
}

impl Grid {
    /// A number from −1 to 1 for each pair of unknowns.
    fn factor(i: usize, j: usize) -> f64 {
        (12.9898 * i as f64 + 78.233 * j as f64).sin()
    }
}

impl ZeroProblem for Grid {
    fn names(&self) -> Names {
        Names::new([("z", self.rows * self.columns)], ["p"])
    }
    fn residual<T: Scalar>(&self, z: &[T], p: &[T], r: &mut [T]) {
        let Grid { rows, columns: m } = *self;
        for k in 0..rows * m {
            let (row, column) = (k / m, k % m);
            let own = if k % 3 == 0 { 0.0 } else { 1.5 + Grid::factor(k, k) };
            r[k] = z[k] * own - p[0];
            let beside = [(row > 0, k.wrapping_sub(m)), (row + 1 < rows, k + m)];
            let others = [(column > 0, k.wrapping_sub(1)), (column + 1 < m, k + 1)];
            for (_, other) in beside.into_iter().chain(others).filter(|(exists, _)| *exists) {
                r[k] += z[other] * Grid::factor(k, other);
            }
        }
    }
}

/// The largest difference of two vectors, relative to the largest entry.
fn difference(a: &[f64], b: &[f64]) -> f64 {
    let largest = a.iter().fold(0.0_f64, |most, a| most.max(a.abs()));
    a.iter().zip(b).fold(0.0_f64, |most, (a, b)| most.max((a - b).abs())) / largest
}

/// Matrices so large that threads eliminate parts side by side: the solutions satisfy their equations,
/// however the threads are scheduled the results are bit-identical, and the determinant changes sign
/// where the border says so.
#[test]
fn parts_are_eliminated_side_by_side() {
    eliminated_side_by_side(Grid { rows: 120, columns: 120 }, 1e3);
}

/// The columns of a band matrix are eliminated from both ends.
#[test]
fn bands_are_eliminated_from_both_ends() {
    eliminated_side_by_side(Grid { rows: 8000, columns: 6 }, 1e12);
}

/// The number `most` exceeds `cᵀ A⁻¹ b` for the border's row `c` and column `b`.
fn eliminated_side_by_side(grid: Grid, most: f64) {
    let (n, mut sparse) = (grid.rows * grid.columns, Sparse::new(grid.clone()));
    let x = vec![0.5; n + 1];
    let wave = |speed: f64| (0..n).map(|i| (speed * i as f64).sin()).collect::<Vec<f64>>();
    let [column, row, right, test] = [0.31, 0.17, 0.73, 1.9].map(wave);
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let mut times = |v: &[f64]| {
        let (direction, mut out) = ([v, &[0.0]].concat(), vec![0.0; n]);
        sparse.derivative(&x, &[&direction], &mut out).unwrap();
        out
    };
    let image = times(&test);
    let mut solutions = Vec::new();
    for corner in [-most, most, most] {
        let border =
            Border { width: 1, columns: &column, rows: &row, corner: &[corner], units: &[] };
        let mut factors = Factors::default();
        let mut system = Sparse::new(grid.clone());
        system.assemble(&x).unwrap();
        // The second factorisation uses the memory of the first.
        system.factor(Form::Jacobian, Border { corner: &[0.7], ..border }, &mut factors).unwrap();
        system.factor(Form::Jacobian, border, &mut factors).unwrap();
        let [mut plain, mut transposed] = [0, 1].map(|_| [&right[..], &[0.4]].concat());
        factors.solve(&mut plain);
        factors.solve_transposed(&mut transposed);
        let (z, y) = plain.split_at(n);
        let mut left = times(z);
        left.iter_mut().zip(&column).for_each(|(left, c)| *left += c * y[0]);
        assert!(difference(&right, &left) < 1e-9, "{:.1e}", difference(&right, &left));
        let terms = dot(&row, &row).sqrt() * dot(z, z).sqrt();
        close(dot(&row, z) + corner * y[0], 0.4, 1e-13 * terms);
        // ⟨w, A v⟩ + η ⟨r, v⟩ = ⟨b, v⟩ for the transposed equations.
        let (w, eta) = transposed.split_at(n);
        let scale = dot(w, w).sqrt() * dot(&image, &image).sqrt();
        let both = dot(w, &image) + eta[0] * dot(&row, &test);
        assert!((both - dot(&right, &test)).abs() < 1e-12 * scale);
        solutions.push((plain, transposed, factors.determinant_sign()));
    }
    assert_eq!(solutions[1], solutions[2]);
    // det [A b; cᵀ d] = det A (d − cᵀ A⁻¹ b), and cᵀ A⁻¹ b lies between the two values of d.
    assert_eq!(solutions[0].2, -solutions[1].2);
}

/// The branch of a discretised field through its fold.
fn through_fold(system: &mut dyn System, most: f64) -> Branch {
    let settings = Settings { max_points: 60, ..Settings::default() };
    Continuation::new(system).settings(settings).along("lambda", 0.0..=most).trace().unwrap()
}

fn fold(branch: &Branch) -> f64 {
    branch.of_kind(Kind::LP).next().unwrap().parameters[0]
}

#[test]
fn folds_converge_to_those_of_the_equations() {
    // u'' + λ eᵘ = 0: λ = 8 θ²/cosh²θ with θ tanh θ = 1. The error of differences is of order 2, with
    // even powers only.
    let folds = [499, 999, 1999].map(|n| fold(&through_fold(&mut Sparse::new(Bratu(n)), 4.0)));
    let twice = |coarse: f64, fine: f64| (4.0 * fine - coarse) / 3.0;
    let once = [twice(folds[0], folds[1]), twice(folds[1], folds[2])];
    close((16.0 * once[1] - once[0]) / 15.0, 3.513830719125161, 1e-9);
}

#[test]
fn the_number_of_points_does_not_depend_on_the_mesh() {
    let counts = [50, 500, 5000].map(|n| {
        let settings = Settings { max_points: 500, ..Settings::default() };
        let mut system = Sparse::new(Bratu(n));
        let all = Continuation::new(&mut system).settings(settings).along("lambda", 0.0..=4.0);
        all.bound("middle", ..=4.0).trace().unwrap().points.len() as f64
    });
    for count in counts {
        close(count, counts[1], 0.1 * counts[1]);
    }
}

/// Hopf points of the Brusselator with `2n` unknowns, in the lengths up to 1.2.
fn hopf_points(n: usize) -> (Branch, Vec<f64>) {
    let mut start = vec![2.0; n];
    start.extend(vec![5.45 / 2.0; n]);
    let mut system = Sparse::new(Equilibria::new(DiffusiveBrusselator::new(n)));
    let stated = Continuation::new(&mut system).at("L", 0.3).at("A", 2.0).at("B", 5.45);
    let branch = stated.from(&start[..]).along("L", 0.3..=1.2).trace().unwrap();
    let lengths = branch.of_kind(Kind::HB).map(|point| point.parameters[0]).collect();
    (branch, lengths)
}

#[test]
fn a_reaction_with_diffusion_oscillates_where_its_modes_do() {
    // Modes grow beyond L_k = kπ √((Dₓ + D_y)/(B − 1 − A²)); with differences sin(kπh/2)/(kπh/2) of it.
    let n = 200;
    let (branch, found) = hopf_points(n);
    let h = 1.0 / (n + 1) as f64;
    let length = |k: f64| 2.0 / h * (k * PI * h / 2.0).sin() * (0.012_f64 / 0.45).sqrt();
    agree(&found, &[length(1.0), length(2.0)], 1e-10);
    // Frequencies ω² = det.
    let unstable: Vec<_> = branch.points.iter().map(|point| point.unstable.unwrap()).collect();
    assert_eq!((unstable[0], *unstable.last().unwrap()), (0, 4));
    assert!(branch.warnings.is_empty(), "{:?}", branch.warnings);
    assert_eq!(branch.method, "sparse matrices");
}
