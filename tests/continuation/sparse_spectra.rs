//! Eigenvalues of sparse matrices: the rightmost ones, with all copies, and certain numbers of unstable ones.

use crate::common::diffusive_brusselator::DiffusiveBrusselator;
use crate::common::{Bratu, agree, close};
use std::f64::consts::PI;
use tangency::core::linalg::{Border, Factors, Form, SpectrumRequest};
use tangency::core::problem::{Equilibria, Names, ZeroProblem};
use tangency::core::scalar::Scalar;
use tangency::core::system::{Dense, Sparse, System};

/// The homogeneous equilibrium of the Brusselator with `2n` unknowns, and the parameters.
fn homogeneous(n: usize) -> Vec<f64> {
    let mut x = vec![2.0; n];
    x.extend(vec![5.45 / 2.0; n]);
    x.extend([1.1, 2.0, 5.45]);
    x
}

#[test]
fn the_rightmost_eigenvalues_are_those_of_the_dense_matrix() {
    let n = 110;
    let x = homogeneous(n);
    let (mut dense, mut sparse) = (
        Dense::new(Equilibria::new(DiffusiveBrusselator::new(n))),
        Sparse::new(Equilibria::new(DiffusiveBrusselator::new(n))),
    );
    let systems: [&mut dyn System; 2] = [&mut dense, &mut sparse];
    let [all, some] = systems.map(|system| {
        system.assemble(&x).unwrap();
        system.spectrum(&x, SpectrumRequest::new(6)).unwrap().unwrap()
    });
    assert!(some.len() >= 6 && some.len() < 60, "{}", some.len());
    for (found, expected) in some.iter().zip(&all).take(4) {
        close(found.0, expected.0, 1e-9);
        close(found.1.abs(), expected.1.abs(), 1e-9);
    }
}

/// The first eigenvalues of a line of 10⁵ points, whose Krylov vectors are divided among threads; and
/// no complex pairs, as the matrix is symmetric.
#[test]
fn long_vectors_are_orthogonalised_in_strips() {
    let n = 100_000;
    let h = 1.0 / (n + 1) as f64;
    let mut line = Sparse::new(Bratu(n));
    let x: Vec<f64> = std::iter::repeat_n(0.0, n).chain([0.0]).collect();
    line.assemble(&x).unwrap();
    let found = line.spectrum(&x, SpectrumRequest::new(4)).unwrap().unwrap();
    for (k, found) in (1..=4).zip(&found) {
        let exact = -(2.0 / h * (f64::from(k) * PI * h / 2.0).sin()).powi(2);
        assert!((found.0 / exact - 1.0).abs() < 1e-9 && found.1 == 0.0, "{k}: {found:?}");
    }
    assert_eq!(line.spectrum(&x, SpectrumRequest::pairs(10)).unwrap(), Some(Vec::new()));
}

/// The fate of factors before eigenvalues are computed.
#[derive(Clone, Copy, PartialEq)]
enum Then {
    Kept,
    Dropped,
    /// The factors of another matrix take the same memory.
    Replaced,
    /// The factors belong to another point of the same system.
    Elsewhere,
}

/// The eigenvalues of a system at a point after its matrix was factored in a border, and the eigenvalues
/// of the same system without factors.
fn with_and_without_factors<S: System>(
    make: impl Fn() -> S,
    x: &[f64],
    then: Then,
) -> [Vec<(f64, f64)>; 2] {
    let [mut system, mut other, mut plain] = [make(), make(), make()];
    let n = system.names().dimension();
    let wave = |speed: f64| (0..n).map(|i| (speed * i as f64).cos()).collect::<Vec<f64>>();
    let (columns, rows) = (wave(0.3), wave(0.2));
    let border = Border { width: 1, columns: &columns, rows: &rows, corner: &[0.5], units: &[] };
    let mut factors = Some(Factors::default());
    let mut factor = |system: &mut S, x: &[f64]| {
        system.assemble(x).unwrap();
        let into = factors.as_mut().unwrap();
        system.factor(Form::Jacobian, border, into).unwrap();
    };
    let beside: Vec<f64> = x.iter().map(|x| 1.1 * x + 0.1).collect();
    factor(&mut system, if then == Then::Elsewhere { &beside } else { x });
    system.assemble(x).unwrap();
    if then == Then::Replaced {
        factor(&mut other, &beside);
    }
    factors = factors.filter(|_| then != Then::Dropped);
    plain.assemble(x).unwrap();
    let request = SpectrumRequest::new(6);
    let found = [&mut system, &mut plain].map(|it| it.spectrum(x, request).unwrap().unwrap());
    assert_eq!(factors.is_none(), then == Then::Dropped);
    assert_eq!(system.doubts(), plain.doubts());
    found
}

