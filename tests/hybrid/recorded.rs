//! Promise: along branches through a grazing, how far orbits would penetrate the surface is told
//! exactly, and by one monitor whether they reach it or not; and the multipliers that are kept with
//! points are those of the closed form.

use crate::common::close;
use crate::hybrid::systems::impact_oscillator::ClosedForm;
use crate::hybrid::systems::multipliers;
use std::f64::consts::TAU;
use tangency::core::bvp::{BoundarySystem, Mesh, Shooting};
use tangency::core::continuation::{Branch, Continuation, Settings};
use tangency::core::hybrid::{HybridSystem, virtual_point};
use tangency::core::orbit::{HybridOrbit, Itinerary};
use tangency::core::system::{Kind, System};
use tangency::problems::classic::ImpactOscillator;

/// The largest displacement of the motion that has a speed `u` at the stop, as if there were none,
/// less the clearance: by bisection for its velocity.
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

/// Orbits of the oscillator at ω = 1.2, at first without impacts.
fn orbits() -> BoundarySystem {
    let orbit =
        HybridOrbit::of(ImpactOscillator, Itinerary::smooth(ImpactOscillator::FLIGHT, 1)).unwrap();
    let meshes = vec![Mesh::uniform(1)];
    BoundarySystem::new(orbit.with_penetration(), Shooting::default(), meshes).unwrap()
}

/// A run without impacts from the amplitude 0.1.
fn passing(orbits: &mut dyn System) -> Continuation<'_> {
    let names = ImpactOscillator.parameters();
    let known = names.iter().zip(ImpactOscillator::DEFAULTS);
    let run = known.fold(Continuation::new(orbits), |run, (name, p)| run.at(name, p));
    run.at("frequency", 1.2).at("amplitude", 0.1).along("amplitude", 0.1..=1.0)
}

/// A run with one impact in a period from where a branch grazes.
fn impacting<'a>(orbits: &'a mut dyn System, passing: &Branch) -> Continuation<'a> {
    let label = passing.of_kind(Kind::G).next().unwrap().label;
    Continuation::new(orbits).restart(passing, label).switch().along("amplitude", 0.1..=1.0)
}

/// Orbits of the oscillator from below their grazing to a penetration of 0.01, where that is
/// `−distance` first, and then that of the closed form at the speed of the impact. Levels of it are
/// found where they are.
#[test]
fn penetrations_are_those_of_the_closed_form() {
    let (form, mut orbits) = (ClosedForm::usual(1.2), orbits());
    let below = passing(&mut orbits).mark("penetration", -0.5).trace().unwrap();
    let amplitude = below.of_kind(Kind::UZ).next().unwrap().parameters[0];
    close(amplitude, 0.5 * form.stiffness, 1e-10);
    let run = impacting(&mut orbits, &below).mark("penetration", 1e-6).mark("penetration", 0.01);
    let above = run.trace().unwrap();
    let found = values(&above, Kind::UZ, "penetration");
    let speeds = values(&above, Kind::UZ, "approach");
    // The amplitude is no function of the penetration: levels are passed more than once.
    assert!(found.len() >= 2);
    for (found, u) in found.iter().zip(speeds) {
        let level = if *found < 1e-3 { 1e-6 } else { 0.01 };
        close(*found, level, 1e-11);
        close(penetration(&form, u), level, 1e-10);
    }
}

/// Without an impact `e^{−cT/2}` turned by `√(1 − c²/4) T`; with one those of trace and
/// determinant, but for the other unknowns of the itinerary; none at the grazing itself, where one
/// is infinite. Where fewer are asked for, the largest are kept.
#[test]
fn multipliers_are_kept() {
    let (form, mut system) = (ClosedForm::usual(1.2), orbits());
    let keep = |eigenvalues| Settings { eigenvalues, ..Settings::default() };
    let below = passing(&mut system).settings(keep(2)).trace().unwrap();
    let ([real, imaginary], period) = (["eigenvalue[0]", "eigenvalue[0].imaginary"], TAU / 1.2);
    let [real, imaginary] = [real, imaginary].map(|name| below.column(name).unwrap());
    let (size, turn) = ((-0.05 * period).exp(), (1.0 - 0.0025_f64).sqrt() * period);
    for point in &below.points[..below.points.len() - 1] {
        close(point.value(real).unwrap(), size * turn.cos(), 1e-10);
        close(point.value(imaginary).unwrap(), size * turn.sin().abs(), 1e-10);
    }
    assert_eq!(below.column("eigenvalue[2]"), None);
    for count in [1, 2] {
        let above = impacting(&mut system, &below).settings(keep(count)).trace().unwrap();
        let speed = above.column("approach").unwrap();
        let mut compared = 0;
        for point in &above.points {
            let u = point.value(speed).unwrap();
            let mut expected = multipliers(form.trace(u), form.determinant())[..count].to_vec();
            expected.sort_by(|a, b| b.0.total_cmp(&a.0));
            let size = expected.iter().fold(1.0, |most: f64, mu| mu.0.abs().max(most));
            for (found, expected) in point.eigenvalues.iter().zip(expected) {
                close(found.0, expected.0, 1e-8 * size);
                close(found.1, expected.1, 1e-8 * size);
                compared += 1;
            }
            assert!(u > 1e-7 || point.eigenvalues.is_empty());
        }
        assert!(compared > 10 * count);
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
