//! Promise: of two fields and a surface the library knows what slides; where sliding orbits change,
//! branches end at points that are named, are followed, and go on with other orbits; and what
//! branches call stable a simulation settles on.

use crate::common::close;
use crate::common::settling::settling;
use crate::hybrid::systems::sliding::{ByHand, Mark, Sliding, on_belt, vanishing};
use nalgebra::DMatrix;
use std::f64::consts::TAU;
use tangency::core::attractor::CycleSearch;
use tangency::core::bvp::{BoundarySystem, Shooting};
use tangency::core::continuation::{Branch, Continuation, End, SpecialPoint};
use tangency::core::hybrid::filippov::{Filippov, FilippovSystem};
use tangency::core::hybrid::{HybridFlow, HybridSettings, HybridState};
use tangency::core::orbit::from_cycle;
use tangency::core::system::Kind;

/// The parameters of a system, one of which has another value.
fn parameters(system: Sliding, (name, value): (&str, f64)) -> Vec<f64> {
    let all = system.parameters();
    all.into_iter().map(|(known, usual)| if known == name { value } else { usual }).collect()
}

/// The orbits with the itinerary on which a simulation settles, and that orbit.
fn settled(system: Sliding, p: &[f64]) -> (BoundarySystem, Vec<f64>) {
    let hybrid = Filippov(system);
    let mut flow = HybridFlow::new(&hybrid, HybridSettings::default()).unwrap();
    let start = HybridState { mode: Filippov::<Sliding>::ABOVE, time: 0.0, x: system.start() };
    let search = CycleSearch { transient: 300.0, ..CycleSearch::default() };
    let cycle = search.find(&mut flow, start, p).unwrap();
    from_cycle(Filippov(system), &cycle, p, Shooting::default(), 1).unwrap()
}

/// The branch through the orbit on which a simulation settles at a value of a parameter, marked at
/// twenty places.
pub(super) fn simulated(
    system: Sliding,
    (name, value): (&str, f64),
    range: [f64; 2],
    marks: [f64; 2],
) -> (BoundarySystem, Branch) {
    let p = parameters(system, (name, value));
    let (mut orbits, z) = settled(system, &p);
    let names = system.parameters();
    let run = Continuation::new(&mut orbits).from(&z);
    let run = names.iter().zip(&p).fold(run, |run, ((name, _), p)| run.at(name, *p));
    let branch = marked(run, name, marks).along(name, range[0]..=range[1]).trace().unwrap();
    (orbits, branch)
}

/// Marks twenty values of a parameter within a range.
fn marked<'a>(run: Continuation<'a>, name: &str, [low, high]: [f64; 2]) -> Continuation<'a> {
    let values = (0..20).map(|k| low + (high - low) * (k as f64 + 0.5) / 20.0);
    values.fold(run, |run, value| run.mark(name, value))
}

/// The grazing at which a parameter has nearly a value.
pub(super) fn at<'a>(branch: &'a Branch, name: &str, value: f64) -> &'a SpecialPoint {
    let column = branch.column(name).unwrap();
    let near = |point: &&SpecialPoint| (point.value(column).unwrap() - value).abs() < 1e-3;
    let found = branch.of_kind(Kind::G).find(near);
    found.unwrap_or_else(|| panic!("{:?}", branch.special))
}

/// A branch ends at a sliding bifurcation of a kind, at a value of a parameter.
#[track_caller]
pub(super) fn ends(branch: &Branch, kind: &str, (name, value): (&str, f64)) {
    let grazing = at(branch, name, value);
    close(grazing.value(branch.column(name).unwrap()).unwrap(), value, 1e-8);
    assert_eq!(grazing.subkind.as_deref(), Some(kind));
    assert!(grazing.converged && grazing.error < 1e-9, "{}", grazing.error);
    let same =
        |end: &End| matches!(end, End::Grazing { subkind: Some(known), .. } if known == kind);
    assert!(branch.ends.iter().any(same), "{:?}", branch.ends);
}

