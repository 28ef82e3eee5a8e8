//! Partial differential equations with growing numbers of unknowns, by dense and by sparse matrices.

use super::plan::{Answer, Method, Plan};
use super::scenes::{Counted, Sought, tracing};
use crate::Drawn;
use tangency::core::system::Kind;

/// The folds of Bratu's problem in the continuum, in the plane and on a line: on a line from
/// `λ = 8 (c / cosh c)²` where `c tanh c = 1`.
const LIMITS: [f64; 2] = [6.808_124_423, 3.513_830_719_125_161];

/// The first branch to its fold.
const FOLD: &[Sought] = &[Sought { branch: "solutions", kind: Kind::LP, column: "lambda" }];

/// A scene of Bratu's problem with this unknown, equation, and boundary.
fn bratu(dimensions: usize, m: usize) -> String {
    let (unknown, rate, zero) = if dimensions == 2 {
        (
            "u[i=1..m, j=1..m]",
            "(u[i-1,j] + u[i+1,j] + u[i,j-1] + u[i,j+1] - 4*u[i,j])*(m+1)^2",
            "u[i=0..m+1, j=0..m+1]",
        )
    } else {
        ("u[i=1..m]", "(u[i-1] + u[i+1] - 2*u[i])*(m+1)^2", "u[i=0..m+1]")
    };
    let own = if dimensions == 2 { "u[i,j]" } else { "u[i]" };
    format!(
        r#"Scene(
    title: "Bratu's problem",
    problem: Residual(
        unknowns: [("{unknown}", "{rate} + lambda*exp({own})")],
        parameters: [("lambda", 0)], dynamics: flow,
        definitions: [("m", {m}), ("{zero}", 0)],
    ),
    settings: (eigenvalues: 4, detect: [LP], max_points: 12),
    runs: [(name: "solutions", along: [(name: "lambda", low: 0, high: 8)])],
)"#
    )
}

/// Time against unknowns, up to `dense` nodes in each direction by dense matrices.
fn unknowns(dimensions: usize, nodes: &[usize], dense: usize) -> Plan {
    let method = |line: &str, matrices: &str, m: usize| {
        let text = bratu(dimensions, m);
        let settings = [("matrices", matrices)];
        let setting = if dimensions == 2 { format!("{m} by {m}") } else { m.to_string() };
        tracing((line, setting), &text, &settings, FOLD, Counted::Unknowns)
    };
    let limit = LIMITS[2 - dimensions];
    let exact =
        Method::new("the continuum", "", move || Ok(Answer { numbers: vec![limit], work: 0.0 }));
    let title = ["Bratu's problem on a line", "Bratu's problem in the plane"][dimensions - 1];
    let of_dense = nodes.iter().filter(|m| **m <= dense);
    Plan::of(title, exact)
        .counting("unknowns")
        .relative()
        .drawing(Drawn::TimeAgainstWork)
        .with(of_dense.map(|m| method("dense", "dense", *m)))
        .with(nodes.iter().map(|m| method("sparse", "sparse", *m)))
}

/// A line and the plane.
pub(super) fn plans() -> Vec<Plan> {
    vec![
        unknowns(1, &[10, 20, 30, 40, 60, 80, 160, 320, 1000, 4000], 320),
        unknowns(2, &[3, 5, 7, 10, 14, 18, 32, 64], 18),
    ]
}
