//! How time grows with unknowns, intervals and segments.

use super::plan::{ChartError, Method, Plan};
use super::plates::{PLATE, PULL_IN};
use super::scenes::{Counted, GRAZING, PASSING, tracing};
use crate::output::Drawn;

/// Time against the unknowns of a plate.
fn unknowns() -> Result<Plan, ChartError> {
    let plate = |line: &str, order: usize| {
        let in_plane = order + 2;
        let orders =
            format!("(transverse: ({order}, {order}), in_plane: ({in_plane}, {in_plane}))");
        let setting = format!("{order} and {in_plane}");
        let settings = [
            ("supports", "CCCC"),
            ("in_plane", "immovable"),
            ("gap_ratio", "1"),
            ("orders", &*orders),
        ];
        tracing((line, setting), PLATE, &settings, PULL_IN, Counted::Unknowns)
    };
    let methods = [3, 4, 6, 8, 10].map(|order| plate("full model", order));
    let methods = methods.into_iter().collect::<Result<Vec<Method>, _>>()?;
    let plan = Plan::of("A clamped plate by orders", plate("the full model", 13)?);
    Ok(plan.counting("unknowns").relative().drawing(Drawn::TimeAgainstWork).with(methods))
}

/// Time against intervals of collocation and segments of shooting.
fn pieces() -> Result<Plan, ChartError> {
    let orbits = |line: String, pieces: usize, settings: &[(&str, &str)]| {
        let count = pieces.to_string();
        let pieces_of = if line == "shooting" { "segments" } else { "intervals" };
        let settings = [settings, &[(pieces_of, count.as_str())]].concat();
        let setting = match pieces {
            1 => pieces_of.trim_end_matches('s').to_string(),
            _ => pieces_of.to_string(),
        };
        let setting = format!("{pieces} {setting}");
        tracing((line.as_str(), setting), PASSING, &settings, GRAZING, Counted::Unknowns)
    };
    let mut methods = Vec::new();
    for degree in ["3", "5", "7"] {
        for intervals in [10, 20, 40, 80, 160] {
            let settings = [("method", "collocation"), ("degree", degree)];
            methods.push(orbits(format!("collocation, {degree} points"), intervals, &settings)?);
        }
    }
    for segments in [1, 2, 4, 8, 16, 32] {
        methods.push(orbits("shooting".into(), segments, &[])?);
    }
    let reference = orbits("shooting".into(), 1, &[("flow_tolerance", "1e-14")])?;
    let plan = Plan::of("Orbits by intervals and segments", reference).counting("unknowns");
    Ok(plan.drawing(Drawn::TimeAgainstWork).with(methods))
}

/// Plates, and orbits.
pub(super) fn plans() -> Result<Vec<Plan>, ChartError> {
    Ok(vec![unknowns()?, pieces()?])
}
