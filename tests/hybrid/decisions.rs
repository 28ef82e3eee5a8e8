//! Promise: where an event begins to be followed by another mode, a branch of orbits ends at a
//! located grazing, the curve of such points is followed, and the branch of orbits on the other
//! side begins there.

use crate::common::close;
use crate::hybrid::systems::coulomb::{self, Coulomb};
use crate::hybrid::systems::reference::Reference;
use std::f64::consts::PI;
use tangency::core::attractor::CycleSearch;
use tangency::core::bvp::{BoundarySystem, Mesh, Shooting};
use tangency::core::continuation::{Branch, Continuation, End, Settings, SpecialPoint};
use tangency::core::hybrid::{HybridFlow, HybridSettings, HybridState};
use tangency::core::orbit::{HybridOrbit, IntoHybrid, Itinerary, from_cycle};
use tangency::core::system::Kind;
use tangency::scene::{Scene, execute};

/// Frequency, a friction at which motion does not stop, its amplitude there, and the friction from
/// which on it sticks.
const MOTIONS: [[f64; 4]; 3] = [
    [0.6, 0.2, 1.55060285469, 0.531512540169],
    [0.8, 0.3, 2.62610487572, 0.817406385711],
    [1.5, 0.2, 0.76594168620, 0.646579087296],
];

const NO_STOPS: &str = "backward:low forward:high";
const STOPS: &str = "backward:low stick:pull forward:high stick:push";

/// The friction from which on motion sticks: where `x''` vanishes at a reversal.
fn end(beta: f64) -> f64 {
    1.0 / ((1.0 - beta * beta).abs() * coulomb::hartog(beta).hypot(beta.powi(-2)))
}

/// Orbits without stops, and one of them.
fn without_stops(
    system: impl IntoHybrid,
    [beta, friction]: [f64; 2],
) -> (BoundarySystem, Vec<f64>) {
    let system = system.into_hybrid();
    let itinerary = Itinerary::read(NO_STOPS, &*system).unwrap();
    let meshes = vec![Mesh::uniform(2); 2];
    let orbits = BoundarySystem::new(
        HybridOrbit::of(system, itinerary).unwrap(),
        Shooting::default(),
        meshes,
    )
    .unwrap();
    let (x, half) = (coulomb::amplitude(beta, friction), PI / beta);
    let extras = [coulomb::phase(beta, friction) / beta, half, half];
    let z = orbits.flowed(&[x, 0.0, -x, 0.0], &extras, &[beta, friction]).unwrap();
    (orbits, z)
}

/// The branch of orbits without stops in the friction.
fn branch(orbits: &mut BoundarySystem, z: &[f64], [beta, friction]: [f64; 2]) -> Branch {
    let run = Continuation::new(orbits).from(z).at("frequency", beta).at("friction", friction);
    run.along("friction", 0.1..=1.2).trace().unwrap()
}

/// The value of a column at a special point.
fn value(branch: &Branch, point: &SpecialPoint, name: &str) -> f64 {
    point.value(branch.column(name).unwrap()).unwrap()
}

#[test]
fn motion_without_stops_ends_where_it_begins_to_stick() {
    for [beta, friction, amplitude, sticks] in MOTIONS {
        let p = [beta, friction];
        let (mut orbits, z) = without_stops(Coulomb, p);
        let run = Continuation::new(&mut orbits).from(&z).at("frequency", beta);
        let run = run.at("friction", friction).mark("friction", friction);
        let marked = run.along("friction", 0.1..=1.2).trace().unwrap();
        let start = marked.of_kind(Kind::UZ).next().unwrap();
        close(value(&marked, start, "max_displacement"), amplitude, 1e-10);
        close(coulomb::amplitude(beta, friction), amplitude, 1e-11);
        let grazing = marked.of_kind(Kind::G).next().unwrap();
        close(grazing.parameters[1], sticks, 1e-10);
        close(grazing.parameters[1], end(beta), 1e-10);
        assert!(grazing.converged && grazing.error < 1e-9, "{}", grazing.error);
        assert!(matches!(&marked.ends[1], End::Grazing { name, .. } if name == "decision"));
        assert_eq!(marked.of_kind(Kind::G).count(), 1);
        assert!(marked.points.iter().all(|point| point.admissible));
        close(value(&marked, grazing, "decision"), 0.0, 1e-12);
    }
}

