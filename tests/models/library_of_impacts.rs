//! The scenes of the library with impacts, switches and steps. Digits without a formula are those
//! of programs that share no code with this one: COCO's demonstrations, closed flows by numpy and
//! scipy, and the literature (`docs/reference/language.md`).

use super::library::{executed, finds, scene, values};
use crate::common::close;
use std::f64::consts::{PI, TAU};
use tangency::core::continuation::{Branch, End, SpecialPoint};
use tangency::core::failure::one_line;
use tangency::core::system::Kind;
use tangency::output::Document;
use tangency::scene::{Scene, Simulated, Start, execute, explore};

/// What a scene of the library finds. Every row of its tables has converged, and so have all
/// branches.
fn sound(scene: &Scene) -> Document {
    let document = executed(scene);
    for branch in &document.branches {
        for special in &branch.special {
            let numbers = (&special.parameters, special.error);
            assert!(special.converged, "{}: {} {numbers:?}", branch.name, special.kind);
        }
        let failed = |end: &&End| matches!(end, End::StepTooSmall { .. } | End::PointLimit { .. });
        assert_eq!(branch.ends.iter().find(failed), None, "{}", branch.name);
    }
    document
}

fn library(name: &str) -> Document {
    sound(&scene(name))
}

/// A first diagram of a problem that motion has settled on: the names of its branches, with what
/// they find.
fn first_diagram(problem: &str, run: &str) -> Vec<String> {
    let text = format!(
        "Scene(title: \"First diagram\", problem: {problem}, runs: [
            (name: \"first\", start: Simulated(transient: 200), along: [{run}]),
        ])"
    );
    let (_, outcome) = explore(&Scene::parse(&text).unwrap(), 2, &mut ());
    assert!(outcome.error.is_none(), "{:?}", outcome.error);
    let told = |branch: &Branch| {
        let kinds = branch.special.iter().map(|special| {
            assert!(special.converged, "{}: {}", branch.name, special.event);
            format!(" {}", special.kind)
        });
        format!("{}:{}", branch.name, kinds.collect::<String>())
    };
    outcome.document.branches.iter().map(told).collect()
}

