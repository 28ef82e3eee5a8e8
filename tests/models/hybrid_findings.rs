//! Promise: findings about hybrid models that strangers wrote stay mended.

use super::hybrid_ends::BOOST;
use crate::common::close;
use std::time::Duration;
use tangency::core::continuation::{Branch, Observer};
use tangency::core::failure::one_line;
use tangency::core::system::Kind;
use tangency::scene::{Outcome, Scene, SceneObserver, execute, explore};

/// What becomes of a problem and its runs.
fn executed(problem: &str, runs: &str, observer: &mut dyn SceneObserver) -> Outcome {
    let text = format!("Scene(title: \"t\", problem: {problem}, runs: [{runs}])");
    execute(&Scene::parse(&text).unwrap_or_else(|error| panic!("{error}")), None, observer)
}

/// A problem with one branch, which has to be traced.
fn branch_of(problem: &str, run: &str) -> Branch {
    let outcome = executed(problem, run, &mut ());
    assert!(outcome.error.is_none(), "{:?}", outcome.error);
    outcome.document.branches.into_iter().next().expect("a branch")
}

/// Checks a monitor at all points of a branch.
fn all_close(branch: &Branch, monitor: &str, exact: impl Fn(f64) -> f64, tolerance: f64) {
    let column = branch.column(monitor).unwrap();
    for point in &branch.points {
        close(point.value(column).unwrap(), exact(point.parameters[0]), tolerance);
    }
}

/// The longest motion that is announced, in units of time.
#[derive(Default)]
struct Announced(Vec<f64>);

impl Observer for Announced {}

impl SceneObserver for Announced {
    fn work(&mut self, _run: &str, what: &str, _longest: Duration) {
        self.0.extend(
            what.strip_prefix("motion over a time of ").and_then(|it| it.parse::<f64>().ok()),
        );
    }
}

/// A cycle is searched for a time in units of the stated scale: ten thousand periods of the clock
/// are one second here.
#[test]
fn cycles_are_searched_in_units_of_the_scale_of_time() {
    let along = "along: [(name: \"Iref\", low: 0.69, high: 0.71)]";
    let run = format!("(name: \"once\", start: Simulated(transient: 1), {along})");
    let mut announced = Announced::default();
    let outcome = executed(BOOST, &run, &mut announced);
    assert!(outcome.error.is_none(), "{:?}", outcome.error);
    assert!(announced.0.iter().all(|time| *time <= 2.0), "{:?}", announced.0);
}

/// A ball on a table that moves; its rebound is a parameter.
const BALL: &str = r#"HybridEquations(
    modes: [
        (name: "flight", states: [("height", "velocity"), ("velocity", "-1 + amplitude*sin(t)")]),
        (name: "rest", states: [("height", 0)]),
    ],
    guards: [
        (name: "impact", modes: ["flight"], function: "height", IMPACT),
        (name: "leave", modes: ["rest"], function: "1 - amplitude*sin(t)", next: "flight",
         reset: [("velocity", 0)]),
    ],
    parameters: [("amplitude", 1.3), ("restitution", 0)],
    period: "2*pi", initial: [("velocity", 1)])"#;