/// Itinerary and largest displacement of the motion on which a simulation settles.
fn simulated([beta, friction]: [f64; 2]) -> (Vec<String>, f64) {
    let mut flow = HybridFlow::new(&Coulomb, HybridSettings::default()).unwrap();
    let start = HybridState { mode: Coulomb::FORWARD, time: 0.0, x: vec![0.0, 0.1] };
    let search = CycleSearch { transient: 2000.0, ..CycleSearch::default() };
    let cycle = search.find(&mut flow, start, &[beta, friction]).unwrap();
    let largest = cycle.legs.iter().flat_map(|leg| [leg.start[0], leg.end[0]]).fold(0.0, f64::max);
    let orbit = HybridOrbit::of_cycle(Coulomb, &cycle, &[beta, friction]).unwrap().problem;
    let words = orbit.itinerary().written(&Coulomb);
    (turned(&words), largest)
}

/// The legs of an itinerary, in the order that begins with `backward`.
fn turned(words: &str) -> Vec<String> {
    let mut legs: Vec<String> = words.split(' ').map(String::from).collect();
    let first = legs.iter().position(|leg| leg == "backward:low").unwrap_or_default();
    legs.rotate_left(first);
    legs
}

/// By symmetry both reversals begin to stick at a time: the branch goes on with both stops, as
/// simulations do.
#[test]
fn orbits_with_stops_begin_where_those_without_end() {
    for [beta, friction, _, sticks] in MOTIONS {
        let p = [beta, friction];
        let (mut orbits, z) = without_stops(Coulomb, p);
        let without = branch(&mut orbits, &z, p);
        let grazing = without.of_kind(Kind::G).next().unwrap().label;
        let beyond = [0.02, 0.05, 0.1].map(|more| sticks + more);
        let run = Continuation::new(&mut orbits).restart(&without, grazing).switch();
        let run = beyond.iter().fold(run, |run, friction| run.mark("friction", *friction));
        let stops = run.along("friction", 0.1..=0.95).trace().unwrap();
        assert_eq!(stops.itinerary, STOPS);
        let least = stops.points.iter().map(|point| point.parameters[1]).fold(f64::MAX, f64::min);
        close(least, sticks, 1e-10);
        assert!(stops.points.iter().all(|point| point.admissible && point.unstable == Some(0)));
        let marks: Vec<&SpecialPoint> = stops.of_kind(Kind::UZ).collect();
        assert_eq!(marks.len(), 3, "ω = {beta}");
        for mark in marks {
            let (legs, largest) = simulated([beta, mark.parameters[1]]);
            assert_eq!(legs, turned(STOPS));
            close(value(&stops, mark, "max_displacement"), largest, 1e-8);
        }
        let (legs, largest) = simulated(p);
        assert_eq!(legs, turned(NO_STOPS));
        close(largest, coulomb::amplitude(beta, friction), 1e-8);
    }
}

/// Back again: the legs at rest vanish, and without them the branch is the first one.
#[test]
fn orbits_without_stops_begin_where_those_with_stops_end() {
    let [beta, friction, _, sticks] = MOTIONS[2];
    let p = [beta, friction];
    let (mut orbits, z) = without_stops(Coulomb, p);
    let without = branch(&mut orbits, &z, p);
    let grazing = without.of_kind(Kind::G).next().unwrap().label;
    let run =
        Continuation::new(&mut orbits).restart(&without, grazing).switch().mark("friction", 0.7);
    let stops = run.along("friction", 0.1..=0.9).trace().unwrap();
    let mark = stops.of_kind(Kind::UZ).next().unwrap().label;
    let run = Continuation::new(&mut orbits).restart(&stops, mark);
    let down = run.along("friction", 0.1..=0.75).trace().unwrap();
    let grazing = down.of_kind(Kind::G).next().unwrap();
    close(grazing.parameters[1], sticks, 1e-10);
    let run = Continuation::new(&mut orbits).restart(&down, grazing.label).switch();
    let back = run.mark("friction", friction).along("friction", 0.1..=1.2).trace().unwrap();
    assert_eq!(turned(&back.itinerary), turned(NO_STOPS));
    let mark = back.of_kind(Kind::UZ).next().unwrap();
    close(value(&back, mark, "max_displacement"), coulomb::amplitude(beta, friction), 1e-10);
}

