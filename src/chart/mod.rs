//! What methods cost and what they buy: charts of error against time, measured by one command.
//!
//! A [`Plan`] states a problem, what its answer is compared with, and the methods that solve it, each with settings of growing effort.
//! [`measure`] carries plans out: every answer and every time comes from running the method there and then, and the reference from the method
//! that is stated for it. Nothing here computes what the core does not; nothing is known but the problems.

mod circumstances;
mod derivatives;
mod differences;
mod events;
mod flow;
mod fold;
mod local_map;
mod orbit;
mod period;
mod plan;
mod plates;
mod scaling;
mod scenes;

pub use plan::{Answer, ChartError, Effort, Method, Plan};

use crate::output::Chart;

/// A chart by its name.
#[derive(Clone, Copy)]
pub struct Entry {
    /// The name.
    pub name: &'static str,
    /// What it shows, in a line.
    pub shows: &'static str,
    plans: fn() -> Result<Vec<Plan>, ChartError>,
}

/// All charts.
pub const CHARTS: &[Entry] = &[
    Entry {
        name: "plate-models",
        shows: "pull-in load of a plate by models of few modes, sines and polynomials",
        plans: plates::models,
    },
    Entry {
        name: "plate-orders",
        shows: "pull-in load of a plate by orders of deflection and in-plane displacement",
        plans: plates::orders,
    },
    Entry {
        name: "flow",
        shows: "integrators on the stick, an impacting period and a stiff field; derivatives",
        plans: flow::plans,
    },
    Entry {
        name: "orbit",
        shows: "a fold, a period doubling and a grazing by shooting and by collocation",
        plans: orbit::plans,
    },
    Entry {
        name: "derivatives",
        shows: "dual numbers and finite differences: derivatives of an orbit, multipliers, and a fold",
        plans: derivatives::plans,
    },
    Entry {
        name: "events",
        shows: "a grazing by bisection, by the secant method, on a mesh, and by its defining system",
        plans: events::plans,
    },
    Entry {
        name: "local-map",
        shows: "the local map near a grazing against the flow, by its order",
        plans: local_map::plans,
    },
    Entry {
        name: "scaling",
        shows: "time against unknowns, intervals and segments, parameters, and threads",
        plans: scaling::plans,
    },
];

/// Measures a chart.
///
/// ```
/// use tangency::chart::{CHARTS, Effort, measure};
/// let chart = measure(CHARTS.iter().find(|entry| entry.name == "plate-models").expect("a chart"), Effort::Quick)?;
/// // Fifteen sines, projected directly, are four digits of the pull-in load.
/// let point = chart.panels[0].point("sine, direct", "15 modes").expect("a measurement");
/// assert!(point.error < 1e-4 && point.seconds > 0.0);
/// # Ok::<(), tangency::chart::ChartError>(())
/// ```
///
/// # Errors
/// [`ChartError`] if there is nothing to compare with.
pub fn measure(entry: &Entry, effort: Effort) -> Result<Chart, ChartError> {
    let panels = (entry.plans)()?.into_iter().map(|plan| plan.measure(effort));
    Ok(Chart {
        name: format!("chart-{}", entry.name),
        panels: panels.collect::<Result<_, _>>()?,
        circumstances: circumstances::now(effort.runs()),
        ..Chart::default()
    })
}
