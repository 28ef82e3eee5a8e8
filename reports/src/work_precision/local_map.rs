//! Work-precision diagram of local maps near grazing: the folds of local maps of several orders
//! near a degenerate grazing point are compared with the folds of the flow.

use super::plan::{Answer, Method, Plan};
use super::scenes::{Sought, found, scene};
use crate::Drawn;
use tangency::core::system::Kind;

/// A scene with orbits of the flow and with fixed points of the local map at the degenerate grazing
/// point.
const SCENE: &str = r#"Scene(
    title: "Flow and local map",
    problem: Mita(),
    parameters: [("voltage", 0.17), ("frequency", 0.5)],
    settings: (max_step: 0.02),
    runs: [
        (name: "P(0,1)", along: [(name: "voltage", low: 0.17, high: 0.2)]),
        (name: "P(1,1)", start: From(run: "P(0,1)", kind: G, switch: true), along: [(name: "voltage", low: 0.17, high: 0.2)]),
        (
            name: "births",
            start: From(run: "P(0,1)", kind: G, switch: true),
            hold: G,
            along: [(name: "voltage", low: 0.17, high: 0.2), (name: "frequency", low: 0.48, high: 0.5)],
        ),
        (
            name: "P(0,1) by the local map",
            local: (run: "births", kind: GD, parameters: ["voltage", "frequency"]),
            along: [(name: "voltage", low: 0.17, high: 0.2)],
        ),
        (
            name: "P(1,1) by the local map",
            local: (run: "births", kind: GD, parameters: ["voltage", "frequency"]),
            start: From(run: "P(0,1) by the local map", kind: G, switch: true),
            along: [(name: "voltage", low: 0.17, high: 0.2)],
        ),
    ],
)"#;

/// The forcing frequency at the degenerate grazing point.
const DEGENERATE: f64 = 0.487808700;

/// A fold of the flow, and the corresponding fold of the local map.
const FOLDS: [Sought; 2] = [
    Sought { branch: "P(1,1)", kind: Kind::LP, column: "voltage" },
    Sought { branch: "P(1,1) by the local map", kind: Kind::LP, column: "voltage" },
];

/// Compares the folds of flow and map at a given distance in frequency from the degenerate grazing
/// point.
fn apart(order: usize, distance: f64) -> Method {
    let (order, frequency) = (order.to_string(), (DEGENERATE + distance).to_string());
    let settings = [("order", &*order), ("frequency", &*frequency)];
    let (scene, line) = (scene(SCENE, &settings), format!("order {order}"));
    Method::new(line, format!("Δω = {distance:e}"), move || {
        let numbers = found(scene.as_ref()?, &FOLDS)?.numbers;
        Ok(Answer { numbers: vec![numbers[1] - numbers[0]], work: distance })
    })
}

/// Plans the diagram of the error of the local map against the distance from the degenerate grazing
/// point.
pub(super) fn plans() -> Vec<Plan> {
    let distances = || (0..6).rev().map(|halvings| 4e-3 * 0.5_f64.powi(halvings));
    let of = |order| distances().map(move |distance| apart(order, distance));
    let methods = (2..=5).flat_map(of);
    let flow =
        Method::new("the flow by shooting", "", || Ok(Answer { numbers: vec![0.0], work: 0.0 }));
    let plan = Plan::of("Voltage of a fold by the local map of the degenerate point", flow);
    vec![plan.counting("distance in frequency").drawing(Drawn::ErrorAgainstWork).with(methods)]
}
