//! Checks of the accuracy that a scene requests.

use super::error::SceneError;
use super::ladder::{ACCURACY, Ladder};
use super::problem::Problem;
use super::statement::{Run, Scene};
use std::ops::RangeInclusive;

/// The range of accuracies that a scene can request.
const RANGE: RangeInclusive<f64> = 1e-12..=0.1;

/// Returns an error if the requested accuracy is out of range, or if the scene also states a
/// setting that the accuracy would choose.
pub(super) fn check_accuracy(scene: &Scene) -> Result<(), SceneError> {
    let Some(accuracy) = scene.accuracy else { return Ok(()) };
    if !RANGE.contains(&accuracy) {
        let message = format!("`accuracy` is {accuracy}, but must be between 1e-12 and 0.1");
        return Err(SceneError::invalid(message));
    }
    let chosen = Ladder::of_scene(scene)?.varied();
    if let Some(name) = stated(&scene.problem)?.iter().find(|name| chosen.contains(name)) {
        return Err(decided(name, ""));
    }
    scene.runs.iter().try_for_each(|run| check_run(scene, run, &chosen))
}

/// Returns the names of the settings of a problem that differ from the defaults of the selected
/// methods.
fn stated(problem: &Problem) -> Result<Vec<String>, SceneError> {
    let (own, mut defaults) = (problem.settings(), problem.with_defaults());
    for (name, value) in own.iter().filter(|(name, _)| problem.model().chooses(name)) {
        defaults.set(name, value)?;
    }
    let pairs = own.into_iter().zip(defaults.settings());
    Ok(pairs.filter(|(own, default)| own != default).map(|((name, _), _)| name).collect())
}

/// Returns an error if a run has its own discretisation, although the scene requests an accuracy
/// that chooses the given settings.
fn check_run(scene: &Scene, run: &Run, chosen: &[String]) -> Result<(), SceneError> {
    let decides = |name: &String| chosen.contains(name) || name == "refinement";
    if let Some((name, _)) = run.set.iter().find(|(name, _)| decides(name)) {
        return Err(decided(name, &format!(" by the run `{}`", run.name)));
    }
    if run.local.is_some() {
        let reason = format!(
            "on the run `{}`, because the distance from the grazing determines the error of a \
             local map",
            run.name
        );
        return Err(SceneError::idle(ACCURACY, reason));
    }
    let own = Ladder::of_run(&scene.resolved(run)?)?.varied();
    match own.iter().find(|name| !chosen.contains(name)) {
        Some(name) => Err(SceneError::invalid(format!(
            "`accuracy` chooses one discretisation for all runs, but the discretisation of the run \
             `{}` has its own setting `{name}`",
            run.name
        ))),
        None => Ok(()),
    }
}

/// Returns the error for an accuracy that is stated together with a setting that the accuracy would
/// choose.
fn decided(name: &str, by: &str) -> SceneError {
    let message =
        format!("`accuracy` chooses the setting `{name}`, but `{name}` is also stated{by}");
    SceneError::invalid(message).with_help(format!("omit `accuracy` or `{name}`"))
}