/// Impacts without a rebound accumulate at the first one: the message names the restitution and the
/// mode to which the impact should lead, and with that mode the orbit is found.
#[test]
fn impacts_without_rebound_are_refused_by_name() {
    let run = |impact: &str| {
        let along = "along: [(name: \"amplitude\", low: 1.25, high: 1.35)]";
        let problem = BALL.replace("IMPACT", impact);
        executed(&problem, &format!("(name: \"ball\", start: Simulated(), {along})"), &mut ())
    };
    let rebounds = r#"next: "flight", reset: [("velocity", "-restitution*velocity")],
        accumulates_to: "rest""#;
    let error = one_line(&run(rebounds).error.expect("no rebound"));
    for part in
        ["flight:impact accumulate at the first event", "restitution of 0", "`next: \"rest\"`"]
    {
        assert!(error.contains(part), "{error}");
    }
    let outcome = run(r#"next: "rest""#);
    assert!(outcome.error.is_none(), "{:?}", outcome.error);
    let branch = &outcome.document.branches[0];
    assert!(branch.itinerary == "flight:impact rest:leave", "{}", branch.itinerary);
}

/// A branch on which the restitution falls to 0 ends where impacts accumulate at the first one, and says
/// what to change.
#[test]
fn a_restitution_that_falls_to_zero_ends_a_branch_by_name() {
    let rebounds = r#"next: "flight", reset: [("velocity", "-restitution*velocity")],
        accumulates_to: "rest""#;
    let problem =
        BALL.replace("IMPACT", rebounds).replace("\"restitution\", 0)", "\"restitution\", 0.3)");
    let along = "along: [(name: \"restitution\", low: 0, high: 0.5)]";
    for method in ["shooting", "collocation"] {
        let set = format!("set: [(\"method\", \"{method}\")]");
        let run = format!("(name: \"ball\", start: Simulated(transient: 50), {along}, {set})");
        let branch = branch_of(&problem, &run);
        let [first, last] = [0, branch.points.len() - 1].map(|k| branch.points[k].parameters[1]);
        assert!(first < 0.02 && last == 0.5, "{first} {last}");
        let end = branch.ends[0].to_string();
        for part in
            ["flight:impact accumulate at the first event", "restitution of 0", "`next: \"rest\"`"]
        {
            assert!(end.contains(part), "{end}");
        }
    }
}

/// Two cells that charge alike, and of which each discharges the other one with itself.
pub const CELLS: &str = r#"HybridEquations(
    modes: [(name: "go", states: [("a", "I - a"), ("b", "J - b")])],
    guards: [
        (name: "A", modes: ["go"], function: "1 - a",
         reset: [("a", 0), ("b", "if(b + eps >= 1, 0, b + eps)")]),
        (name: "B", modes: ["go"], function: "1 - b",
         reset: [("b", 0), ("a", "if(a + eps >= 1, 0, a + eps)")]),
    ],
    parameters: [("I", 1.3), ("J", 1.3), ("eps", 0.1)],
    initial: [("a", 0.3), ("b", 0)])"#;

/// In synchrony both guards vanish at every event: rounding decides which one of them is passed, and
/// that is no grazing.
#[test]
fn guards_that_vanish_together_all_along_a_branch_are_no_grazing() {
    let along = "along: [(name: \"eps\", low: 0.01, high: 0.3)]";
    let outcome =
        executed(CELLS, &format!("(name: \"cells\", start: Simulated(), {along})"), &mut ());
    assert!(outcome.error.is_none(), "{:?}", outcome.error);
    let branch = &outcome.document.branches[0];
    let kinds: Vec<Kind> = branch.special.iter().map(|it| it.kind).collect();
    assert_eq!(kinds, [Kind::EP; 2]);
    all_close(branch, "period", |_| (1.3_f64 / 0.3).ln(), 1e-10);
    let warned = |text: &String| {
        text.contains("the test function of `distance` vanishes, up to its error, at several successive points")
    };
    assert!(branch.warnings.iter().any(warned), "{:?}", branch.warnings);
}

/// A neuron whose threshold depends on a state that settles by half a percent at each firing: after
/// 1000 of them the motion still moves by 2.5e-5 each time.
#[test]
fn a_cycle_that_attracts_slowly_is_found_at_its_events() {
    let problem = r#"HybridEquations(
        modes: [(name: "go", states: [("v", "1 - v/2"), ("z", 0)])],
        guards: [(name: "fire", modes: ["go"], function: "1 + a*z - v",
                  reset: [("v", 0), ("z", "0.995*z + 0.005")])],
        parameters: [("a", 0.1)], initial: [("z", 2)])"#;
    let along = "along: [(name: \"a\", low: 0.05, high: 0.2)]";
    let run = format!("(name: \"neuron\", start: Simulated(transient: 100), {along})");
    all_close(&branch_of(problem, &run), "period", |a| -2.0 * (1.0 - (1.0 + a) / 2.0).ln(), 1e-9);
}

