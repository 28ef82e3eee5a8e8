//! Promise: models with events that state no scales have the scales of their motion, and say so.

use std::path::Path;
use tangency::core::system::Kind;
use tangency::scene::{Problem, Range, Request, Scene, execute};

/// A scene with one run over a parameter `p`.
pub fn scene(problem: &str) -> Scene {
    let text = format!(
        "Scene(title: \"t\", problem: {problem}, runs: [(name: \"r\", start: Simulated(), along: [(name: \"p\", low: 0.2, high: 0.6)])])"
    );
    Scene::parse(&text).unwrap_or_else(|error| panic!("{error}\n{text}"))
}

/// A thermostat that heats towards 2 and cools towards −1, between p and 1: its period is
/// S (ln(2 − p) + ln(2/(p + 1))).
fn thermostat(scale: &str) -> String {
    format!(
        "HybridEquations(
            modes: [(name: \"heat\", states: [(\"x\", \"(2 - x)/S\")]), (name: \"cool\", states: [(\"x\", \"-(1 + x)/S\")])],
            guards: [
                (name: \"hot\", modes: [\"heat\"], function: \"1 - x\", next: \"cool\"),
                (name: \"cold\", modes: [\"cool\"], function: \"x - p\", next: \"heat\"),
            ],
            parameters: [(\"p\", 0.5), (\"S\", {scale})],
        )"
    )
}

#[test]
fn autonomous_systems_of_any_speed_settle() {
    for scale in ["1e-9", "1e-6", "1", "1e6", "1e9"] {
        let text = thermostat(scale);
        let problem = Problem::from_text(Path::new("thermostat.ron"), &text, &[]).unwrap();
        let along = vec![Range { name: "p".into(), low: Some(0.2), high: Some(0.6) }];
        let request = Request { along, ..Request::default() };
        let scene = Scene::of_model(problem, "thermostat", &request).unwrap();
        let warnings = scene.warnings();
        assert_eq!(warnings.is_empty(), scale == "1", "{scale}: {warnings:?}");
        assert!(warnings.iter().all(|it| it.contains("scales: [(\"t\", ")), "{warnings:?}");
        let outcome = execute(&scene, None, &mut ());
        assert!(outcome.error.is_none(), "{scale}: {:?}", outcome.error);
        let branch = &outcome.document.branches[0];
        let [p, period] = ["p", "period"].map(|name| branch.column(name).unwrap());
        for point in &branch.points {
            let p = point.value(p).unwrap();
            let exact = scale.parse::<f64>().unwrap() * ((2.0 - p).ln() + (2.0 / (p + 1.0)).ln());
            let period = point.value(period).unwrap();
            assert!((period / exact - 1.0).abs() < 1e-9, "{scale}: {period} in place of {exact}");
        }
        assert_eq!(branch.of_kind(Kind::EP).count(), 2, "{scale}");
    }
}

/// A forced mass with a stop, a capacitor that the motion charges, and a pressure.
#[test]
fn small_and_large_states_have_their_own_scales() {
    let warnings = scene(
        "HybridEquations(
            states: [(\"q\", \"(1e-3*x - q/1e-15)*1e-15\"), (\"P\", \"1e7 - P\")],
            modes: [(name: \"free\", states: [(\"x\", \"v\"), (\"v\", \"-x - 0.1*v + p*cos(t)\")])],
            guards: [(name: \"stop\", modes: [\"free\"], function: \"1 - x\", reset: [(\"v\", \"-0.5*v\")])],
            parameters: [(\"p\", 0.5)],
            period: \"2*pi\",
        )",
    )
    .warnings();
    assert_eq!(warnings.len(), 1, "{warnings:?}");
    assert!(
        warnings[0].contains("scales: [(\"q\", \"1e-18\"), (\"P\", \"1e7\"), "),
        "{warnings:?}"
    );
}

/// The differences of two equal oscillators, whose equations are rounded differently, vanish.
#[test]
fn rounding_errors_are_no_scales() {
    let scene = scene(
        "HybridEquations(
            modes: [(name: \"free\", states: [
                (\"x\", \"v\"), (\"v\", \"-(0.1*v + x) + p*cos(t)\"), (\"z\", \"w\"), (\"w\", \"p*cos(t) - z - v/10\"),
                (\"d\", \"x - z - d\"),
            ])],
            guards: [(name: \"stop\", modes: [\"free\"], function: \"9 - x\", reset: [(\"v\", \"-0.5*v\")])],
            parameters: [(\"p\", 0.5)],
            period: \"2*pi\",
        )",
    );
    assert_eq!(scene.warnings(), [""; 0]);
}

/// A linear resonator in metres and seconds, with a quality factor of 224: every motion settles to the
/// period of the forcing. With tolerances for states of size 1, errors of the motion were read as
/// motions of up to fourteen periods.
#[test]
fn forced_systems_settle_to_the_period_of_the_forcing() {
    let text = "Equations(
        states: [(\"x\", \"v\"), (\"v\", \"(F*cos(2*pi*f*t) - c*v - k*x)/m\")],
        parameters: [(\"f\", \"30e3\"), (\"F\", \"1e-7\"), (\"k\", 5), (\"c\", \"1e-7\"), (\"m\", \"1e-10\")],
        period: \"1/f\",
    )";
    for start in ["22e3", "28e3", "29e3", "31e3", "33e3"] {
        let problem = Problem::from_text(Path::new("resonator.ron"), text, &[]).unwrap();
        let along = vec![Range { name: "f".into(), low: Some(20e3), high: Some(40e3) }];
        let set = vec![("f".to_string(), start.to_string())];
        let request = Request { along, set, ..Request::default() };
        let scene = Scene::of_model(problem, "resonator", &request).unwrap();
        let warnings = scene.warnings();
        assert!(warnings.iter().any(|it| it.contains("scales: [(\"x\", ")), "{warnings:?}");
        let outcome = execute(&scene, None, &mut ());
        assert!(outcome.error.is_none(), "{start}: {:?}", outcome.error);
        let branch = &outcome.document.branches[0];
        let [f, period] = ["f", "period"].map(|name| branch.column(name).unwrap());
        for point in &branch.points {
            let periods = point.value(f).unwrap() * point.value(period).unwrap();
            assert!((periods - 1.0).abs() < 1e-12, "{start}: {periods} periods");
        }
    }
}
