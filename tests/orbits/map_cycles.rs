//! Cycles of maps, whose Jacobians are block-cyclic.

use crate::common::ALL;
use crate::common::close;
use std::f64::consts::TAU;
use tangency::core::bifurcation::{At, DefiningSystem, Fold, Hopf, NullSpace};
use tangency::core::continuation::Continuation;
use tangency::core::orbit::MapCycle;
use tangency::core::problem::DiscreteMap;
use tangency::core::problem::Names;
use tangency::core::scalar::Scalar;
use tangency::core::system::{Functional, Kind, System};

/// `x ↦ 1 − a x² + y`, `y ↦ b x`.
pub struct Henon;

impl DiscreteMap for Henon {
    fn names(&self) -> Names {
        Names::new(["x", "y"], ["a", "b"]).with_monitors(["product"])
    }

    fn next<T: Scalar>(&self, x: &[T], p: &[T], next: &mut [T]) {
        next[0] = x[1] + 1.0 - p[0] * x[0] * x[0];
        next[1] = p[1] * x[0];
    }

    fn monitor<T: Scalar>(&self, _monitor: usize, x: &[T], p: &[T]) -> T {
        x[0] * x[1] * p[0]
    }
}

/// A map of the plane that turns by `1/K` of a circle and draws to `K` rays: with `ρ = x² + y²`
/// and `w = ((x + iy)/√ρ)^K`
///
/// ```text
///     x + iy ↦ e^{2πi/K} (x + iy) (1 + (p − (ρ − 1)²)/K − i s Im w/K²)
/// ```
///
/// On the cycle `p = (ρ − 1)²`, `w = 1`; its multipliers are `(1 − 4ρ (ρ − 1)/K)^K` and
/// `(1 − s/K)^K`.
pub struct Locked(pub i32);

fn times<T: Scalar>(a: [T; 2], b: [T; 2]) -> [T; 2] {
    [a[0] * b[0] - a[1] * b[1], a[0] * b[1] + a[1] * b[0]]
}

impl DiscreteMap for Locked {
    fn names(&self) -> Names {
        Names::new(["x", "y"], ["p", "s"])
    }

    fn next<T: Scalar>(&self, x: &[T], p: &[T], next: &mut [T]) {
        let (z, count) = ([x[0], x[1]], f64::from(self.0));
        let square = z[0] * z[0] + z[1] * z[1];
        let radius = square.sqrt();
        let (mut w, mut power, mut left) = ([T::one(), T::zero()], z.map(|z| z / radius), self.0);
        while left > 0 {
            if left % 2 == 1 {
                w = times(w, power);
            }
            power = times(power, power);
            left /= 2;
        }
        let (sine, cosine) = (TAU / count).sin_cos();
        let outward = (p[0] - (square - 1.0).powi(2)) / count + 1.0;
        let around = -p[1] * w[1] / (count * count);
        next.copy_from_slice(&times(times([T::from(cosine), T::from(sine)], z), [outward, around]));
    }
}

impl Locked {
    /// The states of the cycle with this `ρ`, one after another.
    pub fn cycle(&self, square: f64) -> Vec<f64> {
        let angle = |k: i32| TAU * f64::from(k) / f64::from(self.0);
        let radius = square.sqrt();
        (0..self.0).flat_map(|k| [radius * angle(k).cos(), radius * angle(k).sin()]).collect()
    }
}

#[test]
fn a_cycle_of_4096_iterates() {
    let (map, square, s) = (Locked(4096), 1.25_f64, 0.7);
    let (states, count, p) = (map.cycle(square), f64::from(map.0), (square - 1.0).powi(2));
    let mut cycles = MapCycle::of(map, 4096);
    let start = cycles.unknowns(&states);
    let x = [&start[..], &[p, s]].concat();
    let mut residual = vec![0.0; start.len()];
    cycles.residual(&x, &mut residual).unwrap();
    assert!(residual.iter().all(|r| r.abs() < 2e-15));
    cycles.assemble(&x).unwrap();
    let found = cycles.spectrum(&x, ALL).unwrap().unwrap();
    for (found, part) in found.iter().zip([s, 4.0 * square * (square - 1.0)]) {
        // Both are a product of 4096 factors.
        close(found.0, (1.0 - part / count).powf(count), 1e-11);
        close(found.1, 0.0, 0.0);
    }
    // Cycles begin at p = 0, with ρ = 1.
    let branch = Continuation::new(&mut cycles)
        .from(&start)
        .at("p", p)
        .at("s", s)
        .along("p", -0.1..=0.1)
        .trace()
        .unwrap();
    let folds: Vec<_> = branch.of_kind(Kind::LP).collect();
    assert_eq!(folds.len(), 1);
    // The parameter moves an iterate by p/K: rounding is K times as large for p.
    close(folds[0].parameters[0], 0.0, 1e-11);
}

#[test]
fn special_points_of_cycles() {
    // Cycles of two of Hénon's map begin at a = 3 (1 − b)²/4 and double at
    // a = (1 − b)² + (1 + b)²/4.
    let b = 0.3_f64;
    let mut fixed = MapCycle::of(Henon, 1);
    let along = Continuation::new(&mut fixed).at("b", b).along("a", -1.0..=1.0).trace().unwrap();
    close(along.of_kind(Kind::LP).next().unwrap().parameters[0], -(1.0 - b).powi(2) / 4.0, 1e-12);
    let doubling = along.of_kind(Kind::PD).next().unwrap();
    close(doubling.parameters[0], 0.75 * (1.0 - b).powi(2), 1e-12);
    let mut other = MapCycle::of(Henon, 1);
    let two = Continuation::new(&mut other)
        .restart(&along, doubling.label)
        .switch()
        .along("a", 0.0..=1.2)
        .trace()
        .unwrap();
    assert_eq!(two.unknowns[0].length, 2);
    let doubling = two.of_kind(Kind::PD).next().unwrap();
    close(doubling.parameters[0], (1.0 - b).powi(2) + (1.0 + b).powi(2) / 4.0, 1e-12);
    let mut held = MapCycle::of(Henon, 1);
    let curve = Continuation::new(&mut held)
        .restart(&two, doubling.label)
        .hold(Kind::PD)
        .along("a", 0.0..=2.0)
        .along("b", 0.0..=0.6)
        .trace()
        .unwrap();
    assert!(curve.points.len() > 3);
    for point in &curve.points {
        let [a, b] = [point.parameters[0], point.parameters[1]];
        close(a, (1.0 - b).powi(2) + (1.0 + b).powi(2) / 4.0, 1e-8);
    }
}