#[test]
fn the_curve_of_decisions_is_followed() {
    let [beta, friction, ..] = MOTIONS[0];
    let (mut orbits, z) = without_stops(Coulomb, [beta, friction]);
    let without = branch(&mut orbits, &z, [beta, friction]);
    let grazing = without.of_kind(Kind::G).next().unwrap().label;
    let settings = Settings { max_step: 0.05, ..Settings::default() };
    let run = Continuation::new(&mut orbits).restart(&without, grazing).hold(Kind::G);
    let run = run.settings(settings);
    let curve = run.along("friction", 0.3..=2.0).along("frequency", 0.52..=0.9).trace().unwrap();
    assert!(curve.points.len() > 10 && curve.condition == Some(Kind::G));
    for point in &curve.points {
        close(point.parameters[1], end(point.parameters[0]), 1e-9);
    }
    let frequencies = || curve.points.iter().map(|point| point.parameters[0]);
    close(frequencies().fold(f64::MIN, f64::max), 0.9, 1e-9);
    assert!(frequencies().fold(f64::MAX, f64::min) < 0.55);
}

/// Beyond the decision the orbits are virtual: on demand they are followed, and marked.
#[test]
fn orbits_beyond_a_decision_are_virtual() {
    let [beta, friction, _, sticks] = MOTIONS[0];
    let (mut orbits, z) = without_stops(Coulomb, [beta, friction]);
    let run =
        Continuation::new(&mut orbits).from(&z).at("frequency", beta).at("friction", friction);
    let branch = run.along("friction", 0.1..=0.7).beyond_grazings().trace().unwrap();
    close(branch.of_kind(Kind::G).next().unwrap().parameters[1], sticks, 1e-10);
    for point in &branch.points {
        assert_eq!(point.admissible, point.parameters[1] < sticks + 1e-9, "{:?}", point.parameters);
    }
    assert!(branch.points.iter().any(|point| !point.admissible));
}

/// Of a system without decision functions the change is bracketed between points of the branch,
/// which does not go on beyond.
#[test]
fn what_is_decided_without_a_function_ends_a_branch() {
    for [beta, friction, _, sticks] in MOTIONS {
        let p = [beta, friction];
        let (mut orbits, z) = without_stops(Reference::Coulomb, p);
        let branch = branch(&mut orbits, &z, p);
        assert!(branch.column("decision").is_none());
        let last = branch.of_kind(Kind::G).next().unwrap();
        assert!(!last.converged && last.error < 1e-6, "{}", last.error);
        close(last.parameters[1], sticks, last.error.max(1e-10));
        let text = branch.ends[1].to_string();
        assert!(text.contains("an event leads to another mode"), "{text}");
        let before = |parameter: f64| parameter <= sticks + 1e-9;
        assert!(branch.points.iter().all(|point| before(point.parameters[1])));
    }
}

/// Orbits with the itinerary of a simulated motion.
fn settled(p: [f64; 2]) -> (BoundarySystem, Vec<f64>) {
    let mut flow = HybridFlow::new(&Coulomb, HybridSettings::default()).unwrap();
    let start = HybridState { mode: Coulomb::FORWARD, time: 0.0, x: vec![0.0, 0.1] };
    let search = CycleSearch { transient: 2000.0, ..CycleSearch::default() };
    let cycle = search.find(&mut flow, start, &p).unwrap();
    from_cycle(Coulomb, &cycle, &p, Shooting::default(), 2).unwrap()
}

