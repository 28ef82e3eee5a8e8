//! Promise: a branch of hybrid orbits ends in one G where it grazes, neither a fold nor a period
//! doubling comes with it, and the branch of orbits with the event begins there.

use crate::common::close;
use crate::hybrid::systems::dry_impact::{self, DryImpact};
use crate::hybrid::systems::impact_oscillator::ClosedForm;
use crate::hybrid::systems::orbits::{DIGITS, Start, found, impacting, nonimpacting, resting};
use std::f64::consts::{PI, TAU};
use tangency::core::attractor::CycleSearch;
use tangency::core::bvp::Shooting;
use tangency::core::continuation::{Branch, Continuation, End, Point};
use tangency::core::failure::one_line;
use tangency::core::hybrid::{HybridFlow, HybridSettings, HybridState, HybridSystem};
use tangency::core::local_map::GrazingPoint;
use tangency::core::ode::Scheme;
use tangency::core::orbit::from_cycle;
use tangency::core::system::Kind;
use tangency::hybrid_system;

/// The branch without impacts to its grazing, with the label of that.
fn to_grazing(start: &mut Start, grazing: f64) -> (Branch, usize) {
    let branch = start.along("amplitude", [0.1 * grazing, 2.0 * grazing]).trace().unwrap();
    let label = branch.of_kind(Kind::G).next().unwrap().label;
    (branch, label)
}

/// The branch ends by grazing in a monitor.
#[track_caller]
fn grazes(end: &End, monitor: &str) {
    assert!(matches!(end, End::Grazing { name, .. } if name == monitor), "{end}");
}

/// Special points but for ends are those expected, kind by kind, as near as closed forms promise.
#[track_caller]
fn are(branch: &Branch, expected: &[(Kind, f64)]) {
    let found = found(branch);
    let kinds = |points: &[(Kind, f64)]| points.iter().map(|(kind, _)| *kind).collect::<Vec<_>>();
    assert_eq!(kinds(&found), kinds(expected), "{}: {found:?}", branch.name);
    found.iter().zip(expected).for_each(|(found, expected)| close(found.1, expected.1, DIGITS));
}

/// The value of a column at a point.
fn value(branch: &Branch, point: &Point, name: &str) -> f64 {
    point.value(branch.column(name).unwrap()).unwrap()
}

/// Without impacts up to G, at `A = D d` to the digits, and with impacts from there on: through the
/// fold or the period doubling that closed forms know, and nothing else.
#[test]
fn branches_meet_in_one_grazing() {
    for frequency in [1.0, 1.2, 2.2] {
        let form = ClosedForm::usual(frequency);
        let grazing = form.grazing();
        let expected = match form.fold() > 0.0 {
            true => (Kind::LP, form.fold_amplitude(), form.fold()),
            false => (Kind::PD, form.amplitude(form.doubling()), form.doubling()),
        };
        for mut start in nonimpacting(&form, 0.5) {
            let (branch, label) = to_grazing(&mut start, grazing);
            are(&branch, &[(Kind::G, grazing)]);
            grazes(&branch.ends[1], "distance");
            assert!(
                branch.points.iter().all(|point| point.admissible && point.unstable == Some(0))
            );
            let impacting = Continuation::new(start.system.as_mut())
                .restart(&branch, label)
                .switch()
                .along("amplitude", 0.1 * grazing..=2.0 * grazing)
                .trace()
                .unwrap();
            are(&impacting, &[(expected.0, expected.1)]);
            let special = impacting.of_kind(expected.0).next().unwrap();
            let speed = special.value(impacting.column("approach").unwrap()).unwrap();
            close(speed, expected.2, DIGITS);
            let from_grazing =
                impacting.ends.iter().filter(|end| matches!(end, End::Grazing { .. }));
            assert_eq!(from_grazing.count(), 1, "{:?}", impacting.ends);
            on_the_family(&impacting, &form);
        }
    }
}

/// Every point of a branch is on the family `A(u)`, with the stability of its multipliers.
fn on_the_family(branch: &Branch, form: &ClosedForm) {
    for point in &branch.points {
        let u = value(branch, point, "approach");
        close(value(branch, point, "amplitude"), form.amplitude(u), DIGITS);
        assert!(point.admissible || u < DIGITS);
        let (trace, determinant) = (form.trace(u), form.determinant());
        let far = (1.0 + determinant - trace.abs()).abs() > 1e-6;
        if u > 1e-6 && far {
            let unstable = usize::from(trace.abs() > 1.0 + determinant);
            assert_eq!(point.unstable, Some(unstable), "u = {u}, {trace}");
        }
    }
}