/// The branch on the other side of a grazing, marked at twenty places.
pub(super) fn switched(
    orbits: &mut BoundarySystem,
    (branch, grazing): (&Branch, usize),
    name: &str,
    range: [f64; 2],
    marks: [f64; 2],
) -> Branch {
    let run = Continuation::new(orbits).restart(branch, grazing).switch();
    marked(run, name, marks).along(name, range[0]..=range[1]).trace().unwrap()
}

/// The margin by which motion that arrives at the belt in a mode, 0 below its velocity and 1 above,
/// is held there, or passes.
fn margin_on_belt(nu: f64, mode: usize) -> f64 {
    on_belt([nu, 3.0], |motion| {
        let mut last = 0.0;
        motion.run([1.0, 0.1, 0.0], 300.0, |mark, t, x| match mark {
            Mark::Arrival(from) if from == mode => last = (motion.normal)(t, x)[1 - mode],
            _ => {}
        });
        last
    })
}

/// How far motion stays below the belt's velocity.
fn distance_to_belt(nu: f64) -> f64 {
    on_belt([nu, 3.0], |motion| {
        let mut least = f64::INFINITY;
        motion.run([1.0, 0.1, 0.0], 300.0, |_, t, x| {
            if t > 300.0 - 1.5 * TAU / nu {
                least = f64::min(least, 1.0 - x[1]);
            }
        });
        least
    })
}

/// All four kinds come along one parameter; each branch begins where the one before ends, at places
/// that simulations by hand find.
#[test]
fn a_mass_on_a_belt_has_all_sliding_bifurcations() {
    let system = Filippov(Sliding::Friction);
    let grazing = vanishing(distance_to_belt, 3.2086, 4e-3);
    let switching = vanishing(|nu| margin_on_belt(nu, 0), 2.7138, 4e-3);
    let crossing = vanishing(|nu| margin_on_belt(nu, 1), 1.6915, -4e-3);
    let range = [0.6, 4.0];
    let (mut orbits, slip) = simulated(Sliding::Friction, ("nu", 4.0), range, [3.21, 3.9]);
    ends(&slip, "grazing-sliding", ("nu", grazing));
    assert_eq!(settling(&system, &slip), [20, 0, 0, 0]);
    let next = at(&slip, "nu", grazing).label;
    let stick = switched(&mut orbits, (&slip, next), "nu", range, [2.72, 3.2]);
    assert_eq!(stick.itinerary, "stick:slower slower:belt");
    ends(&stick, "switching-sliding", ("nu", switching));
    assert_eq!(settling(&system, &stick), [20, 0, 0, 0]);
    let next = at(&stick, "nu", switching).label;
    let late = switched(&mut orbits, (&stick, next), "nu", range, [1.7, 2.7]);
    assert_eq!(late.itinerary, "stick:slower slower:belt faster:belt");
    ends(&late, "crossing-sliding", ("nu", crossing));
    assert_eq!(settling(&system, &late), [20, 0, 0, 0]);
    let next = at(&late, "nu", crossing).label;
    let pass = switched(&mut orbits, (&late, next), "nu", range, [0.62, 1.68]);
    assert_eq!(pass.itinerary, "slower:belt faster:belt");
    assert_eq!(settling(&system, &pass), [20, 0, 0, 0]);
}

/// The other way round, from orbits that cross to those that slide.
#[test]
fn orbits_that_cross_begin_to_slide() {
    let system = Filippov(Sliding::Friction);
    let (mut orbits, pass) = simulated(Sliding::Friction, ("nu", 1.2), [0.3, 4.0], [0.57, 1.69]);
    let crossing = at(&pass, "nu", 1.69152176791);
    assert!(crossing.subkind.as_deref() == Some("crossing-sliding"), "{}", crossing.event);
    let label = crossing.label;
    let slide = switched(&mut orbits, (&pass, label), "nu", [0.3, 4.0], [1.7, 2.7]);
    assert_eq!(slide.itinerary, "slower:belt faster:belt stick:slower");
    assert_eq!(settling(&system, &slide), [20, 0, 0, 0]);
    let switching = at(&slide, "nu", 2.71383664883);
    assert!(switching.subkind.as_deref() == Some("switching-sliding"), "{}", switching.event);
    let label = switching.label;
    let stick = switched(&mut orbits, (&slide, label), "nu", [0.3, 4.0], [2.72, 3.2]);
    assert_eq!(stick.itinerary, "slower:belt stick:slower");
    assert_eq!(settling(&system, &stick), [20, 0, 0, 0]);
}