/// Likewise by sections across the motion, and by the period of a forcing.
#[test]
fn a_cycle_that_attracts_slowly_is_found_without_events() {
    let along = "along: [(name: \"k\", low: 0.0005, high: 0.002)]";
    let run = format!("(name: \"cycle\", start: Simulated(transient: 100), {along})");
    let circle = r#"Equations(
        states: [("x", "y"), ("y", "-x + k*(1 - x^2 - y^2)*y")],
        parameters: [("k", 0.0007)], initial: [("x", 1.5)])"#;
    all_close(&branch_of(circle, &run), "period", |_| std::f64::consts::TAU, 1e-5);
    let forced = r#"Equations(
        states: [("x", "-k*x + sin(t)")],
        parameters: [("k", 0.0007)], period: "2*pi", initial: [("x", 0.9)])"#;
    // Errors of flows grow by 1/(1 − μ), a few hundred times.
    all_close(&branch_of(forced, &run), "max_x", |k| 1.0 / (1.0 + k * k).sqrt(), 1e-8);
}

/// A motion that nearly repeats beside an unstable cycle only is refused as before.
#[test]
fn an_unstable_cycle_is_not_taken_for_the_motion() {
    let problem = r#"HybridEquations(
        modes: [(name: "go", states: [("v", "1 - v/2"), ("z", 0)])],
        guards: [(name: "fire", modes: ["go"], function: "1 + a*z - v",
                  reset: [("v", 0), ("z", "1.002*z - 0.002")])],
        parameters: [("a", 0.1)], initial: [("z", 1.002)])"#;
    let along = "along: [(name: \"a\", low: 0.05, high: 0.2)]";
    let run = format!("(name: \"neuron\", start: Simulated(transient: 100), {along})");
    let error = one_line(&executed(problem, &run, &mut ()).error.expect("unstable"));
    assert!(error.contains("no cycle was found"), "{error}");
}

/// A drill string that sticks and slips.
const DRILL: &str = r#"HybridEquations(
    modes: [
        (name: "slip", states: [("phi", "W - w"), ("W", "(u - k*phi - c*(W - w) - br*W)/Jr"),
                                ("w", "(k*phi + c*(W - w) - fr)/Jb")]),
        (name: "stick", states: [("phi", "W"), ("W", "(u - k*phi - c*W - br*W)/Jr")]),
    ],
    definitions: [("fr", "Tc + (Ts - Tc)*exp(-w/ws) + bb*w")],
    guards: [
        (name: "stop", modes: ["slip"], function: "w", next: "stick"),
        (name: "go", modes: ["stick"], function: "Ts - k*phi - c*W", next: "slip", reset: [("w", 0)]),
    ],
    parameters: [("u", 5), ("k", 0.473), ("c", 0.0005), ("br", 0.425), ("Jr", 2.122),
                 ("Jb", 0.375), ("Tc", 4), ("Ts", 6), ("ws", 1), ("bb", 0.05)],
    initial: [("phi", 12), ("W", 5), ("w", 5)])"#;

