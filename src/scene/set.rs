//! Parsing of a scene, and changes of its values by name.

use super::by_name::{assign, settings};
use super::catalogue::Catalogue;
use super::error::SceneError;
use super::foreign;
use super::notation::options;
use super::statement::{Run, Scene, Sweep};
use crate::core::continuation::Settings;
use crate::core::problem::UnknownName;
use crate::core::sweep::Order;
use crate::language::number;
use ron::ser::PrettyConfig;
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

/// Sets one setting of a sweep by name; returns false if the name is unknown.
fn assign_to_sweep(sweep: &mut Sweep, name: &str, value: &str) -> Result<bool, SceneError> {
    if !settings_of(sweep).any(|known| known == name) {
        return Ok(false);
    }
    match &mut sweep.over[..] {
        [first, ..] if name == COUNT => assign(first, name, value),
        _ if OF_SEARCHES.contains(&name) => assign(&mut sweep.search, name, value),
        _ => assign(sweep, name, value),
    }
}

impl Scene {
    /// Parses a scene whose problem is [built in](Catalogue::built_in).
    ///
    /// # Errors
    /// As [`Catalogue::parse`].
    ///
    /// ```
    /// use tangency::scene::Scene;
    /// let error = Scene::parse("Scene(title: \"t\", problem: Plate(), runs: [], colour: 3)");
    /// assert!(error.unwrap_err().to_string().contains("`colour`"));
    /// ```
    pub fn parse(text: &str) -> Result<Scene, SceneError> {
        Catalogue::built_in().parse(text)
    }

    /// Returns the scene as the text of a file that [`Catalogue::parse`] can read; the text
    /// contains all settings of the problem, but other values only if they differ from their
    /// defaults.
    ///
    /// ```
    /// use tangency::scene::Scene;
    /// let text = "Scene(title: \"t\", problem: Equations(states: [(\"x\", \"a - x^2\")]), parameters: [(\"a\", 1)],
    ///     runs: [Run(name: \"r\", along: [(name: \"a\", low: 0, high: 1)])])";
    /// let scene = Scene::parse(text)?;
    /// assert_eq!(Scene::parse(&scene.to_ron())?, scene);
    /// # Ok::<(), tangency::scene::SceneError>(())
    /// ```
    pub fn to_ron(&self) -> String {
        let pretty = PrettyConfig::new().struct_names(true).depth_limit(3);
        // Scenes are plain lists, numbers and names, so serialization cannot fail.
        self.readable(options().to_string_pretty(self, pretty).unwrap_or_default())
    }

    /// Returns the scene as one line of text that contains all values and identifies the results of
    /// the scene.
    pub fn in_words(&self) -> String {
        self.readable(options().to_string(self).unwrap_or_default())
    }