/// The relay by hand, where `ζ = λ = 0.05`, `σ = −1`, `ρ = 1`: sliding keeps `u = −y`.
fn relay_by_hand<R>(omega: f64, with: impl FnOnce(ByHand) -> R) -> R {
    let field = move |mode: usize, _t: f64, x: &[f64; 3]| {
        let u = [-1.0, 1.0, -x[1]][mode];
        let slope = if mode == 2 { 0.0 } else { x[1] - (0.1 * omega + 0.05) * x[0] + u };
        let square = omega * omega;
        [slope, x[2] - (0.005 * omega + square) * x[0] - 2.0 * u, u - 0.05 * square * x[0]]
    };
    with(ByHand {
        field: &field,
        surface: &|x| x[0],
        normal: &|_, x| [x[1] - 1.0, x[1] + 1.0],
        probe: &|mode, t, x| (mode == 2).then(|| field(2, t, x)[1]),
        step: 5e-4,
    })
}

/// The margin by which a relay's motion that arrives from above crosses.
fn margin_of_relay(omega: f64) -> f64 {
    relay_by_hand(omega, |motion| {
        let mut last = 0.0;
        motion.run([0.5, 0.1, -0.3], 400.0, |mark, _, x| {
            if let Mark::Arrival(0) = mark {
                last = x[1] + 1.0;
            }
        });
        last
    })
}

/// How near a relay's sliding comes to an end that it does not pass.
fn distance_of_relay(omega: f64) -> f64 {
    relay_by_hand(omega, |motion| {
        let mut least = f64::INFINITY;
        motion.run([0.5, 0.1, -0.3], 300.0, |mark, t, x| {
            if let (Mark::Probe, true) = (mark, t > 270.0) {
                least = f64::min(least, 1.0 - x[1].abs());
            }
        });
        least
    })
}

#[test]
fn a_relay_slides_beyond_a_crossing_sliding() {
    let system = Filippov(Sliding::Relay);
    let crossing = vanishing(margin_of_relay, 1.706, -4e-3);
    let (mut orbits, cross) = simulated(Sliding::Relay, ("omega", 1.4), [1.0, 3.5], [1.1, 1.7]);
    assert_eq!(cross.itinerary.matches("sliding").count(), 0);
    ends(&cross, "crossing-sliding", ("omega", crossing));
    assert_eq!(settling(&system, &cross), [20, 0, 0, 0]);
    let next = at(&cross, "omega", crossing).label;
    let slide = switched(&mut orbits, (&cross, next), "omega", [1.0, 3.5], [1.72, 3.48]);
    assert_eq!(slide.itinerary.matches("sliding").count(), 2);
    assert_eq!(settling(&system, &slide), [20, 0, 0, 0]);
    // Back again.
    let mark = slide.of_kind(Kind::UZ).next().unwrap().label;
    let run = Continuation::new(&mut orbits).restart(&slide, mark);
    let down = run.along("omega", 1.0..=2.0).trace().unwrap();
    ends(&down, "crossing-sliding", ("omega", crossing));
    let back = at(&down, "omega", crossing).label;
    let cross = switched(&mut orbits, (&down, back), "omega", [1.0, 3.5], [1.1, 1.7]);
    assert_eq!(cross.itinerary.matches("sliding").count(), 0);
}

