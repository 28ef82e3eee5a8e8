//! Promise: branches begin where a model or a scene says.

use crate::common::close;
use tangency::core::continuation::Branch;
use tangency::scene::{Scene, execute};

fn traced(text: &str) -> Vec<Branch> {
    let scene = Scene::parse(text).unwrap_or_else(|error| panic!("{error}"));
    let outcome = execute(&scene, None, &mut ());
    assert!(outcome.error.is_none(), "{:?}", outcome.error);
    outcome.document.branches
}

/// The largest solution of `θ = √2 cosh(θ/4)`, by bisection: of both solutions of `u'' + eᵘ = 0`,
/// `u(0) = u(1) = 0`, the larger one has the maximum `2 ln cosh(θ/4)`.
fn upper_theta() -> f64 {
    let (mut low, mut high) = (6.0_f64, 20.0_f64);
    for _ in 0..100 {
        let middle = 0.5 * (low + high);
        let is_beyond = 2.0_f64.sqrt() * (middle / 4.0).cosh() > middle;
        (low, high) = if is_beyond { (low, middle) } else { (middle, high) };
    }
    low
}

/// From constants Newton's iteration finds the smaller solution.
#[test]
fn boundary_values_begin_at_profiles() {
    let largest = |initial: &str| {
        let text = format!(
            "Scene(title: \"t\", problem: Boundary(states: [(\"u\", \"v\"), (\"v\", \"-lambda*exp(u)\")],
                conditions: [\"u(0)\", \"u(1)\"], {initial}), parameters: [(\"lambda\", 1)],
                runs: [(name: \"r\", along: [(name: \"lambda\", low: 1, high: 2)])])"
        );
        let branch = &traced(&text)[0];
        let start = branch.special.iter().find(|special| special.parameters[0] == 1.0);
        start.and_then(|start| start.value(branch.column("max_u")?)).expect("a start")
    };
    let profile = "initial: [(\"u\", \"16*t*(1 - t)\"), (\"v\", \"16*(1 - 2*t)\")]";
    close(largest(profile), 2.0 * (upper_theta() / 4.0).cosh().ln(), 1e-6);
    close(largest("initial: []"), 0.140_539_214, 1e-6);
}

/// Orbits, unless the run says that equilibria are followed.
#[test]
fn a_run_from_a_hopf_point_traces_orbits() {
    let text = |set: &str| {
        format!(
            "Scene(title: \"t\", problem: Equations(states: [(\"x\", \"1 - (b + 1)*x + x^2*y\"), (\"y\", \"b*x - x^2*y\")],
                initial: [(\"x\", 1), (\"y\", 1)], solution: equilibrium), parameters: [(\"b\", 1)],
                runs: [(name: \"rest\", along: [(name: \"b\", low: 1, high: 3)]),
                    (name: \"from\", {set} start: From(run: \"rest\", kind: HB), along: [(name: \"b\", low: 1, high: 3)])])"
        )
    };
    let has_period = |set: &str| traced(&text(set))[1].column("period").is_some();
    assert!(has_period(""));
    assert!(!has_period("set: [(\"solution\", \"equilibrium\")],"));
}
