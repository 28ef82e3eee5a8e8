//! Promise: guards and resets that jump are named, with what to write in their place.

use super::hybrid_findings::CELLS;
use super::traced;
use crate::common::close;
use tangency::core::continuation::{Branch, End};
use tangency::core::failure::one_line;
use tangency::core::system::Kind;
use tangency::scene::{Scene, execute};

/// What becomes of a scene of one problem, in the words of its error.
fn refused(problem: &str, runs: &str) -> String {
    let scene = Scene::parse(&format!("Scene(title: \"t\", problem: {problem}, runs: [{runs}])"));
    let outcome = execute(&scene.unwrap(), None, &mut ());
    one_line(&outcome.error.expect("an error"))
}

fn branches(problem: &str, runs: &str) -> Vec<Branch> {
    traced(&format!("Scene(title: \"t\", problem: {problem}, runs: [{runs}])"))
}

/// A pulse in every year is missed where its guard jumps away from zero. The branch that is saved says
/// so.
#[test]
fn warnings_of_guards_that_jump_are_saved() {
    let problem = |when: &str| {
        format!(
            r#"HybridEquations(
                modes: [(name: "go", states: [("S", "b - S")])], period: "1",
                guards: [(name: "pulse", modes: ["go"], {when}, reset: [("S", "S/2")])],
                parameters: [("b", 1)], initial: [("S", 1)])"#
        )
    };
    let run = r#"(name: "pulses", start: Simulated(), along: [(name: "b", low: 0.5, high: 2)])"#;
    let warnings = |when: &str| branches(&problem(when), run).swap_remove(0).warnings;
    let saved = warnings(r#"function: "1 - mod(t, 1)""#);
    assert!(saved[0].contains("the guard `pulse` is discontinuous"), "{saved:?}");
    assert_eq!(warnings(r#"at: "n""#), Vec::<String>::new());
}

/// A clock that is set back at `x = 1`.
fn clock(guard: &str) -> String {
    format!(
        r#"HybridEquations(
            modes: [(name: "go", states: [("x", "k"), ("y", "x - y")])],
            guards: [(name: "wrap", modes: ["go"], function: "{guard}", reset: [("x", 0)])],
            parameters: [("k", 1)], initial: [("x", 0.2)])"#
    )
}

/// Simulations see a guard that jumps through zero; equations of orbits need one that vanishes.
#[test]
fn guards_that_jump_through_zero_are_refused_by_name() {
    let along = "along: [(name: \"k\", low: 0.5, high: 2)]";
    let run = format!("(name: \"clock\", start: Simulated(transient: 20), {along})");
    for guard in ["if(x < 1, 1, -1)", "1 - floor(x)", "sign(1 - x)"] {
        let error = refused(&clock(guard), &run);
        for part in ["the guard `wrap` of mode `go` jumps through zero", "`1 - x` in place of"] {
            assert!(error.contains(part), "{error}");
        }
    }
    let branch = branches(&clock("1 - x"), &run).swap_remove(0);
    let period = branch.column("period").unwrap();
    for point in &branch.points {
        close(point.value(period).unwrap(), 1.0 / point.parameters[0], 1e-10);
    }
}

/// Cell `a` discharges `b`, which is charged up to `J/I` then, if `J/I + eps ≥ 1`.
#[test]
fn a_branch_ends_where_a_reset_jumps() {
    for (method, max_step) in [("shooting", "0.1"), ("shooting", "0.02"), ("collocation", "0.1")] {
        let set = format!(
            "set: [(\"J\", \"1.25\"), (\"method\", \"{method}\"), (\"max_step\", \"{max_step}\")]"
        );
        let along = "along: [(name: \"J\", low: 1.1, high: 1.29)]";
        let run = format!("(name: \"cells\", start: Simulated(transient: 100), {along}, {set})");
        let branch = branches(CELLS, &run).swap_remove(0);
        let End::ResetJumps { event, state, from, to } = &branch.ends[0] else {
            panic!("{}", branch.ends[0]);
        };
        assert_eq!((&event[..], &state[..]), ("A", "b"));
        close(*from, 0.0, 1e-12);
        close(*to, 1.0, 1e-6);
        let jump = branch.of_kind(Kind::G).next().expect("a jump");
        close(jump.parameters[1], 0.9 * 1.3, 1e-10);
        assert!(jump.converged && jump.unstable == Some(0) && jump.error < 1e-9);
        let switched = format!(
            "{run}, (name: \"on\", start: From(run: \"cells\", kind: G, switch: true), {along})"
        );
        let error = refused(CELLS, &switched);
        assert!(error.contains("the reset of the event `A` is discontinuous"), "{error}");
    }
}

/// A hopper with springy legs and a control of its energy. The leg touches the ground where the height
/// falls through that of the leg.
fn hopper(flight: &str, down: &str) -> String {
    format!(
        r#"HybridEquations(
            modes: [
                {flight}
                (name: "stance", states: [("x", "vx"), ("y", "vy"), ("vx", "k*(1/l - 1)*x"), ("vy", "k*(1/l - 1)*y - 1")]),
            ],
            definitions: [("l", "sqrt(x^2 + y^2)")],
            guards: [
                {down}
                (name: "up", modes: ["stance"], function: "1 - sqrt(x^2 + y^2)", next: "rise"),
            ],
            parameters: [("al", 0.5), ("k", 15), ("E0", 2.2)],
            initial: [("y", 1.05), ("vx", 1.4), ("vy", 0.01)])"#
    )
}

