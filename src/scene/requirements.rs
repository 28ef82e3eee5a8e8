//! Requirements that several parts of a scene must meet: numbers are finite, names are unique,
//! durations are positive, and local maps are consistent.

use super::error::SceneError;
use super::local::Local;
use super::problem::Problem;
use super::statement::Run;
use crate::core::problem::{UnknownName, position};
use crate::core::spelling::shown;
use std::collections::HashSet;

/// Returns an error if a value is infinite or not a number; the error message begins with `number`.
pub(super) fn require_finite(number: &str, value: f64) -> Result<(), SceneError> {
    if value.is_finite() {
        return Ok(());
    }
    Err(SceneError::invalid(format!("{number} is {value}, but must be a finite number"))
        .with_help("if a range has no bound at one end, omit that end"))
}

/// Returns an error if a list contains the same name twice; `what` states which things have these
/// names.
pub(super) fn require_unique<'a>(
    what: &str,
    names: impl IntoIterator<Item = &'a String>,
) -> Result<(), SceneError> {
    let mut seen = HashSet::new();
    match names.into_iter().find(|name| !seen.insert(*name)) {
        Some(name) => {
            let message =
                format!("the {what} `{}` is given twice, but may be given only once", shown(name));
            Err(SceneError::invalid(message))
        }
        None => Ok(()),
    }
}

/// Returns an error if, for the initial parameters, the period of the forcing or the length of the
/// interval is not positive.
pub(super) fn require_durations(problem: &Problem, p: &[f64]) -> Result<(), SceneError> {
    let refused = problem.text().and_then(|model| model.refused_duration(p));
    Ok(refused.map_or(Ok(()), Err)?)
}

/// Returns the run with a given name among the runs that precede another run.
pub(super) fn named<'a>(earlier: &'a [Run], name: &str) -> Result<&'a Run, UnknownName> {
    let names = earlier.iter().map(|run| &run.name);
    Ok(&earlier[position("earlier run", name, names)?])
}

/// Returns an error if the local map of a run or sweep is invalid, or if the run or sweep fixes or
/// varies a parameter that is not a parameter of the local map.
pub(super) fn require_map<'a>(
    local: &Local,
    place: &str,
    earlier: &[Run],
    mut parameters: impl Iterator<Item = &'a String>,
) -> Result<(), SceneError> {
    let place = format!("{place}, local");
    if named(earlier, &local.run)?.local.is_some() {
        let message = format!(
            "{place}: the run `{}` must trace orbits of the flow, but traces orbits of a local map",
            shown(&local.run)
        );
        let help = "name a run that traces orbits of the flow and contains a grazing";
        return Err(SceneError::invalid(message).with_help(help));
    }
    if local.parameters.is_empty() {
        return Err(SceneError::invalid(format!("{place} names no parameters of the map")));
    }
    match parameters.find(|name| !local.parameters.contains(name)) {
        Some(name) => {
            let (name, known) = (shown(name), local.parameters.join(", "));
            let message = format!(
                "{place}: `{name}` is not a parameter of the local map, whose parameters are \
                 {known}"
            );
            Err(SceneError::invalid(message))
        }
        None => Ok(()),
    }
}