/// At low frequencies motion stops twice on each way: further stops begin where it touches its stop
/// on the way, and where rest touches the end of what holds it. On both ways at a time, and in
/// directions in which the equations are singular.
#[test]
fn further_stops_begin_on_both_ways() {
    let beta = 0.22;
    for (friction, range, [born, other]) in [
        (0.25, [0.2, 0.5], [0.272873565284, 0.355000129488]),
        (0.5, [0.3, 0.6], [0.355000129488, 0.272873565284]),
    ] {
        let (mut orbits, z) = settled([beta, friction]);
        let run = Continuation::new(&mut orbits).from(&z).at("frequency", beta);
        let run = run.at("friction", friction).along("friction", range[0]..=range[1]);
        let two = run.trace().unwrap();
        assert_eq!(two.itinerary.matches("stick").count(), 2);
        let grazing = two.of_kind(Kind::G).next().unwrap();
        close(grazing.parameters[1], born, 1e-10);
        assert!(
            two.ends
                .iter()
                .any(|end| matches!(end, End::Grazing { name, .. } if name == "distance"))
        );
        let run = Continuation::new(&mut orbits).restart(&two, grazing.label).switch();
        let four = run.mark("friction", 0.32).along("friction", 0.2..=0.5).trace().unwrap();
        assert_eq!(four.itinerary.matches("stick").count(), 4, "{}", four.itinerary);
        assert!(four.points.iter().all(|point| point.admissible), "from {born}");
        let values = || four.points.iter().map(|point| point.parameters[1]);
        let range = [born.min(other), born.max(other)];
        close(values().fold(f64::MAX, f64::min), range[0], 1e-8);
        close(values().fold(f64::MIN, f64::max), range[1], 1e-8);
        let mark = four.of_kind(Kind::UZ).next().unwrap();
        let (legs, largest) = simulated([beta, 0.32]);
        assert_eq!(legs.len(), 8);
        close(value(&four, mark, "max_displacement"), largest, 1e-8);
    }
}

/// The linear oscillator `x'' + 0.1 x' + x = A cos 0.8 t` in one mode, as text, with what happens
/// at its stops.
fn oscillator(modes: &str, guards: &str) -> [Branch; 2] {
    let text = format!(
        r#"Scene(
            title: "Stops",
            problem: HybridEquations(
                modes: [(name: "free", states: [("x", "v"), ("v", "A*cos(0.8*t) - 0.1*v - x")]), {modes}],
                guards: [{guards}],
                period: "2*pi/0.8",
            ),
            parameters: [("A", 0.2)], settings: (max_step: 0.05), plot: (x: "A", y: "max_x"),
            runs: [
                (name: "free", start: Simulated(transient: 100), along: [(name: "A", low: 0, high: 3)]),
                (name: "born", start: From(run: "free", kind: G, switch: true), along: [(name: "A", low: 0, high: 0.6)]),
            ],
        )"#
    );
    let outcome = execute(&Scene::parse(&text).unwrap(), None, &mut ());
    assert!(outcome.error.is_none(), "{:?}", outcome.error);
    let [free, born] = <[Branch; 2]>::try_from(outcome.document.branches).expect("two branches");
    // The amplitude is 1.
    let touches = 0.36_f64.hypot(0.08);
    close(free.of_kind(Kind::G).next().unwrap().parameters[0], touches, 1e-10);
    let amplitudes = born.points.iter().map(|point| point.parameters[0]);
    close(amplitudes.fold(f64::MAX, f64::min), touches, 1e-9);
    assert!(born.points.len() > 5 && born.points.iter().all(|point| point.admissible));
    [free, born]
}

/// Between two stops both are touched together, and hit together beyond.
#[test]
fn both_stops_are_hit_where_both_are_touched() {
    let guards = r#"(name: "right", modes: ["free"], function: "1 - x", reset: [("v", "-0.8*v")]),
        (name: "left", modes: ["free"], function: "1 + x", reset: [("v", "-0.8*v")])"#;
    let [_, both] = oscillator("", guards);
    let mut legs: Vec<&str> = both.itinerary.split(' ').collect();
    legs.sort_unstable();
    assert_eq!(legs, ["free:left", "free:right"]);
}

/// A stop that gives way is pressed for a time that is zero at grazing; no force jumps.
#[test]
fn soft_stops_are_pressed_where_they_are_touched() {
    let modes = r#"(name: "pressed", states: [("x", "v"), ("v", "A*cos(0.8*t) - 0.1*v - x - 10*(x - 1)")])"#;
    let guards = r#"(name: "touch", modes: ["free"], function: "1 - x", next: "pressed"),
        (name: "leave", modes: ["pressed"], function: "x - 1", next: "free")"#;
    let [_, pressed] = oscillator(modes, guards);
    assert_eq!(pressed.itinerary, "pressed:leave free:touch");
    // By shooting on the exact flows of both modes.
    let doubling = pressed.of_kind(Kind::PD).next().unwrap();
    close(doubling.parameters[0], 0.3719829351853, 1e-9);
}