/// `max(h, v)` is a guard that counts only while `h` falls: its points are those of a model with modes
/// of rise and of fall.
#[test]
fn a_guard_counts_only_while_it_falls() {
    let states = r#"states: [("y", "vy"), ("vx", 0), ("vy", -1)]"#;
    let two = hopper(
        &format!("(name: \"rise\", {states}), (name: \"fall\", {states}),"),
        r#"(name: "apex", modes: ["rise"], function: "vy", next: "fall", reset: [("vx", "sqrt(2*(E0 - y))")]),
           (name: "down", modes: ["fall"], function: "y - cos(al)", next: "stance", reset: [("x", "-sin(al)")]),"#,
    );
    let one = hopper(
        &format!("(name: \"rise\", {states}),"),
        r#"(name: "down", modes: ["rise"], function: "max(y - cos(al), vy)", next: "stance",
            reset: [("x", "-sin(al)"), ("vx", "sqrt(2*(E0 - y) - vy^2)")]),"#,
    );
    let methods = ["shooting", "collocation"];
    for (problem, method) in [&two, &one].into_iter().flat_map(|it| methods.map(|m| (it, m))) {
        let along = "along: [(name: \"k\", low: 10, high: 20)]";
        let set = format!("set: [(\"method\", \"{method}\")]");
        let run = format!("(name: \"hops\", start: Simulated(transient: 200), {along}, {set})");
        let branch = branches(problem, &run).swap_remove(0);
        for (kind, k) in
            [(Kind::G, 11.7446464098), (Kind::PD, 14.1469061841), (Kind::LP, 16.7416840076)]
        {
            let found: Vec<f64> = branch.of_kind(kind).map(|it| it.parameters[1]).collect();
            assert_eq!(found.len(), 1, "{kind} by {method}: {found:?}");
            close(found[0], k, 1e-9);
        }
    }
}

/// Pests that a spray keeps away: `x = 0` up to what Newton's iteration leaves of it, which no mesh has
/// to resolve. They come back where `d (r T + ln 0.7) = q`.
#[test]
fn a_state_that_is_zero_needs_no_finer_mesh() {
    let problem = r#"HybridEquations(
        modes: [(name: "go", states: [("x", "x*(r - x) - x*y"), ("y", "x*y - d*y"), ("s", "1/T")])],
        guards: [(name: "spray", modes: ["go"], function: "1 - s", reset: [("s", 0), ("x", "0.7*x"), ("y", "y + q")])],
        parameters: [("T", 4), ("r", 1.8), ("d", 0.4), ("q", 0.2)],
        initial: [("x", 0.5), ("y", 0.5)])"#;
    let along = "along: [(name: \"q\", low: 0.1, high: 4)]";
    for max_step in ["0.02", "0.1"] {
        let set = format!("set: [(\"method\", \"collocation\"), (\"max_step\", \"{max_step}\")]");
        let runs = format!(
            "(name: \"pests\", start: Simulated(transient: 300), {along}, {set}),
             (name: \"none\", start: From(run: \"pests\", kind: BP, switch: true), {along}, {set})"
        );
        let all = branches(problem, &runs);
        let crossing = all[0].of_kind(Kind::BP).next().expect("a branch point");
        close(crossing.parameters[3], 0.4 * (1.8 * 4.0 + 0.7_f64.ln()), 1e-8);
        let ends: Vec<f64> = all[1].of_kind(Kind::EP).map(|it| it.parameters[3]).collect();
        assert_eq!(ends, [0.1, 4.0], "{:?}", all[1].ends);
    }
}
