//! Promise: how far an orbit would penetrate a surface is told exactly, and by one monitor whether it reaches the
//! surface or not.

use crate::common::close;
use crate::systems::impact_oscillator::ClosedForm;
use tangency::core::bvp::{BoundarySystem, Mesh, Shooting};
use tangency::core::continuation::{Branch, Continuation, Kind};
use tangency::core::hybrid::HybridSystem;
use tangency::core::orbit::{HybridOrbit, Itinerary, virtual_point};
use tangency::problems::classic::ImpactOscillator;

/// The largest displacement of the motion that has a speed `u` at the stop, as if there were none, less the clearance:
/// by bisection for its velocity.
fn penetration(form: &ClosedForm, u: f64) -> f64 {
    let motion = |after| form.flight(form.amplitude(u), [form.time(u), u], after);
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if motion(middle)[1] > 0.0 { low = middle } else { high = middle }
    }
    motion(low)[0] - form.clearance
}

/// Values of a column at the points of a kind.
fn values(branch: &Branch, kind: Kind, name: &str) -> Vec<f64> {
    let column = branch.column(name).unwrap();
    branch.of_kind(kind).map(|point| point.value(column).unwrap()).collect()
}

/// Orbits of the oscillator from below their grazing to a penetration of 0.01, where that is `−distance` first, and
/// then that of the closed form at the speed of the impact. Levels of it are found where they are.
#[test]
fn penetrations_are_those_of_the_closed_form() {
    let form = ClosedForm::usual(1.2);
    let orbit = HybridOrbit::of(ImpactOscillator, Itinerary::smooth(ImpactOscillator::FLIGHT, 1));
    let meshes = vec![Mesh::uniform(1)];
    let mut orbits =
        BoundarySystem::new(orbit.with_penetration(), Shooting::default(), meshes).unwrap();
    let names = ImpactOscillator.parameters();
    let known = names.iter().zip(ImpactOscillator::DEFAULTS);
    let run = known.fold(Continuation::of(&mut orbits), |run, (name, p)| run.at(name, p));
    let run = run.at("frequency", 1.2).at("amplitude", 0.1).along("amplitude", 0.1..=1.0);
    let passing = run.mark("penetration", -0.5).trace().unwrap();
    let amplitude = passing.of_kind(Kind::UZ).next().unwrap().parameters[0];
    close(amplitude, 0.5 * form.stiffness, 1e-10);
    let label = passing.of_kind(Kind::G).next().unwrap().label;
    let run = Continuation::of(&mut orbits).restart(&passing, label).switch();
    let run = run.along("amplitude", 0.1..=1.0).mark("penetration", 1e-6).mark("penetration", 0.01);
    let impacting = run.trace().unwrap();
    let found = values(&impacting, Kind::UZ, "penetration");
    let speeds = values(&impacting, Kind::UZ, "approach");
    // The amplitude is no function of the penetration: levels are passed more than once.
    assert!(found.len() >= 2);
    for (found, u) in found.iter().zip(speeds) {
        let level = if *found < 1e-3 { 1e-6 } else { 0.01 };
        close(*found, level, 1e-11);
        close(penetration(&form, u), level, 1e-10);
    }
}

/// Motion that is pushed on for all the time within which it is to turn has no virtual point.
#[test]
fn motion_that_does_not_turn_has_none() {
    let guard = (ImpactOscillator::IMPACT, ImpactOscillator::FLIGHT);
    // The force pushes the mass on, with an acceleration of 9.
    let p = [10.0, 1e-6, 0.8, 0.0, 1.0];
    assert!(virtual_point(&ImpactOscillator, guard, (0.0, &[1.0, 0.1]), &p, 1.0).is_none());
}
