//! Promise: what conditions mean is stated, and user code is called at states of solutions only.

use std::f64::consts::TAU;
use tangency::core::bvp::{BoundarySystem, Mesh, Shooting};
use tangency::core::continuation::Continuation;
use tangency::core::orbit::{HybridOrbit, Itinerary, MapCycle};
use tangency::core::problem::DiscreteMap;
use tangency::core::problem::Names;
use tangency::core::scalar::Scalar;
use tangency::core::system::{Kind, System};
use tangency::hybrid_system;

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

hybrid_system! {
    /// A ball on a table that vibrates, whose guard and reset mean nothing without gravity.
    struct Heavy [gravity; t] {
        period = T::constant(TAU);
        mode flight [x, v] {
            d/dt x = v;
            d/dt v = -gravity;
            event impact: {
                checked(gravity);
                x - t.cos()
            } => flight {
                x,
                v: {
                    checked(gravity);
                    -v * 0.5 - t.sin() * 1.5
                },
            };
        }
    }
}

fn checked<T: Scalar>(gravity: T) {
    assert!(gravity.real() > 5.0, "called with the gravity {}", gravity.real());
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
