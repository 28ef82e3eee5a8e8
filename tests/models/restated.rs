//! Built-in problems restated as text: the same special points and the same attractors.

use crate::common::close;
use tangency::core::continuation::Branch;
use tangency::core::hybrid::HybridSystem;
use tangency::core::problem::VectorField;
use tangency::core::scalar::LaneWidth;
use tangency::core::sweep::Part;
use tangency::language::{Model, Source};
use tangency::problems::classic::{ImpactOscillator, Isothermal, Lure};
use tangency::problems::mita::Actuator;
use tangency::scene::{BUILT_IN, Scene, execute, sweep};

const LURE: &str = r#"Equations(
    states: [("x", "y"), ("y", "z"), ("z", "x^2 - x - beta*y - alpha*z")],
)"#;

const ISOTHERMAL: &str = r#"Equations(
    states: [
        ("y1", "y1*(30 - y1/4 - y2 - y3) + 0.001*y2^2 + 0.1"),
        ("y2", "y2*(y1 - 0.001*y2 - lambda) + 0.1"),
        ("y3", "y3*(16.5 - y1 - y3/2) + 0.1"),
    ],
)"#;

const IMPACT_OSCILLATOR: &str = r#"HybridEquations(
    modes: [
        (name: "flight", states: [
            ("displacement", "velocity"),
            ("velocity", "amplitude*cos(frequency*t) - displacement - damping*velocity"),
        ]),
        (name: "contact", states: [("displacement", 0)]),
    ],
    guards: [
        (name: "impact", modes: ["flight"], function: "clearance - displacement", next: "flight",
            reset: [("velocity", "-restitution*velocity")], accumulates_to: "contact"),
        (name: "leave", modes: ["contact"], function: "amplitude*cos(frequency*t) - displacement", next: "flight",
            reset: [("velocity", 0)]),
    ],
    parameters: [("amplitude", 0.05), ("frequency", 1), ("restitution", 0.8), ("damping", 0.1), ("clearance", 1)],
    period: "2*pi/frequency",
)"#;

const BRATU: &str = r#"Boundary(
    states: [("u", "v"), ("v", "-lambda*exp(u)")],
    conditions: ["u(0)", "u(1)"],
    parameters: [("lambda", 0)],
)"#;

const ACTUATOR: &str = include_str!("actuator.ron");

fn built_in(name: &str) -> &'static str {
    BUILT_IN.iter().find(|scene| scene.name == name).expect("a scene").text
}

/// The scene with equations as text in place of its problem.
fn restated(name: &str, problem: &str, equations: &str) -> Scene {
    let text = built_in(name).replacen(
        &format!("problem: {problem}()"),
        &format!("problem: {equations}"),
        1,
    );
    assert!(text.contains(equations), "{name} is of {problem}");
    Scene::parse(&text).unwrap_or_else(|error| panic!("{error}"))
}

fn same_points(name: &str, problem: &str, equations: &str) {
    let compiled = execute(&Scene::parse(built_in(name)).unwrap(), None, &mut ());
    let text = execute(&restated(name, problem, equations), None, &mut ());
    assert!(compiled.error.is_none() && text.error.is_none(), "{name}: {:?}", text.error);
    let branches = compiled.document.branches.iter().zip(&text.document.branches);
    assert_eq!(compiled.document.branches.len(), text.document.branches.len());
    for (branch, restated) in branches {
        let kinds = |branch: &Branch| branch.special.iter().map(|s| s.kind).collect::<Vec<_>>();
        assert_eq!(kinds(branch), kinds(restated), "{name}, {}", branch.name);
        for (point, again) in branch.special.iter().zip(&restated.special) {
            assert_eq!(point.unstable, again.unstable, "{name}, {}: {}", branch.name, point.label);
            let parameter = |k: usize, names: &Branch| names.column(&branch.parameters[k]);
            for k in 0..branch.parameters.len() {
                let at = parameter(k, restated).expect("the same parameters");
                let (expected, found) = (point.parameters[k], again.value(at).expect("a value"));
                let tolerance = (point.error + again.error).max(1e-12) * expected.abs().max(1.0);
                close(found, expected, tolerance);
            }
        }
    }
}

#[test]
fn smooth_fields_and_boundary_value_problems() {
    same_points("lure", "Lure", LURE);
    same_points("isothermal", "Isothermal", ISOTHERMAL);
    same_points("bratu", "Bratu", BRATU);
}

#[test]
fn impacting_orbits_and_their_grazings() {
    same_points("impact-oscillator", "ImpactOscillator", IMPACT_OSCILLATOR);
    same_points("mita-type-1", "Mita", ACTUATOR);
    same_points("mita-voltage", "Mita", ACTUATOR);
}