/// Eigenvalues are computed with the factors of the matrix in a border, if these factors exist; factors
/// of another matrix are not used.
#[test]
fn known_factors_give_the_same_eigenvalues() {
    let m = 24;
    let square: Vec<f64> = std::iter::repeat_n(0.01, m * m).chain([60.0]).collect();
    let brusselator = || Sparse::new(Equilibria::new(DiffusiveBrusselator::new(40)));
    for then in [Then::Kept, Then::Dropped, Then::Replaced, Then::Elsewhere] {
        let complex = with_and_without_factors(brusselator, &homogeneous(40), then);
        let symmetric = with_and_without_factors(|| Sparse::new(Square(m)), &square, then);
        for [found, expected] in [complex, symmetric] {
            let numbers = |all: &[(f64, f64)]| all.iter().flat_map(|l| [l.0, l.1]).collect();
            let [found, expected]: [Vec<f64>; 2] = [numbers(&found), numbers(&expected)];
            agree(&found, &expected, 1e-9);
        }
    }
}

/// Without a scaling that makes the matrix symmetric, complex pairs are possible and are computed.
#[test]
fn complex_pairs_are_found_where_they_are_possible() {
    let n = 40;
    let x = homogeneous(n);
    let spectrum = |request| {
        let mut sparse = Sparse::new(Equilibria::new(DiffusiveBrusselator::new(n)));
        sparse.assemble(&x).unwrap();
        sparse.spectrum(&x, request).unwrap().unwrap()
    };
    let found = spectrum(SpectrumRequest::pairs(6));
    assert_eq!(found, spectrum(SpectrumRequest::new(6)));
    assert!(found.iter().any(|l| l.1 > 0.0));
}

/// The Laplacian of a square, whose eigenvalues come in pairs, plus `p`.
struct Square(usize);

impl ZeroProblem for Square {
    fn names(&self) -> Names {
        Names::new([("u", self.0 * self.0)], ["p"])
    }
    fn residual<T: Scalar>(&self, u: &[T], p: &[T], r: &mut [T]) {
        let m = self.0;
        let at = |i: usize, j: usize| {
            if i == 0 || j == 0 || i > m || j > m { T::zero() } else { u[(i - 1) * m + j - 1] }
        };
        let inverse = ((m + 1) * (m + 1)) as f64;
        for i in 1..=m {
            for j in 1..=m {
                let around = at(i - 1, j) + at(i + 1, j) + at(i, j - 1) + at(i, j + 1);
                r[(i - 1) * m + j - 1] = (around - at(i, j) * 4.0) * inverse + p[0] * at(i, j);
            }
        }
    }
}

#[test]
fn repeated_eigenvalues_are_all_found() {
    let m = 20;
    let h = 1.0 / (m + 1) as f64;
    let mode = |k: f64| -(2.0 / h * (k * PI * h / 2.0).sin()).powi(2);
    // Unstable are (1, 1), twice (1, 2), (2, 2), and twice (1, 3).
    let p = 0.5 - mode(1.0) - mode(3.0);
    let mut sparse = Sparse::new(Square(m));
    let x: Vec<f64> = std::iter::repeat_n(0.0, m * m).chain([p]).collect();
    sparse.assemble(&x).unwrap();
    let found = sparse.spectrum(&x, SpectrumRequest::new(4)).unwrap().unwrap();
    let modes = [(1.0, 1.0), (1.0, 2.0), (2.0, 1.0), (2.0, 2.0), (1.0, 3.0), (3.0, 1.0)];
    let expected: Vec<f64> = modes.iter().map(|(k, l)| mode(*k) + mode(*l) + p).collect();
    let unstable: Vec<f64> = found.iter().map(|l| l.0).filter(|l| *l > 0.0).collect();
    agree(&unstable, &expected, 1e-9);
    assert!(sparse.doubts().is_none());
}

#[test]
fn eigenvalues_are_found_as_they_come_near_zero() {
    let m = 16;
    let h = 1.0 / (m + 1) as f64;
    let mode = |k: usize| -(2.0 / h * (k as f64 * PI * h / 2.0).sin()).powi(2);
    let mut sparse = Sparse::new(Square(m));
    // Each spectrum begins with the eigenvectors of the one before, to which others are orthogonal.
    for step in 0..8 {
        let p = 0.3 + 43.0 * f64::from(step);
        let x: Vec<f64> = std::iter::repeat_n(0.0, m * m).chain([p]).collect();
        sparse.assemble(&x).unwrap();
        let found = sparse.spectrum(&x, SpectrumRequest::new(4)).unwrap().unwrap();
        let modes = (1..=m).flat_map(|k| (1..=m).map(move |l| (k, l)));
        let mut expected: Vec<f64> = modes.map(|(k, l)| mode(k) + mode(l) + p).collect();
        // All positive ones, and at least four others, the nearest to zero.
        let positive = expected.iter().filter(|l| **l > 0.0).count();
        assert!(found.len() >= 4 + positive);
        expected.sort_by(|a, b| b.total_cmp(a));
        let found: Vec<f64> = found.iter().map(|l| l.0).collect();
        expected.truncate(found.len());
        agree(&found, &expected, 1e-9);
    }
    assert!(sparse.doubts().is_none());
}