#[test]
fn a_relay_adds_a_slide() {
    let system = Filippov(Sliding::Relay);
    let adding = vanishing(distance_of_relay, 15.6734, -2e-3);
    let (_, branch) = simulated(Sliding::Relay, ("omega", 15.2), [14.0, 17.0], [14.8, 15.66]);
    ends(&branch, "adding-sliding", ("omega", adding));
    assert!(at(&branch, "omega", 14.78731685).subkind.as_deref() == Some("grazing-sliding"));
    assert_eq!(settling(&system, &branch), [20, 0, 0, 0]);
}

/// How far the voltage of Chua's circuit stays below `E`, where its motion has settled.
fn distance_of_chua(alpha: f64) -> f64 {
    let rate = move |x: &[f64; 3]| alpha * (x[1] + x[0] / 7.0 - x[0].powi(3) * 4.0 / 63.0);
    let motion = ByHand {
        field: &|_, _, x| [rate(x), x[0] - x[1] + x[2], -14.0 * x[1]],
        surface: &|x| 1.8 - x[0],
        normal: &|_, x| [-rate(x), 0.5 * alpha - rate(x)],
        probe: &|_, _, x| Some(rate(x)),
        step: 1e-3,
    };
    let mut least = f64::INFINITY;
    motion.run([1.75, 0.0, -1.75], 2000.0, |_, t, x| {
        if t > 1990.0 {
            least = f64::min(least, 1.8 - x[0]);
        }
    });
    least
}

#[test]
fn a_circuit_begins_to_slide_where_it_grazes() {
    let system = Filippov(Sliding::Chua);
    let grazing = vanishing(distance_of_chua, 6.9336, -3e-3);
    let (mut orbits, free) = simulated(Sliding::Chua, ("alpha", 6.85), [6.8, 8.3], [6.81, 6.93]);
    ends(&free, "grazing-sliding", ("alpha", grazing));
    assert_eq!(settling(&system, &free), [20, 0, 0, 0]);
    let next = at(&free, "alpha", grazing).label;
    let clipped = switched(&mut orbits, (&free, next), "alpha", [6.8, 8.3], [6.95, 8.2]);
    assert_eq!(clipped.itinerary, "sliding:above above:surface");
    assert_eq!(settling(&system, &clipped), [20, 0, 0, 0]);
    // In two parameters, the orbit being the same: the largest voltage is E.
    let run = Continuation::new(&mut orbits).restart(&free, next).hold(Kind::G);
    let curve = run.along("alpha", 6.8..=8.0).along("E", 1.5..=2.0).trace().unwrap();
    let largest = curve.column("max_x").unwrap();
    assert!(curve.points.len() > 5);
    for point in &curve.points {
        close(point.value(largest).unwrap(), point.parameters[2], 1e-9);
    }
}

/// Two parameters at a grazing-sliding of the belt: simulations by hand touch it there.
#[test]
fn curves_of_sliding_bifurcations_are_followed() {
    let (mut orbits, slip) = simulated(Sliding::Friction, ("nu", 4.0), [0.6, 4.0], [3.21, 3.9]);
    let grazing = at(&slip, "nu", 3.20856896212).label;
    let run = Continuation::new(&mut orbits).restart(&slip, grazing).hold(Kind::G);
    let curve = run.along("nu", 2.5..=4.0).along("A", 2.0..=4.0).trace().unwrap();
    assert!(curve.points.len() > 3 && curve.condition == Some(Kind::G));
    let fastest = curve.column("max_v").unwrap();
    for point in &curve.points {
        close(point.value(fastest).unwrap(), 1.0, 1e-9);
    }
}

