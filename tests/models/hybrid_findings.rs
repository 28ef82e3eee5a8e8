//! Promise: findings about hybrid models that strangers wrote stay mended.

use std::time::Duration;
use tangency::core::continuation::Observer;
use tangency::scene::{Outcome, Scene, SceneObserver, execute};

/// What becomes of a problem and its runs.
fn executed(problem: &str, runs: &str, observer: &mut dyn SceneObserver) -> Outcome {
    let text = format!("Scene(title: \"t\", problem: {problem}, runs: [{runs}])");
    execute(&Scene::parse(&text).unwrap_or_else(|error| panic!("{error}")), None, observer)
}

/// A boost converter with a clock of period `T`, in SI units; the scale of time is stated.
const BOOST: &str = r#"HybridEquations(
    modes: [
        (name: "on", states: [("i", "Vin/L"), ("v", "-v/(R*C)"), ("s", 1)]),
        (name: "off", states: [("i", "(Vin - v)/L"), ("v", "(i - v/R)/C"), ("s", 1)]),
    ],
    guards: [
        (name: "peak", modes: ["on"], function: "Iref - i", next: "off"),
        (name: "clock", modes: ["on", "off"], function: "T - s", next: "on", reset: [("s", 0)]),
    ],
    parameters: [("Iref", 0.7), ("Vin", 10), ("L", 1.5e-3), ("C", 10e-6), ("R", 40), ("T", 1e-4)],
    initial: [("i", 0.3), ("v", 12)],
    scales: [("t", "1e-4"), ("s", "1e-4")],
)"#;

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
