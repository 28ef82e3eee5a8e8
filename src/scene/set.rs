//! The values of a scene by name, and their changes.

use super::by_name::{assign, settings};
use super::check::{check_parameters, check_settings};
use super::check_accuracy::check_accuracy;
use super::error::SceneError;
use super::foreign;
use super::problem::Problem;
use super::statement::{Run, Scene, Sweep};
use crate::core::continuation::Settings;
use crate::core::problem::UnknownName;
use crate::core::sweep::Order;
use crate::language::number;
use serde::{Deserialize, Serialize};
use std::collections::HashMap;

/// The settings that a scene states once for all of its runs.
#[derive(Serialize, Deserialize)]
struct OfScene {
    accuracy: Option<f64>,
}

/// The names of the settings that control a sweep's search for attractors. The search for
/// attractors also has a setting named `tolerance`, but `--set tolerance` does not change it: this
/// option sets the tolerance of the continuation.
const OF_SEARCHES: [&str; 4] = ["transient", "recorded_periods", "max_period", "lyapunov_periods"];

/// The names of the settings of sweeps that do not belong to the search for attractors.
const OF_SWEEPS: [&str; 3] = ["flow_tolerance", COUNT, STRANDS];

/// The name of the setting that contains the number of values along the first axis of a sweep.
const COUNT: &str = "count";

/// The name of the setting that contains the number of strands: sequences of runs of a sweep in
/// which each run starts where the previous run ended.
const STRANDS: &str = "strands";

/// Returns a title without its parts, separated by commas, that state one of the given values of
/// parameters, as in `V = 0.2`.
fn without_values(title: &str, values: &[f64]) -> String {
    let states = |part: &&str| {
        let numbers = part.split("= ").skip(1).filter_map(|rest| {
            let end = rest.find(|letter: char| !"0123456789.-−e".contains(letter));
            rest[..end.unwrap_or(rest.len())].replace('−', "-").parse::<f64>().ok()
        });
        numbers.into_iter().any(|number| values.contains(&number))
    };
    title.split(", ").filter(|part| !states(part)).collect::<Vec<_>>().join(", ")
}

/// Returns whether a setting with this name belongs to sweeps.
pub(super) fn is_of_sweeps(name: &str) -> bool {
    OF_SEARCHES.contains(&name) || OF_SWEEPS.contains(&name)
}

/// Returns the names of the settings that a given sweep has.
fn settings_of(sweep: &Sweep) -> impl Iterator<Item = &'static str> {
    let has = |name: &&str| match *name {
        COUNT => !sweep.over.is_empty(),
        STRANDS => sweep.order != Order::Anew,
        _ => true,
    };
    OF_SEARCHES.into_iter().chain(OF_SWEEPS).filter(has)
}

/// A change of a scene: the name of a parameter or setting, and its new value as text.
#[derive(Clone, Copy)]
struct Change<'a> {
    name: &'a str,
    value: &'a str,
}