/// Multipliers against differences of simulations: each segment of sliding takes one direction
/// away.
#[test]
fn sliding_takes_a_multiplier_away() {
    for (system, value, name, modulo) in [
        (Sliding::Friction, 3.0, "nu", 1),
        (Sliding::Relay, 3.0, "omega", 0),
        (Sliding::Chua, 7.5, "alpha", 0),
    ] {
        let p = parameters(system, (name, value));
        let (mut orbits, z) = settled(system, &p);
        let names = system.parameters();
        let run = Continuation::new(&mut orbits).from(&z);
        let run = names.iter().zip(&p).fold(run, |run, ((name, _), p)| run.at(name, *p));
        let run = run.mark(name, value + 0.005).along(name, value..=value + 0.01);
        let branch = run.trace().unwrap();
        let point = branch.of_kind(Kind::UZ).next().unwrap();
        let mut found: Vec<f64> = point.eigenvalues.iter().map(|(re, im)| re.hypot(*im)).collect();
        assert!(found.iter().any(|modulus| *modulus < 1e-9), "{system:?}: {found:?}");
        found.retain(|modulus| *modulus > 1e-6);
        let mut expected = by_differences(system, &point.parameters);
        expected.retain(|modulus| *modulus > 1e-6);
        // A phase that is free has the multiplier 1, which the orbit's equations leave out.
        let trivial = expected.iter().position(|modulus| (modulus - 1.0).abs() < 1e-4);
        if let (0, Some(trivial)) = (modulo, trivial) {
            expected.remove(trivial);
        }
        found.sort_by(f64::total_cmp);
        expected.sort_by(f64::total_cmp);
        assert_eq!(found.len(), expected.len(), "{system:?}: {found:?}, {expected:?}");
        for (found, expected) in found.iter().zip(expected) {
            close(*found, expected, 1e-5);
        }
    }
}

/// Moduli of the eigenvalues of the map over one period, by central differences of simulations that
/// begin above the surface.
fn by_differences(system: Sliding, p: &[f64]) -> Vec<f64> {
    let hybrid = Filippov(system);
    let mut flow = HybridFlow::new(&hybrid, HybridSettings::default()).unwrap();
    let above = Filippov::<Sliding>::ABOVE;
    let start = HybridState { mode: above, time: 0.0, x: system.start() };
    let search = CycleSearch { transient: 600.0, tolerance: 1e-9, ..CycleSearch::default() };
    let cycle = search.find(&mut flow, start, p).unwrap();
    let mut passed = cycle.start;
    let leg = cycle.legs.iter().find(|leg| {
        passed += if leg.mode == above { 0.0 } else { leg.duration };
        leg.mode == above
    });
    let leg = leg.expect("a leg above the surface");
    let mut inside = HybridState { mode: above, time: passed, x: leg.start.clone() };
    flow.advance(&mut inside, 0.5 * leg.duration, p, &mut ()).unwrap();
    let n = inside.x.len();
    let mut after = |i: usize, by: f64| {
        let mut state = inside.clone();
        state.x[i] += by;
        flow.advance(&mut state, cycle.duration(), p, &mut ()).unwrap();
        state.x
    };
    let h = 1e-6;
    let mut matrix = DMatrix::<f64>::zeros(n, n);
    for i in 0..n {
        let [plus, minus] = [after(i, h), after(i, -h)];
        (0..n).for_each(|k| matrix[(k, i)] = (plus[k] - minus[k]) / (2.0 * h));
    }
    matrix.complex_eigenvalues().iter().map(|value| value.norm()).collect()
}

/// Sliding follows a curved surface that moves.
#[test]
fn sliding_stays_on_a_surface_that_moves() {
    let (system, p) = (Filippov(Sliding::Circle), [0.1]);
    let mut flow = HybridFlow::new(&system, HybridSettings::default()).unwrap();
    let mut state = HybridState { mode: Filippov::<Sliding>::ABOVE, time: 0.0, x: vec![2.0, 0.0] };
    flow.advance(&mut state, 30.0, &p, &mut ()).unwrap();
    assert_eq!(state.mode, Filippov::<Sliding>::SLIDING);
    close(Sliding::Circle.surface(state.time, &state.x, &p), 0.0, 1e-11);
    // Both fields turn at the same rate, and so does sliding.
    let turned = (30.0_f64).rem_euclid(TAU);
    close(state.x[1].atan2(state.x[0]).rem_euclid(TAU), turned, 1e-9);
}
