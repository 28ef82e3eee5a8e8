//! Promise: a bound at which a branch ends hides no special point, even if the last step passes another
//! special point beyond the bound.

use super::traced;
use crate::common::{close, values};
use tangency::core::continuation::Branch;
use tangency::prelude::*;

/// The branch of a problem from m = 2, with the bound m = 0.1. The growth rate `m (0.2 − m)` is
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

/// The number of unstable eigenvalues is the same at both ends of the last step, although the step passes
/// two branch points.
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

/// The step passes m = 0.2, before the bound, and m = 0 and m = −0.1, beyond the bound: one branch point
/// explains the change over the whole step, wherever it lies.
#[test]
fn a_branch_point_beyond_a_bound_explains_no_change_before_the_bound() {
    let problem = r#"Equations(states: [("u", "m*(0.2 - m)*(m + 0.1)*u - u^3"), ("v", "-v - u + sin(t)")],
        parameters: [("m", 2)], period: "2*pi")"#;
    let found = values(&towards_bound(problem, SIMULATED), Kind::BP, "m");
    assert_eq!(found.len(), 1, "{found:?}");
    close(found[0], 0.2, 1e-9);
}

#[test]
fn torus_points_before_a_bound_are_found() {
    let problem = r#"Equations(states: [("u", "m*(0.2 - m)*u - 0.3*w - u*(u^2 + w^2)"),
        ("w", "m*(0.2 - m)*w + 0.3*u - w*(u^2 + w^2)"), ("v", "-v - u + sin(t)")], parameters: [("m", 2)], period: "2*pi")"#;
    let branch = towards_bound(problem, SIMULATED);
    let found = values(&branch, Kind::TR, "m");
    assert_eq!(found.len(), 1);
    close(found[0], 0.2, 1e-9);
    assert!(branch.points.iter().all(|point| {
        let stable = point.unstable == Some(0);
        stable == (point.parameters[0] > 0.2) || (point.parameters[0] - 0.2).abs() < 1e-6
    }));
}