/// Two oscillators, each with a stop of its own, graze at one amplitude: orbits that impact at one
/// stop only, or at both, begin there, and fold at A = 0.0999707536283 (`docs/concepts/grazing.md`).
#[test]
fn each_itinerary_that_is_born_at_a_touch_of_two_guards_is_switched_to() {
    let scene = |last: usize| {
        let run = |which: usize| {
            format!(
                "(name: \"{which}\", start: From(run: \"free\", kind: G, switch: true, which: {which}),
                    along: [(name: \"A\", low: 0.01, high: 0.2)]),"
            )
        };
        let text = format!(
            "Scene(
                title: \"Two stops\",
                problem: HybridEquations(
                    modes: [(name: \"flight\", states: [
                        (\"x\", \"v\"), (\"v\", \"A*cos(t) - 0.1*v - x\"), (\"y\", \"w\"), (\"w\", \"A*cos(t - 1) - 0.1*w - y\"),
                    ])],
                    guards: [
                        (name: \"first\", modes: [\"flight\"], function: \"1 - x\", reset: [(\"v\", \"-0.8*v\")]),
                        (name: \"second\", modes: [\"flight\"], function: \"1 - y\", reset: [(\"w\", \"-0.8*w\")]),
                    ],
                    parameters: [(\"A\", 0.05)], period: \"2*pi\",
                ),
                runs: [
                    (name: \"free\", start: Simulated(transient: 100), along: [(name: \"A\", low: 0.01, high: 0.2)]),
                    {} {}
                ],
            )",
            run(1), run(last)
        );
        execute(&Scene::parse(&text).unwrap(), None, &mut ())
    };
    let document = scene(2).document;
    let [free, first, second] = &document.branches[..] else { panic!("three branches") };
    let touch = free.of_kind(Kind::G).next().unwrap();
    close(touch.parameters[0], 0.1, 1e-11);
    assert_eq!(touch.subkind.as_deref(), Some("double grazing"));
    for (branch, itinerary) in [(first, "flight:first"), (second, "flight:second")] {
        assert_eq!(branch.itinerary, itinerary);
        close(branch.of_kind(Kind::LP).next().unwrap().parameters[0], 0.0999707536283, 1e-11);
    }
    let both = &scene(0).document.branches[2];
    assert!(
        ["flight:first flight:second", "flight:second flight:first"].contains(&&*both.itinerary)
    );
    let error = one_line(&scene(3).error.expect("no such branch"));
    assert!(
        error.contains(
            "the other branch with index 3 does not exist: 3 other branches begin or cross"
        ),
        "{error}"
    );
}

/// A gear with backlash begins on either side of its play, or in it, and settles where its teeth
/// stay in touch under the load: about x = 1.1, up to where they part, at
/// `0.1 |1 − ω² + 0.1 iω| = 0.05`.
#[test]
fn motion_begins_where_the_guards_allow_it() {
    let gear = |start: f64| {
        format!(
            "HybridEquations(
                definitions: [(\"force\", \"0.1 + 0.05*cos(omega*t) - 0.1*v\")],
                modes: [
                    (name: \"free\", states: [(\"x\", \"v\"), (\"v\", \"force\")]),
                    (name: \"ahead\", states: [(\"x\", \"v\"), (\"v\", \"force - (x - 1)\")]),
                    (name: \"behind\", states: [(\"x\", \"v\"), (\"v\", \"force - (x + 1)\")]),
                ],
                guards: [
                    (name: \"front\", modes: [\"free\"], function: \"1 - x\", next: \"ahead\"),
                    (name: \"part\", modes: [\"ahead\"], function: \"x - 1\", next: \"free\"),
                    (name: \"rear\", modes: [\"free\"], function: \"1 + x\", next: \"behind\"),
                    (name: \"back\", modes: [\"behind\"], function: \"-1 - x\", next: \"free\"),
                ],
                parameters: [(\"omega\", 2)], period: \"2*pi/omega\", initial: [(\"x\", {start:?})],
            )"
        )
    };
    for start in [-3.0, 0.0, 1.1] {
        let found = first_diagram(&gear(start), "(name: \"omega\", low: 1.1, high: 2.5)");
        assert_eq!(found[0], "first: G EP", "from {start}: {found:?}");
    }
    // (1 − w)² + 0.01 w = 0.25 for w = ω².
    let parts = ((1.99 + (1.99_f64.powi(2) - 3.0).sqrt()) / 2.0).sqrt();
    let text = format!(
        "Scene(title: \"Gear\", problem: {}, runs: [
            (name: \"first\", start: Simulated(transient: 200), along: [(name: \"omega\", low: 1.1, high: 2.5)]),
        ])",
        gear(1.1)
    );
    let document = sound(&Scene::parse(&text).unwrap());
    let touch = document.branches[0].of_kind(Kind::G).next().unwrap();
    close(touch.value(document.branches[0].column("omega").unwrap()).unwrap(), parts, 1e-10);
}

/// A pendulum beside a wall. Near the grazing that ends its doubled motion a multiplier grows
/// without bound: its product with another one passes 1, at a neutral saddle, in the step of a
/// period doubling.
#[test]
fn what_begins_at_grazings_is_followed_and_a_neutral_saddle_is_no_torus_point() {
    let pendulum = "HybridEquations(
        modes: [(name: \"swing\", states: [(\"th\", \"w\"), (\"w\", \"A*cos(0.9*t) - sin(th) - 0.1*w\")])],
        guards: [(name: \"wall\", modes: [\"swing\"], function: \"th + 0.1\", reset: [(\"w\", \"-0.5*w\")])],
        parameters: [(\"A\", 0.3)], period: \"2*pi/0.9\", initial: [(\"th\", 0.5)],
    )";
    let found = first_diagram(pendulum, "(name: \"A\", low: 0.1, high: 1.2)");
    let expected =
        ["first: EP G", "first-G: G PD LP EP", "first-G-PD: EP PD G", "first-G-G: EP EP"];
    assert_eq!(found, expected);
}

/// The period of a relay's forced motion doubles and comes back: both doublings are ends of one
/// branch, which is followed once.
#[test]
fn a_branch_between_two_period_doublings_is_followed_once() {
    let relay = "FilippovEquations(
        surface: \"x\", period: \"2*pi/0.6\", parameters: [(\"A\", 0.2)], initial: [(\"x\", 2)],
        above: [(\"x\", \"y - 0.1*x - 1\"), (\"y\", \"0.5 - x + A*sin(0.6*t)\")],
        below: [(\"x\", \"y - 0.1*x + 1\"), (\"y\", \"A*sin(0.6*t) - x - 0.5\")],
    )";
    let found = first_diagram(relay, "(name: \"A\", low: 0.1, high: 0.36)");
    let expected = ["first: EP G", "first-G: EP PD PD EP", "first-G-PD1: EP PD"];
    assert_eq!(found, expected);
}

fn only_first(name: &str, runs: usize) -> Scene {
    let mut scene = scene(name);
    scene.runs.truncate(runs);
    scene
}

/// The values of a column at the only point of a kind.
#[track_caller]
fn only(document: &Document, branch: &str, kind: Kind, column: &str) -> f64 {
    let [value] = values(document, branch, kind, column)[..] else {
        panic!("{branch}: not one {kind}")
    };
    value
}

fn is_closed(branch: &Branch) -> bool {
    branch.ends.iter().all(|end| matches!(end, End::Closed { .. }))
}

/// The six special points of COCO's demonstration, and an impact speed of 0.1.
#[test]
fn stick_slip() {
    let document = library("stick-slip");
    let (free, grazings) = ("without impacts", "grazings");
    close(only(&document, free, Kind::LP, "V"), 0.5875367161733, 1e-11);
    close(only(&document, free, Kind::G, "V"), 0.5875162504155, 1e-11);
    close(only(&document, "one impact", Kind::UZ, "V"), 0.6358041862150, 1e-11);
    finds(&document, (grazings, Kind::GL, "omega"), &[0.9082629046888], 1e-11);
    finds(&document, (grazings, Kind::GL, "V"), &[0.5886342711666], 1e-11);
    let doublings = [[0.6939956036083, 0.6139308193098], [0.6000193930193, 0.5817718172902]];
    finds(&document, (grazings, Kind::GP, "omega"), &doublings[0], 1e-11);
    finds(&document, (grazings, Kind::GP, "V"), &doublings[1], 1e-11);
    // COCO's demonstration does not look for this one: the curve of the orbits with an impact has
    // it as well.
    finds(&document, (grazings, Kind::GD, "omega"), &[0.613649461804], 1e-10);
    let mut births = scene("stick-slip");
    births.runs[2].start = from("without impacts", Kind::G);
    if let Start::From { switch, .. } = &mut births.runs[2].start {
        *switch = true;
    }
    let births = executed(&births);
    for kind in [Kind::GL, Kind::GP, Kind::GD] {
        let points = values(&document, grazings, kind, "omega");
        finds(&births, (grazings, kind, "omega"), &points, 1e-10);
    }
}

/// Fold and grazing are 2e-5 apart, in one step or not: at the grazing one multiplier is outside of
/// the unit circle.
#[test]
fn stick_slip_is_unstable_at_its_grazing_at_every_step() {
    let mut scene = only_first("stick-slip", 1);
    let first = scene.runs[0].clone();
    scene.runs[0].marks = vec![("V".into(), 0.58)];
    for max_step in ["0.02", "0.05", "0.1", "0.001"] {
        let mut run = first.clone();
        run.name = format!("steps up to {max_step}");
        run.set = vec![("max_step".into(), max_step.into())];
        (run.start, run.along[0].low) = (from(&first.name, Kind::UZ), Some(0.579));
        scene.runs.push(run);
    }
    scene.settings.max_points = 5000;
    let document = sound(&scene);
    for branch in &document.branches {
        // The first branch has the row of the grazing; the others end there.
        let ends = |special: &&SpecialPoint| {
            [Kind::G, Kind::EP].contains(&special.kind) && special.parameters[3] > 0.587
        };
        let grazing = branch.special.iter().find(ends).expect(&branch.name);
        assert_eq!(grazing.unstable, Some(1), "{}", branch.name);
        close(grazing.parameters[3], 0.5875162504155, 1e-11);
    }
}

fn from(run: &str, kind: Kind) -> Start {
    Start::From { run: run.into(), kind, nth: 0, switch: false, which: 0, unconverged: false }
}

/// `I = 1/(1 − e^{−T}) ∓ A/√(1 + ω²)`, and the grazing at `1 − A/√(1 + ω²)`. The firing family
/// returns to its start one period later.
#[test]
fn integrate_and_fire() {
    let (middle, share) = (1.0 / (1.0 - (-TAU / 4.0).exp()), 1.0 / 17.0_f64.sqrt());
    let document = library("integrate-and-fire");
    let folds = [middle - 0.1 * share, middle + 0.1 * share];
    close(folds[0], 1.2381807469074, 1e-13);
    close(folds[1], 1.2866878719147, 1e-13);
    finds(&document, ("firing", Kind::LP, "I"), &folds, 1e-11);
    close(only(&document, "silent", Kind::G, "I"), 1.0 - 0.1 * share, 1e-11);
    let firing = document.branch("firing").unwrap();
    assert!(is_closed(firing), "{:?}", firing.ends);
    assert_eq!(firing.of_kind(Kind::LP).count(), 2);
    for (name, sign) in [("upper folds", 1.0), ("lower folds", -1.0)] {
        let branch = document.branch(name).unwrap();
        for point in &branch.points {
            let [_, current, amplitude] = point.parameters[..] else { panic!("three parameters") };
            close(current, middle + sign * amplitude * share, 1e-10);
        }
    }
    // There the voltage touches 1 half-way: orbits beyond would have fired before.
    close(only(&document, "upper folds", Kind::G, "A"), touching(4.0), 1e-9);
    let mut strong = only_first("integrate-and-fire", 1);
    strong.parameters[1].1 = 0.5;
    strong.runs[0].set[0].1 = "0.8".into();
    strong.runs[0].along[0].low = Some(0.5);
    close(only(&sound(&strong), "silent", Kind::G, "I"), 0.8787321874818, 1e-12);
}

/// The amplitude at which the voltage of the upper fold touches 1 before its spike, by bisection on
/// the closed form.
fn touching(omega: f64) -> f64 {
    let period = TAU / omega;
    let share = 1.0 / omega.hypot(1.0);
    let start = -1.0 / (1.0 - (-period).exp());
    // At the upper fold the wave is at its trough at the spike.
    let voltage = |amplitude: f64, t: f64| {
        let current = -start + amplitude * share;
        current - amplitude * share * (omega * t).cos() + start * (-t).exp()
    };
    let largest = |amplitude: f64| {
        let rate = |t: f64| amplitude * share * omega * (omega * t).sin() - start * (-t).exp();
        let (mut low, mut high) = (0.25 * period, 0.75 * period);
        for _ in 0..100 {
            let middle = 0.5 * (low + high);
            if rate(middle) > 0.0 { low = middle } else { high = middle }
        }
        voltage(amplitude, low)
    };
    let (mut low, mut high) = (0.1, 1.0);
    for _ in 0..100 {
        let middle = 0.5 * (low + high);
        if largest(middle) < 1.0 { low = middle } else { high = middle }
    }
    low
}

/// Symmetric rocking folds where its closed form says, and both halves of the pitchfork are traced,
/// at several steps.
#[test]
fn rocking_block() {
    for max_step in [0.02, 0.05, 0.2] {
        let mut scene = scene("rocking-block");
        scene.settings.max_step = max_step;
        let document = sound(&scene);
        close(only(&document, "symmetric", Kind::LP, "b"), 0.12455646469514, 1e-12);
        // By shooting on the closed flows of half a period.
        close(only(&document, "symmetric", Kind::BP, "b"), 9.523233868, 1e-9);
        let doublings = values(&document, "asymmetric", Kind::PD, "b");
        let [first, second] = doublings[..] else { panic!("{doublings:?}") };
        close(first, 13.5312691719747, 1e-10);
        close(second, first, 1e-10);
        let branch = document.branch("asymmetric").unwrap();
        let (most, least) = (branch.column("max_x").unwrap(), branch.column("min_x").unwrap());
        let [one, other] = [0, 1].map(|k| branch.of_kind(Kind::PD).nth(k).unwrap());
        close(one.value(most).unwrap(), -other.value(least).unwrap(), 1e-9);
        // Where rocking on one corner begins to touch no other: `x = 1 − cos ωt`, at `b = 1 + ω²`.
        let grazings = values(&document, "asymmetric", Kind::G, "b");
        let [first, second] = grazings[..] else { panic!("{grazings:?}") };
        close(first, 17.0, 1e-11);
        close(second, 17.0, 1e-11);
        close(only(&document, "doubled", Kind::G, "b"), 14.5832676158, 1e-9);
        assert_eq!(values(&document, "doubled", Kind::PD, "b").len(), 1);
    }
}

/// COCO's demonstration. The asymmetric orbits between two of the branch points are a closed curve,
/// traced once.
#[test]
fn bang_bang() {
    for max_step in [0.1, 0.2] {
        let mut scene = scene("bang-bang");
        scene.settings.max_step = max_step;
        let document = sound(&scene);
        let points = [1.0759679066012, 0.8543992737120, 0.7203219077];
        finds(&document, ("symmetric", Kind::BP, "omega"), &points[..2], 1e-11);
        finds(&document, ("symmetric", Kind::BP, "omega"), &points[2..], 1e-9);
        let folds = [0.8194877656449, 1.1109707522970];
        finds(&document, ("symmetric", Kind::LP, "omega"), &folds, 1e-11);
        let doublings = [0.8693079238527, 0.9913124867355];
        finds(&document, ("asymmetric", Kind::PD, "omega"), &doublings, 1e-11);
        finds(&document, ("asymmetric", Kind::LP, "omega"), &[1.0158631981739], 1e-11);
        // Each point and its mirror image, and no other.
        let closed = document.branch("asymmetric").unwrap();
        assert!(is_closed(closed), "{:?}", closed.ends);
        let counts = [Kind::PD, Kind::LP, Kind::BP].map(|kind| closed.of_kind(kind).count());
        assert_eq!(counts, [4, 4, 1]);
        let slow = document.branch("slow").unwrap();
        assert_eq!(slow.of_kind(Kind::PD).count(), 2);
        assert!(slow.of_kind(Kind::EP).all(|end| (end.parameters[0] - 0.7).abs() < 1e-9));
    }
}

/// The angle and the rate are those that Garcia et al. print; their doublings are at 0.0151
/// and 0.0177.
#[test]
fn simplest_walker() {
    let document = library("simplest-walker");
    let walk = document.branch("walk").unwrap();
    let mark = walk.of_kind(Kind::UZ).next().unwrap();
    let value = |name: &str| mark.value(walk.column(name).unwrap()).unwrap();
    close(value("max_theta"), 0.200310900544287, 1e-12);
    // Before and after the heel strikes, `θ⁺' = θ⁻' cos 2θ`.
    let after = mark.state.iter().find(|x| (*x + 0.199832473004977).abs() < 1e-11);
    assert!(after.is_some(), "{:?}", mark.state);
    close(only(&document, "walk", Kind::PD, "gamma"), 0.0150884379411, 1e-12);
    close(only(&document, "limp", Kind::PD, "gamma"), 0.0176693748625, 1e-12);
    close(only(&document, "four steps", Kind::PD, "gamma"), 0.0181601195636, 1e-12);
}

/// The first doubling by exponentials of matrices; the second one is at 31.12 in the literature.
#[test]
fn buck_converter() {
    let document = library("buck-converter");
    close(only(&document, "period 1", Kind::PD, "E"), 24.51657282856342, 1e-10);
    close(only(&document, "period 2", Kind::PD, "E"), 31.1179020067710, 1e-10);
    close(only(&document, "period 2", Kind::G, "E"), 36.35323706408, 1e-10);
    let curve = document.branch("doublings").unwrap();
    let column = curve.column("E").unwrap();
    let mut ends: Vec<f64> =
        curve.of_kind(Kind::EP).map(|end| end.value(column).unwrap()).collect();
    ends.sort_by(f64::total_cmp);
    close(ends[0], BUCK_AT_50, 1e-9);
    close(ends[1], BUCK_AT_10, 1e-9);
}

/// Where the period doubles with the loads 50 Ω and 10 Ω, by exponentials of matrices.
const BUCK_AT_50: f64 = 24.113952896238633;
const BUCK_AT_10: f64 = 26.204045101165796;

/// Both walls are touched at once; the fold is that of the closed form.
#[test]
fn two_walls() {
    let document = library("two-walls");
    let born = 0.756637297521078;
    close(only(&document, "free", Kind::G, "A"), born, 1e-12);
    let touch = document.branches[0].of_kind(Kind::G).next().unwrap();
    assert_eq!(touch.subkind.as_deref(), Some("double grazing"));
    let ends = values(&document, "both walls", Kind::EP, "A");
    assert!(ends.iter().any(|end| (end - born).abs() < 1e-11), "{ends:?}");
    close(only(&document, "both walls", Kind::LP, "A"), 0.13754716112957, 1e-12);
    close(only(&document, "both walls", Kind::BP, "A"), 0.8101339829819, 1e-11);
    let halves = values(&document, "asymmetric", Kind::G, "A");
    assert_eq!(halves.len(), 2);
    close(halves[0], halves[1], 1e-10);
}

/// The amplitude is 1 at grazing, at every frequency. The branch that begins there ends there, if
/// it comes from elsewhere.
#[test]
fn soft_stop() {
    let mut scene = only_first("soft-stop", 1);
    scene.parameters[0].1 = 0.8;
    let document = sound(&scene);
    assert_eq!(document.branches[0].itinerary, "free:touch pressed:leave");
    close(only(&document, "free", Kind::G, "A"), 0.36_f64.hypot(0.08), 1e-12);
    assert_eq!(values(&document, "free", Kind::PD, "A").len(), 2);
    let document = library("soft-stop");
    close(only(&document, "free", Kind::G, "A"), 0.3687817782917, 1e-12);
    finds(&document, ("pressed", Kind::PD, "A"), &[0.3719829351853], 1e-10);
    let ends = values(&document, "pressed", Kind::EP, "A");
    assert!(ends.iter().any(|end| (end - 0.3687817782917).abs() < 1e-12), "{ends:?}");
    for point in &document.branch("grazings").unwrap().points {
        let [omega, _, amplitude] = point.parameters[..] else { panic!("three parameters") };
        close(amplitude, (1.0 - omega * omega).hypot(0.1 * omega), 1e-10);
    }
}

/// With `n` periods between impacts: a fold at `nπ(1 − e)/(1 + e)`, and a doubling beyond it.
#[test]
fn bouncing_ball_over_several_periods() {
    for (n, e) in [(1.0, 0.5), (2.0, 0.5), (3.0, 0.5), (1.0, 0.8), (2.0, 0.8)] {
        let fold: f64 = n * PI * (1.0 - e) / (1.0 + e);
        let doubling = fold.hypot(2.0 * (1.0 + e * e) / (1.0 + e).powi(2));
        let amplitude = 0.5 * (fold + doubling);
        // In flight at time 0, `flown` after an impact at the phase whose cosine is fold/amplitude.
        let phase = (fold / amplitude).acos();
        let flown = TAU * n - phase;
        let height = amplitude * phase.sin() + n * PI * flown - 0.5 * flown * flown;
        let velocity = n * PI - flown - amplitude;
        let mut scene = only_first("bouncing-ball", 1);
        scene.parameters = vec![("amplitude".into(), amplitude), ("restitution".into(), e)];
        let run = &mut scene.runs[0];
        let state = vec![("height".into(), height), ("velocity".into(), velocity)];
        run.start = Start::Simulated(Simulated { state, ..Simulated::default() });
        run.along[0].high = Some(doubling + 0.1);
        let document = sound(&scene);
        let itinerary = &document.branches[0].itinerary;
        let expected = if n > 1.0 { format!("{n}* flight:impact") } else { "flight:impact".into() };
        assert_eq!(*itinerary, expected);
        finds(&document, ("one impact", Kind::LP, "amplitude"), &[fold], 1e-10);
        finds(&document, ("one impact", Kind::PD, "amplitude"), &[doubling], 1e-10);
    }
}
