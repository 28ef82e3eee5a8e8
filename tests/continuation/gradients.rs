//! Promise: every derivative that the core takes from a residual agrees with differences of what it
//! differentiates, on random polynomials.

use crate::common::{agree, close, difference, dot};
use proptest::prelude::*;
use tangency::core::bifurcation::{
    At, BranchPoint, DefiningSystem, DegenerateFold, Fold, Hopf, Level, NullSpace, Quantity,
};
use tangency::core::problem::{Dynamics, Names, ZeroProblem};
use tangency::core::scalar::Scalar;
use tangency::core::system::{Dense, Functional, Kind, Sparse, System};

const N: usize = 3;
const LENGTH: usize = 5;

/// `Fᵢ = Σⱼ aᵢⱼ xⱼ + bᵢ (cᵢ·x)² + dᵢ (eᵢ·x)³`, in three unknowns and two parameters; a flow, with a
/// mass matrix that depends on the unknowns and parameters if `implicit`.
#[derive(Clone, Debug)]
struct Polynomial {
    linear: Vec<f64>,
    quadratic: Vec<f64>,
    cubic: Vec<f64>,
    implicit: bool,
}

fn form<T: Scalar>(coefficients: &[f64], i: usize, z: &[T], p: &[T]) -> T {
    let row = &coefficients[i * LENGTH..(i + 1) * LENGTH];
    z.iter().chain(p).zip(row).fold(T::zero(), |sum, (x, a)| sum + *x * *a)
}

impl ZeroProblem for Polynomial {
    fn names(&self) -> Names {
        Names::new(["x", "y", "z"], ["p", "q"]).with_monitors(["cube"])
    }
    fn residual<T: Scalar>(&self, z: &[T], p: &[T], r: &mut [T]) {
        for (i, r) in r.iter_mut().enumerate() {
            *r = form(&self.linear, i, z, p)
                + form(&self.quadratic, i, z, p).powi(2)
                + form(&self.cubic, i, z, p).powi(3);
        }
    }
    fn dynamics(&self) -> Dynamics {
        if self.implicit { Dynamics::Implicit } else { Dynamics::Flow }
    }
    fn mass_product<T: Scalar>(&self, z: &[T], p: &[T], rates: &[T], products: &mut [T]) {
        for (i, product) in products.iter_mut().enumerate() {
            *product = rates[i] * 1.5;
            for (j, rate) in rates.iter().enumerate() {
                let entry = form(&self.cubic, (i + j) % N, z, p) * 0.3;
                *product += *rate * (entry + form(&self.linear, j, z, p).powi(2) * 0.1);
            }
        }
    }
    fn monitors<T: Scalar>(&self, z: &[T], p: &[T], values: &mut [T]) {
        values[0] = form(&self.linear, 0, z, p).powi(3);
    }
}

fn numbers(length: usize) -> impl Strategy<Value = Vec<f64>> {
    prop::collection::vec(-1.0..1.0_f64, length)
}

fn polynomial() -> impl Strategy<Value = Polynomial> {
    let size = N * LENGTH;
    (numbers(size), numbers(size), numbers(size), any::<bool>()).prop_map(
        |(linear, quadratic, cubic, implicit)| Polynomial { linear, quadratic, cubic, implicit },
    )
}

/// The step of differences.
const H: f64 = 1e-3;