#[test]
fn attractors_of_the_actuator() {
    let runs = |problem: &str| {
        let text = format!(
            "Scene(title: \"t\", problem: {problem}, parameters: [(\"frequency\", 0.5)],
                sweeps: [(name: \"s\", over: [(name: \"voltage\", low: 0.1, high: 0.3, count: 5)],
                    search: (transient: 100, recorded_periods: 32, max_period: 16), measures: [\"max_displacement\"])])"
        );
        let scene = Scene::parse(&text).unwrap_or_else(|error| panic!("{error}"));
        sweep(&scene, "t", Part::WHOLE, None, &mut ()).unwrap()
    };
    let (compiled, text) = (runs("Mita()"), runs(ACTUATOR));
    let (compiled, text) = (&compiled.sweeps[0], &text.sweeps[0]);
    let column = |names: &[String], name: &str| names.iter().position(|known| known == name);
    let period = column(&compiled.run_columns, "periods")
        .unwrap_or_else(|| panic!("{:?}", compiled.run_columns));
    assert_eq!(compiled.run_columns[period], text.run_columns[period]);
    for (run, row) in &compiled.rows {
        let again = &text.rows[run];
        assert_eq!(row.values[period], again.values[period], "run {run}");
    }
}

/// All fields, guards and resets at a point are those of the compiled model to rounding.
#[test]
fn the_actuator_by_formulas() {
    let Model::Hybrid(text) = Model::read(&Source::new("actuator.ron", ACTUATOR), &[]).unwrap()
    else {
        panic!("a hybrid system")
    };
    let (p, t) = (Actuator::DEFAULTS, 0.7);
    assert_eq!(HybridSystem::defaults(&*text), p);
    assert_eq!(text.in_lanes(), Some(LaneWidth::widest()));
    for (mode, stated) in Actuator.modes().iter().enumerate() {
        let x: Vec<f64> = (0..stated.states.len()).map(|k| 0.31 + 0.17 * k as f64).collect();
        let [mut f, mut g] = [x.clone(), x.clone()];
        HybridSystem::field(&Actuator, mode, t, &x, &p, &mut f);
        HybridSystem::field(&*text, mode, t, &x, &p, &mut g);
        f.iter().zip(&g).for_each(|(f, g)| close(*f, *g, 1e-13));
        for (guard, stated) in
            text.guards().iter().enumerate().filter(|(_, g)| g.modes.contains(&mode))
        {
            let own =
                Actuator.guards().iter().position(|own| own.name == stated.name).expect("a guard");
            close(text.guard(guard, mode, t, &x, &p), Actuator.guard(own, mode, t, &x, &p), 1e-13);
            let next = Actuator.next_mode(own, mode, t, &x, &p);
            assert_eq!(text.next_mode(guard, mode, t, &x, &p), next, "{} in {mode}", stated.name);
            let mut after = vec![0.0; Actuator.modes()[next].states.len()];
            let mut again = after.clone();
            Actuator.reset(own, (mode, next), t, &x, &p, &mut after);
            text.reset(guard, (mode, next), t, &x, &p, &mut again);
            // The displacement at contact is that of the stopper, where motion is at the event.
            after.iter().zip(&again).skip(1).for_each(|(a, b)| close(*a, *b, 1e-13));
        }
    }
}

#[test]
fn fields_by_formulas() {
    fn field(text: &str, given: &[&str], x: &[f64], p: &[f64]) -> Vec<f64> {
        let given: Vec<String> = given.iter().map(|name| name.to_string()).collect();
        let Ok(Model::Field(field)) = Model::read(&Source::new("", text), &given) else { panic!() };
        let mut f = vec![0.0; x.len()];
        field.field(0.0, x, p, &mut f);
        f
    }
    let mut f = [0.0; 3];
    Lure.field(0.0, &[0.3, -0.2, 0.9], &[0.7, 1.1], &mut f);
    assert_eq!(field(LURE, &["alpha", "beta"], &[0.3, -0.2, 0.9], &[0.7, 1.1]), f);
    Isothermal.field(0.0, &[13.0, 20.0, 6.0], &[12.0], &mut f);
    for (found, expected) in
        field(ISOTHERMAL, &["lambda"], &[13.0, 20.0, 6.0], &[12.0]).iter().zip(f)
    {
        close(*found, expected, 1e-12);
    }
    let Ok(Model::Hybrid(text)) = Model::read(&Source::new("", IMPACT_OSCILLATOR), &[]) else {
        panic!("a hybrid system")
    };
    let (x, p) = ([0.3, 1.5], ImpactOscillator::DEFAULTS);
    let [mut f, mut g] = [[0.0; 2]; 2];
    HybridSystem::field(&ImpactOscillator, ImpactOscillator::FLIGHT, 0.4, &x, &p, &mut f);
    HybridSystem::field(&*text, 0, 0.4, &x, &p, &mut g);
    f.iter().zip(g).for_each(|(f, g)| close(*f, g, 1e-15));
}