impl Change<'_> {
    /// Returns an error if one of the runs sets the value that should be changed.
    fn refuse_varied(self, runs: &[Run]) -> Result<(), SceneError> {
        match setting(self.name, runs) {
            None => Ok(()),
            Some((run, own)) => Err(SceneError::Varied {
                name: self.name.into(),
                run: run.name.clone(),
                value: own.into(),
            }),
        }
    }

    /// Changes a value of a scene. If a setting applies only to the methods of some runs, the
    /// setting is changed in these runs only.
    fn apply(self, scene: &mut Scene) -> Result<(), SceneError> {
        // The accuracy applies to the whole scene: runs do not set it.
        if self.apply_to_accuracy(&mut scene.accuracy)? {
            return Ok(());
        }
        let applied = self.apply_to_all_runs(scene);
        let refused = matches!(applied, Err(SceneError::NoEffect { .. }));
        if refused && self.apply_to_some_runs(scene) { Ok(()) } else { applied }
    }

    /// Changes the accuracy that a scene requests; returns false if the name is another one.
    fn apply_to_accuracy(self, accuracy: &mut Option<f64>) -> Result<bool, SceneError> {
        let mut of_scene = OfScene { accuracy: *accuracy };
        let known = assign(&mut of_scene, self.name, self.value)?;
        *accuracy = of_scene.accuracy;
        Ok(known)
    }

    /// Changes a setting in the runs to whose methods the setting applies; returns false if the
    /// setting applies to no run.
    fn apply_to_some_runs(self, scene: &mut Scene) -> bool {
        let with = |run: &Run| [&run.set[..], &[(self.name.into(), self.value.into())]].concat();
        let applies = |run: &Run| scene.with(&with(run)).is_ok();
        let applies: Vec<bool> = scene.runs.iter().map(applies).collect();
        for (run, _) in scene.runs.iter_mut().zip(&applies).filter(|(_, applies)| **applies) {
            run.set = with(run);
        }
        applies.contains(&true)
    }

    /// Changes a value that a scene states for all of its runs and sweeps.
    fn apply_to_all_runs(self, scene: &mut Scene) -> Result<(), SceneError> {
        // Runs and sweeps may have settings with the same name.
        let known = scene.problem.set(self.name, self.value)?
            | self.apply_to_continuation(&mut scene.settings)?
            | self.apply_to_sweeps(&mut scene.sweeps)?;
        if known { Ok(()) } else { self.apply_to_parameters(scene) }
    }

    /// Changes a setting of the continuation; returns false if the name is unknown.
    fn apply_to_continuation(self, settings: &mut Settings) -> Result<bool, SceneError> {
        let mut read = settings.clone();
        let known = assign(&mut read, self.name, self.value)?;
        let Settings { keep_solutions, draft, cancel, .. } = settings.clone();
        *settings = Settings { keep_solutions, draft, cancel, ..read };
        Ok(known)
    }

    /// Changes a setting of the runs in all sweeps; returns false if the name is unknown.
    fn apply_to_sweeps(self, sweeps: &mut [Sweep]) -> Result<bool, SceneError> {
        let mut known = false;
        for sweep in sweeps {
            known |= self.apply_to_sweep(sweep)?;
        }
        Ok(known)
    }

    /// Changes a setting of the runs in a sweep; returns false if the name is unknown.
    fn apply_to_sweep(self, sweep: &mut Sweep) -> Result<bool, SceneError> {
        let Change { name, value } = self;
        if !settings_of(sweep).any(|known| known == name) {
            return Ok(false);
        }
        match &mut sweep.over[..] {
            [first, ..] if name == COUNT => assign(first, name, value),
            _ if OF_SEARCHES.contains(&name) => assign(&mut sweep.search, name, value),
            _ => assign(sweep, name, value),
        }
    }

    /// Changes the initial value of a parameter.
    fn apply_to_parameters(self, scene: &mut Scene) -> Result<(), SceneError> {
        let Change { name, value } = self;
        require_name(name, scene)?;
        let read =
            |_| number(value).map_err(|error| SceneError::value(name, value, error.to_string()));
        let number: f64 = value.parse().or_else(read)?;
        if !number.is_finite() {
            let reason = "a parameter must be a finite number";
            return Err(SceneError::value(name, value, reason));
        }
        match scene.parameters.iter_mut().find(|(key, _)| key == name) {
            Some((_, slot)) => *slot = number,
            None => scene.parameters.push((name.into(), number)),
        }
        Ok(())
    }
}

/// Returns the changes of some values, sorted so that the selection of a method precedes the
/// settings of this method.
fn choices_first<'a>(values: &'a [(String, String)], problem: &Problem) -> Vec<Change<'a>> {
    let changes = values.iter().map(|(name, value)| Change { name, value });
    let mut changes: Vec<Change> = changes.collect();
    changes.sort_by_key(|change| !problem.model().chooses(change.name));
    changes
}

/// Returns the first run that sets a parameter or setting, and the value in this run.
fn setting<'a>(name: &str, runs: &'a [Run]) -> Option<(&'a Run, &'a str)> {
    runs.iter().find_map(|run| {
        let (_, value) = run.set.iter().find(|(key, _)| key == name)?;
        Some((run, value.as_str()))
    })
}

