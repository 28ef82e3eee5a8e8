//! Promise: solutions on a mesh have special points of the right kind, and doubtful errors are marked.

use super::traced;
use crate::common::{close, values};
use tangency::core::continuation::Branch;
use tangency::prelude::*;

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
fn a_jump_of_an_equation_on_a_mesh_causes_a_warning() {
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
