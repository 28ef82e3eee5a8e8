//! Promise: what conditions mean is stated, and user code is called at states of solutions only.

use std::f64::consts::TAU;
use tangency::core::bvp::{BoundarySystem, Mesh, Shooting};
use tangency::core::continuation::Continuation;
use tangency::core::hybrid::{Guard, HybridSystem, Mode};
use tangency::core::orbit::{HybridOrbit, Itinerary, MapCycle};
use tangency::core::problem::DiscreteMap;
use tangency::core::problem::{Forcing, Names};
use tangency::core::scalar::Scalar;
use tangency::core::system::{Kind, System};

/// `x ↦ x + (x − 1)(a − x)` above 1, and the identity in a dead zone below: the multiplier of the
/// fixed point `a` is `2 − a`.
struct DeadZone;

impl DiscreteMap for DeadZone {
    fn names(&self) -> Names {
        Names::new(["x"], ["a"])
    }
    fn next<T: Scalar>(&self, x: &[T], p: &[T], next: &mut [T]) {
        let moved = x[0] + (x[0] - 1.0) * (p[0] - x[0]);
        next[0] = if x[0].real() > 1.0 { moved } else { x[0] };
    }
}

#[test]
fn a_map_that_is_the_identity_somewhere_has_its_own_multipliers() {
    let mut points = MapCycle::of(DeadZone, 1);
    let run = Continuation::new(&mut points).from(&[1.5]).at("a", 1.5);
    let branch = run.along("a", 1.5..=4.0).trace().unwrap();
    let doublings: Vec<f64> = branch.of_kind(Kind::PD).map(|point| point.parameters[0]).collect();
    assert!(doublings.len() == 1 && (doublings[0] - 3.0).abs() < 1e-12, "{doublings:?}");
}

/// A ball on a table that vibrates, whose guard and reset mean nothing without gravity.
#[derive(Clone)]
struct Heavy;

fn checked<T: Scalar>(gravity: T) {
    assert!(gravity.real() > 5.0, "called with the gravity {}", gravity.real());
}

impl HybridSystem for Heavy {
    fn modes(&self) -> Vec<Mode> {
        vec![Mode::new("flight", ["x", "v"])]
    }
    fn guards(&self) -> Vec<Guard> {
        vec![Guard::new("impact", [0])]
    }
    fn parameters(&self) -> Vec<String> {
        vec!["gravity".into()]
    }
    fn forcing(&self) -> Forcing {
        Forcing::Periodic { phase: TAU }
    }
    fn period<T: Scalar>(&self, _p: &[T]) -> T {
        T::constant(TAU)
    }
    fn field<T: Scalar>(&self, _mode: usize, _t: T, x: &[T], p: &[T], f: &mut [T]) {
        f[0] = x[1];
        f[1] = -p[0];
    }
    fn guard<T: Scalar>(&self, _guard: usize, _mode: usize, t: T, x: &[T], p: &[T]) -> T {
        checked(p[0]);
        x[0] - t.cos()
    }
    fn reset<T: Scalar>(
        &self,
        _guard: usize,
        _modes: (usize, usize),
        t: T,
        x: &[T],
        p: &[T],
        after: &mut [T],
    ) {
        checked(p[0]);
        after[0] = x[0];
        after[1] = -x[1] * 0.5 - t.sin() * 1.5;
    }
    fn next_mode(&self, _guard: usize, mode: usize, _t: f64, _x: &[f64], _p: &[f64]) -> usize {
        mode
    }
}

#[test]
fn guards_and_resets_are_called_at_states_of_solutions_only() {
    let itinerary = Itinerary::read("flight:impact", &Heavy).unwrap();
    let orbit = HybridOrbit::of(Heavy, itinerary).unwrap();
    let mut orbits =
        BoundarySystem::new(orbit, Shooting::default(), vec![Mesh::uniform(1)]).unwrap();
    let (start, duration) = (0.4_f64, TAU);
    let z = orbits.flowed(&[start.cos(), 5.0 * TAU], &[start, duration], &[10.0]).unwrap();
    let x = [&z[..], &[10.0]].concat();
    let mut r = vec![0.0; z.len()];
    orbits.residual(&x, &mut r).unwrap();
    // The ball is back at its height after a period, and the surface as well: the leg's mean rate
    // is not that of its end.
    assert!(r.iter().all(|r| r.is_finite()));
}
