//! Work-precision diagrams: the error of methods against their CPU time.
//!
//! A [`Plan`] consists of a problem, the reference method, and the methods that solve the problem,
//! each with several settings of growing effort. [`measure`] runs all methods of a plan: every
//! answer and every time comes from a run of the method, and every error is the distance of its
//! answer from the reference answer.

mod circumstances;
mod curve;
mod derivatives;
mod differences;
mod events;
mod flow;
mod fold;
mod large;
mod local_map;
mod models;
mod orbit;
mod period;
mod plan;
mod plates;
mod scaling;
mod scenes;

pub use plan::{Answer, Effort, Method, Plan, WorkPrecisionError};

use crate::report::entries;
use crate::{Entry, WorkPrecision};

/// An entry of the list of work-precision diagrams: a name, and the function that plans the
/// diagram.
pub type Diagram = Entry<fn() -> Vec<Plan>>;

/// All work-precision diagrams.
pub const DIAGRAMS: &[Diagram] = entries![
    "plate-models": "pull-in load of a plate by models of few modes, sines and polynomials", plates::models;
    "plate-orders": "pull-in load of a plate against the expansion orders of the deflection and the in-plane displacement", plates::orders;
    "flow": "integrators on three problems (stick phase, impacting period, stiff field), and the cost of derivatives", flow::plans;
    "orbit": "a fold, a period doubling and a grazing by shooting and by collocation", orbit::plans;
    "derivatives": "dual numbers and finite differences: derivatives of an orbit, multipliers, and a fold", derivatives::plans;
    "events": "a grazing by bisection, by the secant method, on a mesh, and by its defining system", events::plans;
    "local-map": "the local map near a grazing compared with the flow, for each order of the map", local_map::plans;
    "models": "equations given as text compared with compiled equations: orbits by collocation and shooting, and a sweep", models::plans;
    "scaling": "time against the numbers of unknowns, of intervals and segments, of parameters, and of threads", scaling::plans;
    "large": "dense and sparse matrices for each number of unknowns", large::plans;
    "curve": "the error of the curve through the points of a branch, against the number of points", curve::plans;
];

/// Measures the methods of a work-precision diagram.
///
/// ```
/// use tangency_reports::work_precision::{DIAGRAMS, Effort, measure};
/// let entry = DIAGRAMS.iter().find(|entry| entry.name == "derivatives").expect("a diagram");
/// let diagram = measure(entry, Effort::Quick)?;
/// // Derivatives of a period with an impact: dual numbers have all digits.
/// let point = diagram.panels[0].point("dual numbers", "").expect("a measurement");
/// assert!(point.error < 1e-10 && point.seconds > 0.0);
/// # Ok::<(), tangency_reports::work_precision::WorkPrecisionError>(())
/// ```
///
/// # Errors
/// [`WorkPrecisionError`] if the reference method of a plan fails.
pub fn measure(entry: &Diagram, effort: Effort) -> Result<WorkPrecision, WorkPrecisionError> {
    let panels = (entry.make)().into_iter().map(|plan| plan.measure(effort));
    Ok(WorkPrecision {
        name: format!("work-precision-{}", entry.name),
        panels: panels.collect::<Result<_, _>>()?,
        circumstances: circumstances::now(effort.runs()),
        ..WorkPrecision::default()
    })
}