/// Beyond G, orbits pass through the stop: they are followed on request, and marked.
#[test]
fn branches_go_on_as_virtual() {
    let form = ClosedForm::usual(2.2);
    let grazing = form.grazing();
    let range = [0.4 * grazing, 2.0 * grazing];
    for mut start in nonimpacting(&form, 0.5) {
        let branch = start.along("amplitude", range).beyond_grazings().trace().unwrap();
        are(&branch, &[(Kind::G, grazing)]);
        for point in &branch.points {
            let beyond = value(&branch, point, "amplitude") > grazing * (1.0 + 1e-8);
            assert_eq!(point.admissible, !beyond);
        }
        assert!(branch.points.iter().any(|point| !point.admissible));
    }
    // With an impact of negative speed through the fold that is none of the world's.
    for mut start in impacting(&form, 1.3) {
        let branch = start.along("amplitude", range).beyond_grazings().trace().unwrap();
        let near = |(_, a): &&(Kind, f64)| (a - grazing).abs() < 1e-3;
        let there: Vec<_> = found(&branch).iter().filter(near).map(|(kind, _)| *kind).collect();
        assert_eq!(there, [Kind::G], "{}: {:?}", branch.name, found(&branch));
        assert!(found(&branch).iter().any(|(kind, _)| *kind == Kind::LP));
        on_the_family(&branch, &form);
    }
}

/// Where a branch with impacts ends at a grazing, `switch()` leads to the orbits without them.
#[test]
fn touches_are_left_out() {
    let form = ClosedForm::usual(1.2);
    let range = [0.1 * form.grazing(), 2.0 * form.grazing()];
    for mut start in impacting(&form, 0.5) {
        let branch = start.along("amplitude", range).trace().unwrap();
        let label = branch.of_kind(Kind::G).next().unwrap().label;
        let run = Continuation::new(start.system.as_mut()).restart(&branch, label).switch();
        let without = run.along("amplitude", range[0]..=range[1]).trace().unwrap();
        let distance = without.column("distance").unwrap();
        assert_eq!(without.column("approach"), None);
        for point in &without.points {
            let touching = value(&without, point, "amplitude") / form.grazing();
            close(point.value(distance).unwrap(), form.clearance * (1.0 - touching), DIGITS);
        }
    }
}

/// The mass that rests, is hit, moves up and down: the branch ends where the spring would move it
/// before it is hit.
#[test]
fn dry_impacts_end_in_sliding() {
    let form = dry_impact::ClosedForm::new(DryImpact::DEFAULTS);
    let [sliding] = form.switching_sliding()[..] else { panic!("one place") };
    for mut start in resting(5.2) {
        let branch = start.along("stiffness", [5.2, 7.0]).trace().unwrap();
        are(&branch, &[(Kind::G, sliding)]);
        grazes(&branch.ends[1], "distance");
    }
}

hybrid_system! {
    /// A neuron that leaks and fires, `x' = I − x + A sin ωt`: from 1 it is set to 0.
    struct Neuron [current, amplitude, frequency; t] {
        period = frequency.recip() * TAU;
        mode rest [voltage] {
            d/dt voltage = current - voltage + amplitude * (frequency * t).sin();
            event spike: -voltage + 1.0 => rest { voltage: T::zero() };
        }
    }
}

/// Where the reset jumps, the orbits with the event are not near that which touches, nor those
/// without it near that whose event has no speed: `switch()` says so, and there is no local map. In
/// silence `x = I + A sin(ωt − φ)/√(1 + ω²)`, which touches 1 at `I = 1 − A/√(1 + ω²)`. The neuron
/// that fires once a period at the phase `θ` has no speed there if `I = 1 − A sin θ`, and comes
/// from 0 to 1 if `−A sin(θ + acot ω) ω/√(1 + ω²) = d/(1 − d)` with the decay `d` of a period.
#[test]
fn no_branch_begins_where_a_reset_jumps() {
    let [amplitude, frequency] = [0.5, 4.0_f64];
    let root = frequency.hypot(1.0);
    let decay = (-TAU / frequency).exp();
    let sine = decay / (1.0 - decay) * root / (amplitude * frequency);
    let phase = PI + sine.asin() - (1.0 / frequency).atan();
    let silent = (0.1, "distance", 1.0 - amplitude / root);
    let firing = (1.26, "approach", 1.0 - amplitude * phase.sin());
    for (current, monitor, exact) in [silent, firing] {
        let p = [current, amplitude, frequency];
        let mut flow = HybridFlow::new(&Neuron, HybridSettings::default()).unwrap();
        let start = HybridState { mode: 0, time: 0.0, x: vec![0.0] };
        let cycle = CycleSearch::default().find(&mut flow, start, &p).unwrap();
        let method = Shooting::new(Scheme::DormandPrince8, 1e-13).unwrap();
        let (mut orbits, z) = from_cycle(Neuron, &cycle, &p, method, 1).unwrap();
        let names = Neuron.parameters();
        let run = Continuation::new(&mut orbits).from(&z);
        let run = names.iter().zip(&p).fold(run, |run, (name, p)| run.at(name, *p));
        let branch = run.along("current", 0.0..=2.0).trace().unwrap();
        let mut grazings = branch.of_kind(Kind::G);
        let grazing = grazings.find(|point| point.event.contains(monitor)).unwrap();
        close(grazing.parameters[0], exact, DIGITS);
        let run = Continuation::new(&mut orbits).restart(&branch, grazing.label).switch();
        let refused = one_line(&run.along("current", 0.0..=2.0).trace().unwrap_err());
        let no_point = GrazingPoint::at(&mut orbits, &branch.solution(grazing)).unwrap_err();
        for error in [refused, no_point.to_string()] {
            assert!(error.contains("the event spike changes voltage from 1.0"), "{error}");
        }
    }
}
