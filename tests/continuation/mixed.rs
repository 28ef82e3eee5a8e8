//! Promise: mixed derivatives along two and three directions, by which normal forms are computed, agree
//! with Taylor coefficients by jets.

use std::f64::consts::TAU;
use tangency::core::bvp::{Collocation, Method, Shooting};
use tangency::core::orbit::{MapCycle, periodic_orbits};
use tangency::core::problem::{DiscreteMap, Equilibria, Forcing, Names, VectorField};
use tangency::core::scalar::{Scalar, Space};
use tangency::core::system::{Dense, System};

/// A forced oscillator, `x'' = cos ωt − (1 + x²) x' − sin x`.
struct Oscillator;

impl VectorField for Oscillator {
    fn names(&self) -> Names {
        Names::new(["x", "v"], ["frequency"])
    }
    fn field<T: Scalar>(&self, t: T, x: &[T], p: &[T], f: &mut [T]) {
        f[0] = x[1];
        f[1] = (p[0] * t).cos() - (x[0] * x[0] + 1.0) * x[1] - x[0].sin();
    }
    fn forcing(&self) -> Forcing {
        Forcing::Periodic { phase: TAU }
    }
    fn period<T: Scalar>(&self, p: &[T]) -> T {
        p[0].recip() * TAU
    }
}

/// `x ↦ a cos x + y/5`, `y ↦ sin xy`.
struct Waves;

impl DiscreteMap for Waves {
    fn names(&self) -> Names {
        Names::new(["x", "y"], ["a"])
    }
    fn next<T: Scalar>(&self, x: &[T], p: &[T], next: &mut [T]) {
        next[0] = p[0] * x[0].cos() + x[1] * 0.2;
        next[1] = (x[0] * x[1]).sin();
    }
}

/// Directions, the powers of their monomial, and the derivative in units of its coefficient.
type Case<'a> = (&'a [&'a [f64]], [u8; 3], f64);

/// Compares `F_xx[a, b]`, `F_xxx[a, b, c]` and `F_xxx[a, a, b]`, in units of the largest component, with
/// the coefficients of `F(x + ξ₁a + ξ₂b + ξ₃c)`.
fn agrees_with_jets(system: &mut dyn System, x: &[f64], tolerance: f64) {
    let (n, space) = (system.names().dimension(), Space::of(3, 3).unwrap());
    // Three directions of different sizes.
    let component =
        |k: usize, i: usize| 3.0_f64.powi(k as i32) * (1.7 * (1 + i + 5 * k) as f64).sin();
    let direction = |k: usize, length: usize| -> Vec<f64> {
        (0..length).map(|i| if i < n { component(k, i) } else { 0.0 }).collect()
    };
    let mut terms = vec![vec![0.0; n]; space.len()];
    (0..3).for_each(|k| terms[1 + k] = direction(k, n));
    let images = system.expand(x, space, &terms).unwrap();
    let [a, b, c] = [0, 1, 2].map(|k| direction(k, x.len()));
    let cases: [Case; 3] = [
        (&[&a, &b], [1, 1, 0], 1.0),
        (&[&a, &b, &c], [1, 1, 1], 1.0),
        (&[&a, &a, &b], [2, 1, 0], 2.0),
    ];
    for (directions, powers, factor) in cases {
        let expected = &images[space.position(&powers).unwrap()];
        let mut found = vec![0.0; n];
        system.derivative(x, directions, &mut found).unwrap();
        let largest = expected.iter().fold(0.0_f64, |most, c| most.max(c.abs())) * factor;
        assert!(largest > 1e-3, "{powers:?}: {largest}");
        for (found, expected) in found.iter().zip(expected) {
            let error = (found - factor * expected).abs() / largest;
            assert!(error <= tolerance, "{powers:?}: {found} and {}", factor * expected);
        }
    }
}

#[test]
fn of_equilibria() {
    agrees_with_jets(&mut Dense::new(Equilibria::new(Oscillator)), &[0.7, -0.4, 1.3], 1e-13);
}

#[test]
fn of_cycles_of_maps() {
    let x = [0.3, -0.5, 0.8, 1.1, -0.2, 0.4, 0.9];
    agrees_with_jets(&mut MapCycle::of(Waves, 3), &x, 1e-13);
}

/// By shooting both are derivatives of flows, to the tolerance of these.
#[test]
fn of_periodic_orbits() {
    let methods: [(Method, usize, f64); 2] =
        [(Collocation::new(3).unwrap().into(), 3, 1e-12), (Shooting::default().into(), 1, 1e-9)];
    for (method, intervals, tolerance) in methods {
        let mut orbits = periodic_orbits(Oscillator, intervals, method).unwrap();
        let mut x = orbits.sampled(&[], |_, tau, x| {
            (x[0], x[1]) = (0.5 + 0.3 * (TAU * tau).cos(), 0.4 * (TAU * tau).sin());
        });
        x.push(1.3);
        agrees_with_jets(&mut orbits, &x, tolerance);
    }
}
