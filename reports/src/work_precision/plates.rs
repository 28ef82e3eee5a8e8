//! Work-precision diagram of the pull-in of a plate, by plate model and number of shape functions.

use super::plan::{Method, Plan};
use super::scenes::{Counted, Sought, number_of, tracing};
use tangency::core::system::Kind;

/// A scene of a simply supported square plate with a gap of twice its thickness, traced through
/// pull-in; special points are not refined.
pub(super) const PLATE: &str = r#"Scene(
    title: "A supported plate",
    problem: Plate(supports: "SSSS", in_plane: slide),
    parameters: [("gap_ratio", 2.0), ("aspect", 1.0), ("nu", 0.3)],
    settings: (refinement: 0.0),
    runs: [(name: "plate", along: [(name: "load", low: 0.0)], bounds: [(name: "max_deflection", high: 0.85)])],
)"#;

/// The pull-in load.
pub(super) const PULL_IN: &[Sought] = &[Sought { branch: "plate", kind: Kind::LP, column: "load" }];

fn plate(line: &str, setting: String, settings: &[(&str, &str)]) -> Method {
    tracing((line, setting), PLATE, settings, PULL_IN, Counted::Unknowns)
}

/// Returns the settings of the full plate model with given numbers of transverse and in-plane shape
/// functions in each direction.
fn ritz(line: &str, transverse: usize, in_plane: usize) -> Method {
    let orders =
        format!("(transverse: ({transverse}, {transverse}), in_plane: ({in_plane}, {in_plane}))");
    plate(line, format!("{transverse} and {in_plane}"), &[("orders", &orders)])
}

fn reference() -> Method {
    let line = "the full model with 14 transverse and 20 in-plane functions";
    plate(line, String::new(), &[("orders", "(transverse: (14, 14), in_plane: (20, 20))")])
}

/// Plans the diagram that compares the models of the plate.
pub(super) fn models() -> Vec<Plan> {
    let mut methods = Vec::new();
    for (line, model, projection) in [
        ("sine, multiplied", "sine", "multiplied"),
        ("sine, direct", "sine", "direct"),
        ("modal, multiplied", "modal", "multiplied"),
        ("modal, direct", "modal", "direct"),
    ] {
        for modes in [1, 2, 4, 8, 15] {
            let count = modes.to_string();
            let settings = [("model", model), ("projection", projection), ("modes", &count)];
            methods.push(plate(line, number_of(modes, "mode"), &settings));
        }
    }
    let orders = [(2, 3), (3, 4), (4, 6), (6, 8), (8, 11), (11, 15)];
    methods.extend(orders.map(|(transverse, in_plane)| ritz("full model", transverse, in_plane)));
    for order in [2, 4, 8] {
        let orders = format!("(transverse: ({order}, {order}), in_plane: (2, 2))");
        let settings = [("theory", "linear"), ("orders", &orders)];
        methods.push(plate("linear theory", order.to_string(), &settings));
    }
    let plan = Plan::of("Pull-in load of a supported plate, α₁ = 2", reference());
    let plan = plan.counting("unknowns").marked().relative().with(methods);
    vec![plan.recommending("full model", "6 and 8")]
}

/// Plans the diagram of the numbers of transverse and in-plane shape functions of the plate.
pub(super) fn orders() -> Vec<Plan> {
    let over = |in_plane| {
        let line = format!("in-plane order {in_plane}");
        [2, 3, 4, 5, 6, 8, 10].map(|transverse| ritz(&line, transverse, in_plane))
    };
    let methods = [2, 3, 4, 6, 8, 11].into_iter().flat_map(over);
    let plan = Plan::of("Pull-in load for each transverse and in-plane order", reference());
    let plan = plan.counting("unknowns").relative().with(methods);
    vec![plan.recommending("in-plane order 8", "6 and 8")]
}