fn unit(i: usize) -> Vec<f64> {
    (0..LENGTH).map(|j| f64::from(u8::from(i == j))).collect()
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, failure_persistence: None, ..ProptestConfig::default() })]

    /// Each derivative against differences of the one below it.
    #[test]
    fn derivatives_of_a_residual(
        problem in polynomial(),
        x in numbers(LENGTH),
        d in numbers(LENGTH),
        e in numbers(LENGTH),
        f in numbers(LENGTH),
        w in numbers(N),
    ) {
        let mut system = Dense::new(problem.clone());
        let mut out = vec![0.0; N];
        system.derivative(&x, &[&d], &mut out).unwrap();
        agree(&out, &difference(&x, &d, H, |x| {
            let mut r = vec![0.0; N];
            system.residual(x, &mut r).unwrap();
            r
        }), 1e-9);
        system.derivative(&x, &[&d, &e], &mut out).unwrap();
        agree(&out, &difference(&x, &e, H, |x| {
            let mut r = vec![0.0; N];
            system.derivative(x, &[&d], &mut r).unwrap();
            r
        }), 1e-9);
        system.derivative(&x, &[&d, &e, &f], &mut out).unwrap();
        agree(&out, &difference(&x, &f, H, |x| {
            let mut r = vec![0.0; N];
            system.derivative(x, &[&d, &e], &mut r).unwrap();
            r
        }), 1e-9);
        // The third derivative of a cube is known.
        let part = |i: usize, v: &[f64]| form(&problem.cubic, i, &v[..N], &v[N..]);
        let exact: Vec<f64> =
            (0..N).map(|i| 6.0 * part(i, &d) * part(i, &e) * part(i, &f)).collect();
        agree(&out, &exact, 1e-12);
        let mut gradient = vec![0.0; LENGTH];
        system.gradient(&x, Functional::First(&w, &d), &[0, 1], &mut gradient).unwrap();
        let mut second_gradient = vec![0.0; LENGTH];
        system.gradient(&x, Functional::Second(&w, &d), &[0, 1], &mut second_gradient).unwrap();
        let mut monitor = vec![0.0; LENGTH];
        system.gradient(&x, Functional::Monitor(0), &[0, 1], &mut monitor).unwrap();
        for i in 0..LENGTH {
            let first = difference(&x, &unit(i), H, |x| {
                system.derivative(x, &[&d], &mut out).unwrap();
                let mut value = vec![0.0];
                system.monitors(x, 0, &mut value).unwrap();
                vec![dot(&w, &out), value[0]]
            });
            agree(&[gradient[i], monitor[i]], &first, 1e-9);
            let second = difference(&x, &unit(i), H, |x| {
                system.derivative(x, &[&d, &d], &mut out).unwrap();
                vec![dot(&w, &out)]
            });
            agree(&[second_gradient[i]], &second, 1e-9);
        }
        // The Jacobian, one column after the other.
        system.assemble(&x).unwrap();
        let mut jacobian = vec![0.0; N * N];
        system.jacobian(&mut jacobian);
        for i in 0..N {
            system.derivative(&x, &[&unit(i)], &mut out).unwrap();
            agree(&jacobian[i * N..(i + 1) * N], &out, 1e-14);
        }
    }

    /// Derivatives of `F − M z'` along directions with rates, and their gradients, against differences
    /// of first derivatives, for dense and sparse matrices.
    #[test]
    fn derivatives_with_rates(
        problem in polynomial(),
        x in numbers(LENGTH),
        d in numbers(LENGTH + N),
        e in numbers(LENGTH + N),
        w in numbers(N),
    ) {
        let systems: [Box<dyn System>; 2] =
            [Box::new(Dense::new(problem.clone())), Box::new(Sparse::new(problem))];
        for mut system in systems {
            system.assemble(&x).unwrap();
            let at_rest = [&[0.0; LENGTH][..], &d[LENGTH..]].concat();
            let [mut out, mut first] = [vec![0.0; N], vec![0.0; N]];
            system.derivative(&x, &[&d, &e], &mut out).unwrap();
            let mut slope = |along: &[f64], of: &[f64]| {
                difference(&x, &along[..LENGTH], H, |x| {
                    system.derivative(x, &[of], &mut first).unwrap();
                    first.clone()
                })
            };
            let [one, other] = [slope(&d, &e), slope(&e, &at_rest)];
            let sum: Vec<f64> = one.iter().zip(other).map(|(one, other)| one + other).collect();
            agree(&out, &sum, 1e-9);
            let expected: Vec<f64> = (0..LENGTH).map(|i| dot(&w, &slope(&unit(i), &d))).collect();
            let mut gradient = vec![0.0; LENGTH];
            system.gradient(&x, Functional::First(&w, &d), &[0, 1], &mut gradient).unwrap();
            agree(&gradient, &expected, 1e-9);
        }
    }

    /// Gradients of every condition against differences of its values, by `x` and by its own
    /// unknowns.
    #[test]
    fn gradients_of_conditions(
        problem in polynomial(),
        x in numbers(LENGTH),
        y in 0.2..2.0_f64,
        sparse in any::<bool>(),
    ) {
        let conditions: Vec<Box<dyn DefiningSystem>> = vec![
            Box::<Fold>::default(),
            Box::new(DegenerateFold::cusp()),
            Box::new(DegenerateFold::bogdanov_takens()),
            Box::new(Hopf::of_equilibria()),
            Box::new(BranchPoint::new(0)),
            Box::new(Level::new(Quantity::Monitor(0), 0.3, Kind::UZ)),
            Box::new(Level::new(Quantity::Parameter(1), 0.3, Kind::UZ)),
        ];
        let mut system: Box<dyn System> =
            if sparse { Box::new(Sparse::new(problem)) } else { Box::new(Dense::new(problem)) };
        for mut condition in conditions {
            let (k, mut null) = (condition.unknowns(), NullSpace::default());
            let at = At { system: &mut *system, x: &x, released: &[0, 1], held: &[], null: &mut null };
            // No complex pair: not near a Hopf point, and refused as such.
            if condition.start(at, &mut vec![0.0; k]).is_err() {
                continue;
            }
            let own = vec![y; k];
            let mut evaluate = |x: &[f64], own: &[f64]| {
                let mut values = vec![0.0; k + 1];
                let at = At { system: &mut *system, x, released: &[0, 1], held: &[], null: &mut null };
                condition.values(at, own, &mut values).unwrap();
                values
            };
            let value = evaluate(&x, &own);
            if value.iter().any(|v| v.abs() > 1e3) {
                continue;
            }
            // Differences and how far they can be relied on: little where the border is badly
            // conditioned.
            let by = |at: &[f64], d: &[f64], f: &mut dyn FnMut(&[f64]) -> Vec<f64>| {
                let [long, short] = [2.0 * H, H].map(|h| difference(at, d, h, &mut *f));
                let doubt = long.iter().zip(&short).map(|(a, b)| (a - b).abs());
                short.iter().copied().zip(doubt.collect::<Vec<_>>()).collect::<Vec<_>>()
            };
            let by_x: Vec<_> =
                (0..LENGTH).map(|i| by(&x, &unit(i), &mut |x| evaluate(x, &own))).collect();
            let by_y = (k == 1).then(|| by(&own, &[1.0], &mut |y| evaluate(&x, y)));
            evaluate(&x, &own);
            let (mut rows, mut own_rows) = (vec![0.0; (k + 1) * LENGTH], vec![0.0; (k + 1) * k]);
            let at = At { system: &mut *system, x: &x, released: &[0, 1], held: &[], null: &mut null };
            condition.gradients(at, &mut rows, &mut own_rows).unwrap();
            let check = |found: f64, (expected, doubt): (f64, f64)| {
                close(found, expected, 1e-6 * expected.abs().max(1.0) + doubt);
            };
            for row in 0..=k {
                for i in 0..LENGTH {
                    check(rows[row * LENGTH + i], by_x[i][row]);
                }
                if let Some(by_y) = &by_y {
                    check(own_rows[row], by_y[row]);
                }
            }
        }
    }
}