/// `x ↦ y`, `y ↦ r y (1 − x) + e`: with `e = 0` the fixed point `1 − 1/r` has the multipliers of
/// modulus `√(r − 1)` that turn by 60° at `r = 2`.
pub struct Delayed;

impl DiscreteMap for Delayed {
    fn names(&self) -> Names {
        Names::new(["x", "y"], ["r", "e"])
    }

    fn next<T: Scalar>(&self, x: &[T], p: &[T], next: &mut [T]) {
        next[0] = x[1];
        next[1] = p[0] * x[1] * (T::one() - x[0]) + p[1];
    }
}

#[test]
fn torus_points_of_cycles_and_their_curve() {
    // As cycles of two: the multipliers are squares, and turn by 120°.
    for iterates in [1, 2] {
        let mut cycles = MapCycle::of(Delayed, iterates);
        let start = vec![1.0 - 1.0 / 1.5; 2 * iterates];
        let branch = Continuation::new(&mut cycles)
            .from(&start)
            .at("r", 1.5)
            .along("r", 1.2..=2.5)
            .trace()
            .unwrap();
        let torus = branch.of_kind(Kind::TR).next().unwrap();
        close(torus.parameters[0], 2.0, 1e-12);
        let mut cycles = MapCycle::of(Delayed, iterates);
        let curve = Continuation::new(&mut cycles)
            .restart(&branch, torus.label)
            .hold(Kind::TR)
            .along("r", 1.5..=2.5)
            .along("e", -0.1..=0.1)
            .trace()
            .unwrap();
        // x = r x (1 − x) + e with r x = 1: the determinant r x of the Jacobian is 1.
        assert!(curve.points.len() > 3);
        for point in &curve.points {
            let [r, e] = [point.parameters[0], point.parameters[1]];
            close(e, 2.0 / r - 1.0, 1e-8);
        }
    }
}

#[test]
fn monitors_of_cycles_and_their_gradients() {
    let mut cycles = MapCycle::of(Henon, 2);
    let z = cycles.unknowns(&[0.5, -0.2, -1.5, 0.3]);
    let x = [&z[..], &[2.0, 0.3]].concat();
    let mut values = [0.0; 6];
    cycles.monitors(&x, 0, &mut values).unwrap();
    for (found, expected) in values.iter().zip([0.5, -1.5, 0.3, -0.2, -0.2, -0.9]) {
        close(*found, expected, 1e-15);
    }
    let mut gradient = [0.0; 6];
    cycles.gradient(&x, Functional::Monitor(5), &[0, 1], &mut gradient).unwrap();
    for (found, expected) in gradient.iter().zip([0.0, 0.6, 0.0, -3.0, -0.45, 0.0]) {
        close(*found, expected, 1e-15);
    }
}

/// Gradients of the conditions by central differences of their values.
#[test]
fn gradients_of_conditions_on_cycles() {
    // The product of the three Jacobians, whose determinant is −b³, has a complex pair.
    let states = [0.2, -0.2, -0.1, 0.3, 0.15, 0.1];
    for condition in 0..3 {
        let make = || -> Box<dyn DefiningSystem> {
            match condition {
                0 => Box::<Fold>::default(),
                1 => Box::new(Fold::period_doubling()),
                _ => Box::new(Hopf::neimark_sacker()),
            }
        };
        let mut cycles = MapCycle::of(Henon, 3);
        let x = [&cycles.unknowns(&states)[..], &[1.1, -0.9]].concat();
        let mut condition = make();
        let (k, released) = (condition.unknowns(), [0, 1]);
        let mut y = vec![0.0; k];
        let mut null = NullSpace::default();
        let mut at = |x: &[f64], work: &mut dyn FnMut(At)| {
            work(At { system: &mut cycles, x, released: &released, held: &[], null: &mut null });
        };
        at(&x, &mut |at| condition.start(at, &mut y).unwrap());
        let (mut rows, mut own) = (vec![0.0; (k + 1) * x.len()], vec![0.0; (k + 1) * k]);
        let mut values = vec![0.0; k + 1];
        at(&x, &mut |at| condition.values(at, &y, &mut values).unwrap());
        at(&x, &mut |at| condition.gradients(at, &mut rows, &mut own).unwrap());
        for i in 0..x.len() {
            let h = 1e-5;
            let mut sides = [vec![0.0; k + 1], vec![0.0; k + 1]];
            for (side, sign) in sides.iter_mut().zip([1.0, -1.0]) {
                let mut moved = x.clone();
                moved[i] += sign * h;
                at(&moved, &mut |at| condition.values(at, &y, side).unwrap());
            }
            for (j, (up, down)) in sides[0].iter().zip(&sides[1]).enumerate() {
                let slope = (up - down) / (2.0 * h);
                close(rows[j * x.len() + i], slope, 1e-8 * (1.0 + slope.abs()));
            }
        }
    }
}