/// The Laplacian on a line without flux at its ends, `u_0 = u_2` and `u_{n+1} = u_{n−1}`, of which a
/// function is taken: `−(1 + u'')² + p u` and a wind.
struct Walls {
    points: usize,
    wind: f64,
}

impl ZeroProblem for Walls {
    fn names(&self) -> Names {
        Names::new([("u", self.points)], ["p"])
    }
    fn residual<T: Scalar>(&self, u: &[T], p: &[T], r: &mut [T]) {
        let n = self.points;
        let bent = |v: &[T], i: usize| {
            let (left, right) =
                (v[if i == 0 { 1 } else { i - 1 }], v[if i + 1 == n { n - 2 } else { i + 1 }]);
            (left + right - v[i] * 2.0) * 16.0
        };
        let once: Vec<T> = (0..n).map(|i| u[i] + bent(u, i)).collect();
        for i in 0..n {
            r[i] = p[0] * u[i] - once[i] - bent(&once, i);
            if (1..n - 1).contains(&i) {
                r[i] += (u[i + 1] - u[i - 1]) * self.wind;
            }
        }
    }
}

/// The number of unstable eigenvalues of a line of 400 points, by dense and by sparse matrices, and
/// whether the latter is in doubt.
fn counted(p: f64, wind: f64) -> ([usize; 2], bool) {
    let walls = || Walls { points: 400, wind };
    let x: Vec<f64> = std::iter::repeat_n(0.0, 400).chain([p]).collect();
    let (mut dense, mut sparse) = (Dense::new(walls()), Sparse::new(walls()));
    let counts = [&mut dense as &mut dyn System, &mut sparse].map(|system| {
        system.assemble(&x).unwrap();
        let found = system.spectrum(&x, SpectrumRequest::new(4)).unwrap().unwrap();
        found.iter().filter(|l| l.0 > 0.0).count()
    });
    (counts, sparse.doubts().is_some())
}

/// Walls without flux make a matrix that is symmetric but for a scaling: signs of pivots count its
/// eigenvalues, also where eigenvalues of both signs are near.
#[test]
fn unstable_eigenvalues_between_walls_are_counted_with_certainty() {
    for p in [-0.1, -1e-3, 0.013, 0.05, 0.2] {
        let ([dense, sparse], doubted) = counted(p, 0.0);
        assert_eq!(dense, sparse, "{p}");
        assert!(!doubted, "{p}");
    }
    // With a wind there is no such scaling.
    assert!(counted(-0.1, 0.05).1);
}

/// One unstable eigenvalue is far from zero, beyond all others that are looked for: the count finds it.
#[test]
fn an_unstable_eigenvalue_far_from_zero_is_found() {
    let m = 20;
    let mut sparse = Sparse::new(Peaked(Square(m)));
    let x: Vec<f64> = std::iter::repeat_n(0.0, m * m).chain([5000.0]).collect();
    let mut dense = Dense::new(Peaked(Square(m)));
    let systems: [&mut dyn System; 2] = [&mut sparse, &mut dense];
    let [some, all] = systems.map(|system| {
        system.assemble(&x).unwrap();
        system.spectrum(&x, SpectrumRequest::new(4)).unwrap().unwrap()
    });
    assert!(sparse.doubts().is_none());
    let unstable = |spectrum: &[(f64, f64)]| spectrum.iter().filter(|l| l.0 > 0.0).count();
    assert_eq!([unstable(&some), unstable(&all)], [1, 1]);
    close(some[0].0, all[0].0, 1e-8);
    // Far beyond the circle of the others.
    assert!(some[0].0 > 10.0 * some.last().unwrap().0.abs());
}

/// The Laplacian of a square, with `p` at one place.
struct Peaked(Square);

impl ZeroProblem for Peaked {
    fn names(&self) -> Names {
        self.0.names()
    }
    fn residual<T: Scalar>(&self, u: &[T], p: &[T], r: &mut [T]) {
        self.0.residual(u, &[T::zero()], r);
        let place = u.len() / 2 + self.0.0 / 2;
        r[place] += p[0] * u[place];
    }
}
