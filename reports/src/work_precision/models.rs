//! Work-precision diagrams of equations given as text, compared with compiled equations: the time
//! that evaluating formulas from text costs.

use super::plan::{Answer, Method, Plan};
use super::scenes::{Counted, Sought, scene, tracing};
use crate::Drawn;
use std::num::NonZeroUsize;
use tangency::core::failure::one_line;
use tangency::core::sweep::Part;
use tangency::core::system::Kind;
use tangency::scene::sweep;

/// A template of a scene, into which the text of the problem is inserted: orbits of the isothermal
/// reaction up to their first period doubling.
const ORBITS: &str = r#"Scene(
    title: "Isothermal reaction",
    problem: PROBLEM,
    parameters: [("lambda", 14.0)],
    settings: (refinement: 0.0, target_mesh_error: 1.0),
    runs: [
        (
            name: "equilibria",
            set: [("solution", "equilibrium")],
            start: Guess([("y1", 14.0), ("y2", 21.0), ("y3", 5.0)]),
            along: [(name: "lambda", low: 10.0, high: 14.0)],
        ),
        (name: "orbits", start: From(run: "equilibria", kind: HB), along: [(name: "lambda", low: 10.0, high: 14.0)]),
    ],
)"#;

const DOUBLING: &[Sought] = &[Sought { branch: "orbits", kind: Kind::PD, column: "lambda" }];

const REACTION: &str = r#"Equations(states: [
    ("y1", "y1*(30 - y1/4 - y2 - y3) + 0.001*y2^2 + 0.1"),
    ("y2", "y2*(y1 - 0.001*y2 - lambda) + 0.1"),
    ("y3", "y3*(16.5 - y1 - y3/2) + 0.1"),
])"#;

/// A template of a scene, into which the text of the problem is inserted: attractors of the impact
/// oscillator, which are orbits with one impact per period.
const SWEEP: &str = r#"Scene(
    title: "Impacts",
    problem: PROBLEM,
    parameters: [("frequency", 2.2)],
    sweeps: [(
        name: "amplitudes",
        over: [(name: "amplitude", low: 4.5, high: 6, count: 16)],
        search: (transient: 300, lyapunov_periods: 0),
    )],
)"#;

const OSCILLATOR: &str = r#"HybridEquations(
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

/// The answers that are compared: the period of an orbit in periods of the forcing, and the final
/// states of the runs of a sweep.
const ENDS: [&str; 3] = ["periods", "end_0", "end_1"];

/// The settings of a method, with a description of the settings.
type Setting = (Vec<(&'static str, &'static str)>, String);

fn orbits(title: &str, finest: Setting, settings: Vec<Setting>, counted: Counted) -> Plan {
    let method = |(line, problem): (&str, &str), (settings, name): Setting| {
        let text = ORBITS.replace("PROBLEM", problem);
        tracing((line, name), &text, &settings, DOUBLING, counted)
    };
    let lines = [("compiled", "Isothermal()"), ("text", REACTION)];
    let all =
        lines.into_iter().flat_map(|line| settings.iter().map(move |set| (line, set.clone())));
    let methods: Vec<Method> = all.map(|(line, set)| method(line, set)).collect();
    let unit = match counted {
        Counted::Unknowns => "unknowns",
        Counted::Evaluations => "evaluations of the field",
    };
    Plan::of(title, method(lines[0], finest)).counting(unit).relative().with(methods)
}

/// Plans the diagrams of a period doubling, computed by collocation and by shooting.
fn doublings() -> [Plan; 2] {
    let on = |intervals: &'static str| -> Setting {
        (
            vec![("method", "collocation"), ("intervals", intervals)],
            format!("{intervals} intervals"),
        )
    };
    let at = |tolerance: &'static str| -> Setting {
        (vec![("method", "shooting"), ("flow_tolerance", tolerance)], tolerance.into())
    };
    let meshes = ["20", "40", "80"].map(on).into();
    let tolerances = ["1e-6", "1e-8", "1e-10", "1e-12"].map(at).into();
    [
        orbits("A period doubling by collocation", on("160"), meshes, Counted::Unknowns),
        orbits("A period doubling by shooting", at("1e-14"), tolerances, Counted::Evaluations),
    ]
}

/// Plans the diagram of a sweep with impacts.
fn impacts() -> Plan {
    let method = |(line, problem): (&str, &str), flow_tolerance: &str| {
        let text = SWEEP.replace("PROBLEM", problem);
        let scene = scene(&text, &[("flow_tolerance", flow_tolerance)]);
        let part = Part { threads: NonZeroUsize::new(1), ..Part::WHOLE };
        Method::new(line, flow_tolerance, move || {
            let swept = sweep(scene.as_ref()?, "impacts", part, None, &mut ());
            let swept = swept.map_err(|cause| one_line(&cause))?;
            let table = &swept.sweeps[0];
            let column = |name: &str| table.run_columns.iter().position(|known| known == name);
            let columns: Vec<usize> = ENDS.iter().filter_map(|name| column(name)).collect();
            let rows = table.rows.values();
            let numbers = rows.flat_map(|row| columns.iter().map(|&k| row.values[k])).collect();
            Ok(Answer { numbers, work: 16.0 })
        })
    };
    let lines = [("compiled", "ImpactOscillator()"), ("text", OSCILLATOR)];
    let tolerances = ["1e-6", "1e-8", "1e-10"];
    let all = lines.into_iter().flat_map(|line| tolerances.map(|tolerance| (line, tolerance)));
    let methods: Vec<Method> = all.map(|(line, tolerance)| method(line, tolerance)).collect();
    let plan = Plan::of("A sweep with impacts", method(lines[0], "1e-12")).counting("runs");
    plan.drawing(Drawn::ErrorAgainstTime).with(methods)
}

/// Plans all diagrams of equations given as text: orbits by collocation, orbits by shooting, and a
/// sweep.
pub(super) fn plans() -> Vec<Plan> {
    let [collocation, shooting] = doublings();
    vec![collocation, shooting, impacts()]
}