    /// Converts the problem in a serialized scene to the notation of scenes.
    fn readable(&self, text: String) -> String {
        let (name, written) = (self.problem.name(), self.problem.written());
        text.replacen(&format!("{name}({written})"), &format!("{name}{written}"), 1)
    }

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
        for (name, value) in self.choices_first(values) {
            self.refuse_varied(name)?;
            // The accuracy applies to the whole scene: runs do not set it.
            let mut of_scene = OfScene { accuracy: changed.accuracy };
            if assign(&mut of_scene, name, value)? {
                changed.accuracy = of_scene.accuracy;
            } else {
                changed.assign_or_leave_to_runs(name, value)?;
            }
        }
        // The runs of a scene under construction are checked once they exist.
        if changed.runs.is_empty() && changed.sweeps.is_empty() {
            changed.check_settings()?;
            changed.check_accuracy()?;
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

    /// Returns an error if a run of the scene sets the value that should be changed.
    fn refuse_varied(&self, name: &str) -> Result<(), SceneError> {
        for run in &self.runs {
            if let Some((_, own)) = run.set.iter().find(|(key, _)| key == name) {
                let (name, run, value) = (name.into(), run.name.clone(), own.clone());
                return Err(SceneError::Varied { name, run, value });
            }
        }
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
        for (name, value) in self.choices_first(set) {
            scene.assign(name, value)?;
        }
        scene.check_settings()?;
        scene.check_parameters()?;
        Ok(scene)
    }

    /// Sorts changed values so that the selection of a method precedes the settings of this method.
    fn choices_first<'a>(&self, values: &'a [(String, String)]) -> Vec<&'a (String, String)> {
        let mut values: Vec<&(String, String)> = values.iter().collect();
        values.sort_by_key(|(name, _)| !self.problem.model().chooses(name));
        values
    }

    /// Changes one value. If a setting applies only to the methods of some runs, the setting is
    /// changed in these runs only.
    fn assign_or_leave_to_runs(&mut self, name: &str, value: &str) -> Result<(), SceneError> {
        let Err(refused) = self.assign(name, value) else { return Ok(()) };
        if !matches!(refused, SceneError::NoEffect { .. }) {
            return Err(refused);
        }
        let with = |run: &Run| [&run.set[..], &[(name.into(), value.into())]].concat();
        let takes: Vec<bool> = self.runs.iter().map(|run| self.with(&with(run)).is_ok()).collect();
        for (run, _) in self.runs.iter_mut().zip(&takes).filter(|(_, takes)| **takes) {
            run.set = with(run);
        }
        if takes.contains(&true) { Ok(()) } else { Err(refused) }
    }

    /// Changes one value.
    fn assign(&mut self, name: &str, value: &str) -> Result<(), SceneError> {
        // Runs and sweeps may have settings with the same name.
        let known = self.problem.set(name, value)?
            | self.assign_to_continuation(name, value)?
            | self.assign_to_sweeps(name, value)?;
        if known { Ok(()) } else { self.assign_parameter(name, value) }
    }

    /// Changes a setting of the continuation; returns false if the name is unknown.
    fn assign_to_continuation(&mut self, name: &str, value: &str) -> Result<bool, SceneError> {
        let mut read = self.settings.clone();
        let known = assign(&mut read, name, value)?;
        let Settings { keep_solutions, draft, cancel, .. } = self.settings.clone();
        self.settings = Settings { keep_solutions, draft, cancel, ..read };
        Ok(known)
    }

    /// Changes a setting of the runs in all sweeps; returns false if the name is unknown.
    fn assign_to_sweeps(&mut self, name: &str, value: &str) -> Result<bool, SceneError> {
        let mut known = false;
        for sweep in &mut self.sweeps {
            known |= assign_to_sweep(sweep, name, value)?;
        }
        Ok(known)
    }

    fn assign_parameter(&mut self, name: &str, value: &str) -> Result<(), SceneError> {
        self.require_name(name)?;
        let read =
            |_| number(value).map_err(|error| SceneError::value(name, value, error.to_string()));
        let number: f64 = value.parse().or_else(read)?;
        if !number.is_finite() {
            let reason = "a parameter must be a finite number";
            return Err(SceneError::value(name, value, reason));
        }
        match self.parameters.iter_mut().find(|(key, _)| key == name) {
            Some((_, slot)) => *slot = number,
            None => self.parameters.push((name.into(), number)),
        }
        Ok(())
    }

    /// Returns an error if a name is neither a parameter nor a setting.
    fn require_name(&self, name: &str) -> Result<(), SceneError> {
        match self.problem.require_parameter(name) {
            Err(SceneError::UnknownName(_)) => {}
            known => return known,
        }
        let known = [self.problem.parameter_names(), self.setting_names()].concat();
        let unknown = UnknownName::new("parameter or setting", name, known);
        match foreign::remedy(name) {
            Some(remedy) => Err(SceneError::invalid(unknown.to_string()).with_help(remedy)),
            None => Err(unknown.into()),
        }
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
        let sets = |run: &&Run| run.set.iter().any(|(key, _)| key == name);
        self.runs.iter().find(sets).map(|run| run.name.as_str())
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
