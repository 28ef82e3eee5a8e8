//! Promise: a bound at which a branch ends hides no special point, even if the last step passes another
//! special point beyond the bound.

use super::{branches, scene, traced};
use crate::common::{close, values};
use tangency::core::continuation::Branch;
use tangency::prelude::*;

/// The branch of a problem from m = 2 or m = 3, with the bound m = 0.1. The growth rate `m (0.2 − m)` is
/// zero at m = 0.2 and at m = 0, beyond the bound.
fn towards_bound(problem: &str, start: &str) -> Branch {
    let text = format!(
        r#"Scene(title: "bound", problem: {problem},
        runs: [(name: "branch", start: {start}, along: [(name: "m", low: 0.1, high: 3)])])"#
    );
    traced(&text).remove(0)
}

const SIMULATED: &str = "Simulated(transient: 100)";
const GUESS: &str = "Guess([])";

/// Stability changes in the last step, from the values at both ends of the step it would not.
#[test]
fn branch_points_before_a_bound_are_found() {
    let cubic = "m*(0.2 - m)*u - u^3";
    let models = [
        (
            format!(
                r#"Equations(states: [("u", "{cubic}"), ("v", "-v - u + sin(t)")], parameters: [("m", 2)], period: "2*pi")"#
            ),
            SIMULATED,
        ),
        (
            format!(r#"Map(states: [("u", "u + {cubic}")], parameters: [("m", 2)])"#).replace("m*(0.2 - m)", "0.1*m*(0.2 - m)"),
            SIMULATED,
        ),
        (
            format!(
                r#"Residual(unknowns: [("u", "u^2 - 1 + 0*m"), ("w", "{}")], parameters: [("m", 2)], initial: [("u", 1)])"#,
                cubic.replace('u', "w")
            ),
            GUESS,
        ),
        (
            r#"Boundary(states: [("u", "v"), ("v", "-pi^2*u - m*(0.2 - m)*u + u^3")], conditions: ["u(0)", "u(1)"],
               parameters: [("m", 2)])"#
                .into(),
            GUESS,
        ),
    ];
    for (problem, start) in models {
        let branch = towards_bound(&problem, start);
        let found = values(&branch, Kind::BP, "m");
        assert!(found.len() == 1, "{problem}: {found:?}");
        close(found[0], 0.2, 1e-9);
    }
}

#[test]
fn torus_points_before_a_bound_are_found() {
    let problem = r#"Equations(states: [("u", "m*(0.2 - m)*u - 0.3*w - u*(u^2 + w^2)"),
        ("w", "m*(0.2 - m)*w + 0.3*u - w*(u^2 + w^2)"), ("v", "-v - u + sin(t)")], parameters: [("m", 2)], period: "2*pi")"#;
    let branch = towards_bound(problem, SIMULATED);
    close(values(&branch, Kind::TR, "m")[0], 0.2, 1e-9);
    assert!(branch.points.iter().all(|point| {
        let stable = point.unstable == Some(0);
        stable == (point.parameters[0] > 0.2) || (point.parameters[0] - 0.2).abs() < 1e-6
    }));
}

/// Two eigenvalues vanish at K = 1.62600810784 (0 = 5 u − u³ − 1, 5 − 3 u² = 3 K). The derivative with
/// respect to K vanishes in the uniform state, up to rounding errors of the state: whatever the guess, the
/// branches cross.
#[test]
fn a_double_branch_point_is_no_fold_whatever_the_guess() {
    for guess in [0.2, 0.0, 0.4, -0.1, -0.2016, 0.15] {
        let text = format!(
            r#"Scene(title: "ring", problem: Residual(dynamics: flow,
            unknowns: [("u[i=1..3]", "5*u[i] - u[i]^3 - 1 + K*(u[i-1] - 2*u[i] + u[i+1])")],
            definitions: [("u[i=0..4]", "u[1+mod(i-1,3)]")], parameters: [("K", 2)]),
            runs: [(name: "branch", start: Guess([("u", {guess})]), along: [(name: "K", low: 0.1, high: 5)])])"#
        );
        let branch = branches(&scene(&text)).remove(0);
        assert!(branch.of_kind(Kind::LP).next().is_none(), "{guess}");
        let double = branch.of_kind(Kind::BP).next().unwrap();
        assert_eq!(double.multiplicity, 2, "{guess}");
        close(double.parameters[0], 1.626_008_107_84, 1e-9);
    }
}

/// The branch of buckled states ends where it meets the constant states again, at m = √(12 − π²): the
/// solutions are no orbits, and no period is halved there.
#[test]
fn boundary_values_have_no_period_doublings() {
    let text = r#"Scene(title: "buckled", problem: Boundary(states: [("w", "v"), ("v", "-(12 - m^2)*(w - 1) + (w - 1)^3")],
        conditions: ["v(0)", "v(1)"], parameters: [("m", -3)], initial: [("w", "1")]),
        runs: [(name: "flat", along: [(name: "m", low: -3, high: 3)]),
            (name: "buckled", start: From(run: "flat", kind: BP, switch: true), along: [(name: "m", low: -3, high: 3)])])"#;
    let all = traced(text);
    let expected = (12.0 - std::f64::consts::PI.powi(2)).sqrt();
    let flat = values(&all[0], Kind::BP, "m");
    close(flat[0], -expected, 1e-9);
    close(flat[1], expected, 1e-9);
    assert!(all[1].of_kind(Kind::PD).next().is_none());
    close(values(&all[1], Kind::BP, "m")[0], expected, 1e-6);
}

/// The square wave jumps within intervals of the mesh, and the errors of collocation are larger than
/// stated: exactly p = 0.414532491990, from the transfer matrix of the Riccati equation.
#[test]
fn a_forcing_that_jumps_is_a_warning() {
    let text = |method: &str| {
        format!(
            r#"Scene(title: "square wave", problem: Equations(states: [("x", "p - x^2 + if(mod(t, 1) < 0.3, 1, -1)")],
            parameters: [("p", 2)], period: "1", initial: [("x", 1.4)], method: {method}()),
            runs: [(name: "branch", start: Simulated(transient: 100), along: [(name: "p", low: -1, high: 3)])])"#
        )
    };
    let warns = |branch: &Branch| branch.warnings.iter().any(|text| text.contains("discontinuous"));
    let collocation = traced(&text("collocation")).remove(0);
    assert!(warns(&collocation));
    let shooting = traced(&text("shooting")).remove(0);
    assert!(!warns(&shooting));
    close(values(&shooting, Kind::LP, "p")[0], 0.414_532_491_990, 1e-8);
}