/// A slip of [`DRILL`] begins with `w = w' = 0`, where polynomials dip below zero by the error of the
/// mesh: no grazing. The fold and the grazing are those that shooting finds.
#[test]
fn a_slip_that_begins_tangentially_does_not_graze() {
    let run = "(name: \"drill\", start: Simulated(transient: 500), along: [(name: \"u\", low: 4.5, high: 12)],
        set: [(\"method\", \"collocation\"), (\"max_points\", \"100\")])";
    let branch = branch_of(DRILL, run);
    let at = |kind| branch.of_kind(kind).map(|it| it.parameters[0]).collect::<Vec<_>>();
    assert!(at(Kind::LP).iter().any(|u| (u - 4.91627936474).abs() < 1e-6), "{:?}", at(Kind::LP));
    assert!(at(Kind::G).iter().any(|u| (u - 8.16716370444).abs() < 1e-6), "{:?}", at(Kind::G));
}

/// Where the stick phase of [`DRILL`] vanishes, both methods state the stability of the orbit without
/// that phase: a deviation grows by 26.51.
#[test]
fn stability_where_a_leg_vanishes_is_that_of_the_orbit_without_it() {
    for method in ["shooting", "collocation"] {
        let run = format!(
            "(name: \"drill\", start: Simulated(transient: 500), along: [(name: \"u\", low: 4.95, high: 12)],
             set: [(\"method\", \"{method}\")])"
        );
        let branch = branch_of(DRILL, &run);
        let grazing = branch.of_kind(Kind::G).find(|it| it.parameters[0] > 8.0).expect("a grazing");
        close(grazing.parameters[0], 8.16716370444, 1e-9);
        assert_eq!(grazing.unstable, Some(1), "{method}");
        close(grazing.eigenvalues[0].0, 26.50996, 1e-3);
    }
}

/// A rimless wheel: of the speed a part `cos 2a` is left by each step, of its square deviations the
/// square, at every slope. Multipliers that are recorded at regular points are exact.
#[test]
fn multipliers_of_regular_points_are_exact() {
    let problem = r#"HybridEquations(
        modes: [(name: "s", states: [("th", "w"), ("w", "sin(th)")])],
        guards: [(name: "heel", modes: ["s"], function: "a + g - th",
                  reset: [("th", "g - a"), ("w", "cos(2*a)*w")])],
        parameters: [("g", 0.1), ("a", 0.3)], initial: [("th", -0.2), ("w", 0.6)])"#;
    let run = "(name: \"wheel\", start: Simulated(), along: [(name: \"g\", low: 0.05, high: 0.2)],
        set: [(\"eigenvalues\", \"2\")])";
    let branch = branch_of(problem, run);
    // The ends are special points.
    let inner = branch.points[1..branch.points.len() - 1].iter().map(|point| &point.eigenvalues);
    assert!(inner.len() > 10);
    for eigenvalues in inner.chain(branch.special.iter().map(|special| &special.eigenvalues)) {
        close(eigenvalues[0].0, 0.6_f64.cos().powi(2), 1e-10);
    }
}

/// A clock that is kicked once in a period of `2π/√(1 − z²)`. Between two kicks its amplitude falls
/// by `exp(−2πz/√(1 − z²))`, below all tolerances where `z` nears 1: the branch says from where on,
/// and before the period is exact.
#[test]
fn amplitudes_below_all_tolerances_are_named() {
    let problem = r#"HybridEquations(
        modes: [
            (name: "right", states: [("x", "v"), ("v", "-2*z*v - x")]),
            (name: "left", states: [("x", "v"), ("v", "-2*z*v - x")]),
        ],
        guards: [
            (name: "mid", modes: ["right"], function: "x", next: "left"),
            (name: "kick", modes: ["left"], function: "-x", next: "right", reset: [("v", "sqrt(v^2 + h)")]),
        ],
        parameters: [("z", 0.1), ("h", 0.5)], initial: [("x", 0.5)])"#;
    let along = "along: [(name: \"z\", low: 0.1, high: 0.995)]";
    let branch = branch_of(problem, &format!("(name: \"clock\", start: Simulated(), {along})"));
    let from = |text: &String| {
        let value = text.strip_prefix("from z = ")?.split(' ').next()?;
        value.parse::<f64>().ok()
    };
    let from = branch.warnings.iter().find_map(from).expect("a warning");
    assert!(from > 0.97 && from < 0.99, "{from}");
    let column = branch.column("period").unwrap();
    for point in branch.points.iter().filter(|point| point.parameters[0] < from) {
        let exact = std::f64::consts::TAU / (1.0 - point.parameters[0].powi(2)).sqrt();
        close(point.value(column).unwrap(), exact, 1e-6);
    }
}

/// Where deviations grow by more than 1e5 over one segment of shooting, steps are short, and a
/// branch that is out of points says that; on eight segments it gets to its end.
#[test]
fn branches_that_creep_name_the_segments() {
    let along = "along: [(name: \"u\", low: 2, high: 12)]";
    let run = |segments: usize| {
        let settings = format!("(\"max_points\", \"200\"), (\"segments\", \"{segments}\")");
        format!("(name: \"drill\", start: Simulated(transient: 500), {along}, set: [{settings}])")
    };
    let creeps = branch_of(DRILL, &run(1));
    let named = |text: &String| text.contains("over a segment") && text.contains("`segments=8`");
    assert!(creeps.warnings.iter().any(named), "{:?}", creeps.warnings);
    let whole = branch_of(DRILL, &run(8));
    assert!(whole.points.len() < 100 && whole.warnings.is_empty(), "{:?}", whole.warnings);
}

/// The cycles of a self-excited oscillator graze a stop where their phase begins. The grazing point was
/// found at the beginning and again at the end of the orbit for some ranges of the parameter, and the
/// branch of impacting orbits was lost.
#[test]
fn a_grazing_where_an_orbit_begins_is_a_single_grazing() {
    let problem = r#"HybridEquations(
        modes: [(name: "in", states: [("x", "v"), ("v", "(mu - 0.3 - 0.01*x^2)*v - x")])],
        guards: [(name: "hit", modes: ["in"], function: "1 - x", reset: [("v", "-0.7*v")])],
        parameters: [("mu", 0.1)], initial: [("x", 0.5)])"#;
    for high in [0.918, 0.9, 0.85, 0.77, 0.69, 0.6] {
        let along = format!("along: [(name: \"mu\", low: 0.05, high: {high})]");
        let runs = format!(
            "(name: \"rest\", set: [(\"solution\", \"equilibrium\")], {along}),
             (name: \"cycles\", start: From(run: \"rest\", kind: HB, switch: true), {along}),
             (name: \"impacts\", start: From(run: \"cycles\", kind: G, switch: true), {along})"
        );
        let outcome = executed(problem, &runs, &mut ());
        assert!(outcome.error.is_none(), "{high}: {:?}", outcome.error);
        let impacts = &outcome.document.branches[2];
        assert_eq!(impacts.itinerary, "in:hit", "{high}");
        let values: Vec<f64> = impacts.points.iter().map(|point| point.parameters[0]).collect();
        let reaches = |mu: f64| values.iter().any(|value| (value - mu).abs() < 1e-8);
        assert!(reaches(high) && reaches(0.3025), "{high}: {:?}", impacts.ends);
    }
}

/// The states of rest end at `mu = 0`, where all their columns vanish: they are not the grazing of the cycles.
#[test]
fn a_grazing_is_told_from_an_end_where_all_columns_vanish() {
    let problem = r#"HybridEquations(
        states: [("x", "v"), ("v", "(mu - 0.3 - 0.01*x^2)*v - x - d")],
        modes: [(name: "in", definitions: [("d", "0")]), (name: "right", definitions: [("d", "(1 + v)*(x - 1)")])],
        guards: [
            (name: "hit", modes: ["in"], function: "1 - x", next: "right"),
            (name: "off", modes: ["right"], function: "x - 1", next: "in"),
        ],
        parameters: [("mu", 0.1)], initial: [("x", 0.5)])"#;
    let runs = r#"(name: "rest", set: [("solution", "equilibrium")], along: [(name: "mu", low: 0, high: 0.5)])"#;
    let text = format!("Scene(title: \"t\", problem: {problem}, runs: [{runs}])");
    let (_, outcome) = explore(&Scene::parse(&text).unwrap(), 2, &mut ());
    assert!(outcome.error.is_none(), "{:?}", outcome.error);
    let impacts = outcome.document.branches.iter().find(|branch| branch.name == "rest-HB-G");
    let impacts = impacts.expect("the branch of impacting cycles");
    assert!(impacts.points.iter().any(|point| (point.parameters[0] - 0.5).abs() < 1e-12));
}