/// Returns an error if a name is neither a parameter nor a setting of a scene.
fn require_name(name: &str, scene: &Scene) -> Result<(), SceneError> {
    match scene.problem.require_parameter(name) {
        Err(SceneError::UnknownName(_)) => {}
        known => return known,
    }
    let known = [scene.problem.parameter_names(), scene.setting_names()].concat();
    let unknown = UnknownName::new("parameter or setting", name, known);
    match foreign::remedy(name) {
        Some(remedy) => Err(SceneError::invalid(unknown.to_string()).with_help(remedy)),
        None => Err(unknown.into()),
    }
}

impl Scene {
    /// Changes the value of a parameter, of a setting of the problem, or of a setting of the
    /// continuation; the value is selected by name.
    ///
    /// # Errors
    /// [`SceneError::UnknownName`] with a suggestion if the name is unknown; [`SceneError::Value`]
    /// if the value cannot be parsed; [`SceneError::Varied`] if a run of the scene sets the
    /// parameter or setting.
    ///
    /// ```
    /// use tangency::scene::{BUILT_IN, Scene};
    /// let mut scene = Scene::parse(BUILT_IN.iter().find(|scene| scene.name == "plate-clamped").expect("a scene").text)?;
    /// scene.set("gap_ratio", "2")?;
    /// assert_eq!(scene.value("gap_ratio"), Some(2.0));
    /// let error = scene.set("gap_ration", "2").unwrap_err();
    /// assert!(format!("{error:?}").contains("did you mean `gap_ratio`"));
    /// # Ok::<(), tangency::scene::SceneError>(())
    /// ```
    pub fn set(&mut self, name: &str, value: &str) -> Result<(), SceneError> {
        self.set_all(&[(name.into(), value.into())])
    }

    /// Changes several values of the scene together. The title of the scene no longer states the
    /// values that were changed. If the ranges of several values depend on each other, as for
    /// `min_step` and `max_step`, the ranges are checked after all values have been changed.
    ///
    /// # Errors
    /// As [`set`](Self::set).
    pub fn set_all(&mut self, values: &[(String, String)]) -> Result<(), SceneError> {
        let mut changed = self.clone();
        for change in choices_first(values, &self.problem) {
            change.refuse_varied(&self.runs)?;
            change.apply(&mut changed)?;
        }
        changed.observe_scales(&[]);
        // The runs of a scene under construction are checked once they exist.
        if changed.runs.is_empty() && changed.sweeps.is_empty() {
            check_settings(&changed.problem, &changed.settings)?;
            check_accuracy(&changed)?;
        } else {
            changed.check()?;
        }
        let before = |(name, _): &(String, String)| {
            self.value(name).filter(|before| changed.value(name) != Some(*before))
        };
        let before: Vec<f64> = values.iter().filter_map(before).collect();
        changed.title = without_values(&changed.title, &before);
        *self = changed;
        Ok(())
    }

    /// Adds a remedy to the error of a run that failed at its start, if the request has changed the
    /// first value of the parameter that varies along the run.
    pub fn blame_on(&self, set: &[(String, String)], cause: SceneError) -> SceneError {
        let SceneError::Run { run, .. } = &cause else { return cause };
        let run = self.runs.iter().find(|own| own.name == *run);
        let varies = |name: &str| run.is_some_and(|run| run.along.iter().any(|it| it.name == name));
        let changed = set.iter().find(|(name, _)| varies(name)).cloned();
        match changed.filter(|_| cause.is_of_start(|_| false)) {
            Some((name, value)) => SceneError::Moved { name, value, cause: Box::new(cause) },
            None => cause,
        }
    }

    /// Returns the initial value of a parameter of the scene.
    pub fn value(&self, parameter: &str) -> Option<f64> {
        let given = self.parameters.iter().find(|(name, _)| name == parameter);
        let default = || self.problem.parameters().into_iter().find(|(name, _)| name == parameter);
        given.map(|(_, value)| *value).or_else(|| default()?.1)
    }

