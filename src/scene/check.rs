//! Checks of the contents of a scene, for example that numbers are finite, names are unique and
//! runs are consistent.

use super::check_accuracy::check_accuracy;
use super::check_run::RunCheck;
use super::check_sweep::SweepCheck;
use super::error::SceneError;
use super::problem::Problem;
use super::reach::Ends;
use super::requirements::{require_durations, require_unique};
use super::statement::Scene;
use super::words::check_words;
use crate::core::continuation::Settings;
use crate::core::spelling::shown;
use std::collections::HashSet;

/// The maximum number of unused parameters that a warning lists.
const MOST_UNUSED: usize = 5;

/// Returns the warning about scales that were estimated from the motion; `None` if no scale was
/// estimated.
fn observed_scales(observed: &[(String, f64)]) -> Option<String> {
    let stated = observed.iter().map(|(name, size)| format!("(\"{name}\", \"{size:e}\")"));
    let stated = stated.collect::<Vec<_>>().join(", ");
    (!observed.is_empty()).then(|| {
        format!(
            "the equations state no scales, so tolerances use the sizes of the simulated motion; to \
             fix the scales, add `scales: [{stated}]` to the equations"
        )
    })
}

impl Scene {
    /// Returns an error if the scene is invalid.
    pub(super) fn check(&self) -> Result<(), SceneError> {
        check_words(self)?;
        if self.runs.is_empty() && self.sweeps.is_empty() {
            return Err(SceneError::invalid("the scene has neither runs nor sweeps"));
        }
        check_parameters(&self.problem, &self.parameters)?;
        require_durations(&self.problem, &self.values()?)?;
        check_unique_names(self)?;
        check_values(&self.parameters)?;
        check_settings(&self.problem, &self.settings)?;
        check_unambiguous(&self.problem.parameter_names(), &self.setting_names())?;
        check_periodic(self)?;
        if let Ok(motion) = self.problem.model().motion() {
            motion.check_measures()?;
        }
        let ends = Ends::of(&self.runs);
        for (index, run) in self.runs.iter().enumerate() {
            let resolved = self.resolved_among(run, &ends)?;
            RunCheck { scene: self, resolved, earlier: &self.runs[..index] }.check()?;
        }
        for sweep in &self.sweeps {
            SweepCheck { scene: self, resolved: self.resolved_sweep(sweep)? }.check()?;
        }
        check_accuracy(self)
    }

    /// Returns warnings about probable mistakes in equations given as text: unused parameters,
    /// guards with discontinuous functions, and parts of a file that have no effect.
    pub fn warnings(&self) -> Vec<String> {
        let unused = self.problem.text().map_or(&[][..], |model| model.unused());
        let more = unused.len().saturating_sub(MOST_UNUSED);
        let unused = unused.iter().take(MOST_UNUSED);
        let unused = unused.map(|name| format!("no formula uses the parameter `{name}`"));
        let more = (more > 0).then(|| format!("no formula uses {more} further parameters"));
        let notes = self.problem.notes().iter().cloned();
        let scales = observed_scales(self.problem.observed_scales());
        unused.chain(more).chain(self.problem.jumps()).chain(scales).chain(notes).collect()
    }
}

impl Problem {
    /// Returns the warnings about guards with discontinuous functions; these warnings are also
    /// saved with branches.
    pub(super) fn jumps(&self) -> impl Iterator<Item = String> + '_ {
        let jumping = self.text().map_or(Vec::new(), |model| model.jumping_guards());
        jumping.into_iter().map(|name| {
            format!(
                "the guard `{name}` is discontinuous: an event is located where a guard decreases \
                 continuously through zero, but is missed where a guard jumps away from zero, as \
                 in `1 - mod(t, 1)`; state events at given times with `at`, as in `at: \
                 \"n*period\"`"
            )
        })
    }
}

/// Returns an error if a scene gives a value to an unknown parameter.
pub(super) fn check_parameters(
    problem: &Problem,
    parameters: &[(String, f64)],
) -> Result<(), SceneError> {
    let known: HashSet<String> = problem.parameter_names().into_iter().collect();
    let mut unknown = parameters.iter().filter(|(name, _)| !known.contains(name));
    unknown.try_for_each(|(name, _)| problem.require_parameter(name))
}

/// Returns an error if a setting of the problem or of the continuation is outside its allowed
/// range.
pub(super) fn check_settings(problem: &Problem, settings: &Settings) -> Result<(), SceneError> {
    let sound = problem.model().check().and_then(|()| settings.check());
    sound.map_err(|error| SceneError::invalid(error.to_string()))
}

/// Returns an error if two parameters, runs, sweeps or labels of a scene have the same name.
fn check_unique_names(scene: &Scene) -> Result<(), SceneError> {
    require_unique("parameter", scene.parameters.iter().map(|(name, _)| name))?;
    require_unique("run", scene.runs.iter().map(|run| &run.name))?;
    require_unique("sweep", scene.sweeps.iter().map(|sweep| &sweep.name))?;
    require_unique("column of a label", scene.plot.labels.iter().map(|(column, _)| column))
}

/// Returns an error if the value of a parameter is infinite or not a number.
fn check_values(parameters: &[(String, f64)]) -> Result<(), SceneError> {
    match parameters.iter().find(|(_, value)| !value.is_finite()) {
        None => Ok(()),
        Some((name, value)) => {
            let name = shown(name);
            let message = format!("parameter `{name}` is {value}, but must be a finite number");
            Err(SceneError::invalid(message))
        }
    }
}

/// Returns an error if a parameter has the name of a setting, because the option `--set` would be
/// ambiguous.
fn check_unambiguous(parameters: &[String], settings: &[String]) -> Result<(), SceneError> {
    match parameters.iter().find(|name| settings.contains(name)) {
        None => Ok(()),
        Some(name) => {
            let name = shown(name);
            let message = format!("a parameter and a setting have the same name, `{name}`");
            Err(SceneError::invalid(message).with_help("rename the parameter"))
        }
    }
}

/// Returns an error if a scene has branches or sweeps of equations that contain the time but have
/// no period.
fn check_periodic(scene: &Scene) -> Result<(), SceneError> {
    let aperiodic = scene.problem.text().is_some_and(|model| model.is_aperiodic());
    let needs_period =
        !scene.sweeps.is_empty() || scene.runs.iter().any(|run| !run.along.is_empty());
    if !(aperiodic && needs_period) {
        return Ok(());
    }
    Err(SceneError::invalid(
        "the equations contain the time `t` but have no period, and branches need a period",
    )
    .with_help(
        "state the period of the forcing, as in `period: \"2*pi/w\"`; convert an .ode file with \
         `tangency import` first",
    ))
}
