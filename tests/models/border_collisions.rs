//! Promise: orbits whose motion passes a surface at the beginning or at the end of a leg are not admissible, and
//! branches end there with a `G`.

use crate::common::close;
use tangency::core::continuation::{Branch, End};
use tangency::core::system::Kind;

/// The branch of a model with the given range and start of `p`.
fn branch(model: &str, start: f64, [low, high]: [f64; 2]) -> Branch {
    let scene = format!(
        r#"Scene(title: "t", problem: {model}, parameters: [("p", {start})], runs: [
            (name: "a", start: Simulated(transient: 200), along: [(name: "p", low: {low}, high: {high})])])"#
    );
    super::traced(&scene).remove(0)
}

/// The value of `p` at the last `G` of a branch that ends there; all solutions are admissible.
fn end(branch: &Branch, side: usize) -> f64 {
    assert!(matches!(branch.ends[side], End::Grazing { .. }), "{:?}", branch.ends);
    let mut grazings = branch.of_kind(Kind::G);
    let special = if side == 0 { grazings.next() } else { grazings.last() }.unwrap();
    assert!(special.converged && branch.points.iter().all(|point| point.admissible));
    special.parameters[0]
}

/// A neuron that fires at its threshold and is discharged to a fifth by a clock. Beyond
/// `p (p − 0.2) = e (p − 1)²` it fires a second time before the next discharge.
#[test]
fn a_threshold_is_reached_at_the_end_of_a_leg() {
    let model = r#"HybridEquations(modes: [(name: "run", states: [("x", "p - x"), ("y", "-y")])],
        guards: [(name: "spike", modes: ["run"], function: "1 - x", reset: [("x", "0"), ("y", "y + 1")]),
            (name: "dump", modes: ["run"], at: "n", reset: [("x", "0.2*x")])], period: "1")"#;
    let p = end(&branch(model, 2.0, [1.7, 6.0]), 1);
    close(p * (p - 0.2), std::f64::consts::E * (p - 1.0).powi(2), 1e-9);
}

/// A clock charges a neuron: beyond `p = 1 − 1/e` the charge alone exceeds the threshold.
#[test]
fn a_clock_moves_the_state_beyond_a_threshold() {
    let model = r#"HybridEquations(modes: [(name: "run", states: [("x", "-x"), ("y", "-y")])],
        guards: [(name: "spike", modes: ["run"], function: "1 - x", reset: [("x", "0"), ("y", "y + 1")]),
            (name: "kick", modes: ["run"], at: "n", reset: [("x", "x + p")])], period: "1")"#;
    close(end(&branch(model, 0.4, [0.1, 4.0]), 1), 1.0 - (-1.0_f64).exp(), 1e-9);
}

/// Dry friction: rates of the sliding motion are rounding errors, and have every period.
#[test]
fn rates_of_sliding_motion_have_the_period() {
    let model = r#"FilippovEquations(surface: "v", above: [("x", "v"), ("v", "-x - 0.1*v + cos(0.5*t) - p")],
        below: [("x", "v"), ("v", "-x - 0.1*v + cos(0.5*t) + p")], period: "4*pi")"#;
    let branch = branch(model, 0.2, [0.15, 0.25]);
    assert!(branch.points.len() > 2, "{:?}", branch.ends);
}