    /// Returns the initial values of all parameters, in the order of the problem's parameters.
    ///
    /// # Errors
    /// [`SceneError::MissingParameters`] if some parameters have neither a default nor a value in
    /// the scene.
    pub fn values(&self) -> Result<Vec<f64>, SceneError> {
        // For a parameter given twice, the first value counts.
        let given = self.parameters.iter().rev().map(|(name, value)| (name.as_str(), *value));
        let given: HashMap<&str, f64> = given.collect();
        let (mut values, mut missing) = (Vec::new(), Vec::new());
        for (name, default) in self.problem.parameters() {
            match given.get(name.as_str()).copied().or(default) {
                Some(value) => values.push(value),
                None => missing.push(name),
            }
        }
        match missing.is_empty() {
            true => Ok(values),
            false => Err(SceneError::MissingParameters { problem: self.problem.name(), missing }),
        }
    }

    /// Gives the problem scales that are estimated from its motion, if the equations state none and
    /// every parameter has a value. The motion starts in the given states; states that are not given
    /// have the values of the first run.
    pub(super) fn observe_scales(&mut self, start: &[(String, f64)]) {
        if let (Ok(p), Ok(initial)) = (self.values(), self.initial_states()) {
            self.problem.observe_scales(&[start, &initial].concat(), &p);
        }
    }

    /// Returns a copy of the scene with some values changed and without its runs and sweeps; a
    /// single run or sweep is then resolved in this copy.
    pub(super) fn with(&self, set: &[(String, String)]) -> Result<Scene, SceneError> {
        let mut scene = Scene {
            title: self.title.clone(),
            summary: None,
            problem: self.problem.clone(),
            model: self.model.clone(),
            parameters: self.parameters.clone(),
            accuracy: self.accuracy,
            settings: self.settings.clone(),
            plot: self.plot.clone(),
            runs: Vec::new(),
            sweeps: Vec::new(),
        };
        for change in choices_first(set, &self.problem) {
            change.apply_to_all_runs(&mut scene)?;
        }
        check_settings(&scene.problem, &scene.settings)?;
        check_parameters(&scene.problem, &scene.parameters)?;
        Ok(scene)
    }

    /// Returns the names of all settings, including settings of methods that are not selected.
    pub fn setting_names(&self) -> Vec<String> {
        let names = |settings: Vec<(String, String)>| settings.into_iter().map(|(name, _)| name);
        let mut known = self.problem.model().setting_names();
        known.extend(names(settings(&self.settings)));
        known.extend(self.sweeps.iter().take(1).flat_map(settings_of).map(String::from));
        known.extend(names(settings(&OfScene { accuracy: self.accuracy })));
        known
    }

    /// Returns the names and values of the settings of the problem and of the continuation.
    ///
    /// ```
    /// use tangency::scene::{BUILT_IN, Scene};
    /// let mut scene = Scene::parse(BUILT_IN.iter().find(|it| it.name == "bratu").expect("a scene").text)?;
    /// scene.set("max_step", "0.1")?;
    /// assert!(scene.settings_by_name().contains(&("max_step".into(), "0.1".into())));
    /// # Ok::<(), tangency::scene::SceneError>(())
    /// ```
    pub fn settings_by_name(&self) -> Vec<(String, String)> {
        [self.problem.settings(), settings(&self.settings)].concat()
    }

    /// Returns the run that sets a parameter or setting; the method [`set`](Self::set) refuses to
    /// change the value for this reason.
    pub fn run_that_sets(&self, name: &str) -> Option<&str> {
        setting(name, &self.runs).map(|(run, _)| run.name.as_str())
    }

    /// Returns the names and values of all parameters and settings, which are saved together with
    /// the branches.
    pub(crate) fn record(&self) -> Vec<(String, String)> {
        let mut record = self.problem.settings();
        let values = self.values().unwrap_or_default();
        let names = self.problem.parameter_names().into_iter();
        record.extend(names.zip(values).map(|(name, value)| (name, value.to_string())));
        record
    }
}
