//! Reading a scene, and changing it by name.

use super::catalogue::Catalogue;
use super::error::SceneError;
use super::slot::{Plain, Slots, Usual, assign, options, slots};
use super::statement::{Grid, Run, Scene, Start, Sweep};
use crate::core::attractor::AttractorSearch;
use crate::core::continuation::{SettingError, Settings};
use crate::core::problem::UnknownName;
use crate::core::sweep::Order;
use crate::core::system::Kind;
use crate::problems::text::number;
use ron::ser::PrettyConfig;

/// The setting that says which solutions of a field are traced.
pub(super) const SOLUTION: &str = "solution";

/// The settings of the continuation by name.
fn continuation_slots(settings: &mut Settings) -> Slots<'_> {
    slots!(settings => Settings {
        initial_step: Plain,
        min_step: Plain,
        max_step: Plain,
        max_points: Plain,
        max_angle: Plain,
        tolerance: Plain,
        event_tolerance: Plain,
        max_iterations: Plain,
        refinement: Plain,
        settle: Plain,
        target_mesh_error: Plain,
        max_mesh_error: Plain,
        max_period_growth: Plain,
        detect: Plain,
        stability: Plain,
        save_every: Plain,
        eigenvalues: Plain,
    } without keep_solutions, cancel)
}

/// The settings of a sweep by name.
fn sweep_slots(sweep: &mut Sweep) -> Slots<'_> {
    let Sweep { search, flow_error, over, order, strands, .. } = sweep;
    let mut slots = slots!(search => AttractorSearch {
        transient: Plain,
        recorded_periods: Plain,
        max_period: Plain,
        lyapunov_periods: Plain,
    } without tolerance, cancel);
    slots.push(("flow_error", Box::new(Plain(flow_error))));
    if let [Grid { count, .. }, ..] = &mut over[..] {
        slots.push(("count", Box::new(Plain(count))));
    }
    if *order != Order::Anew {
        slots.push(("strands", Box::new(Plain(strands))));
    }
    slots
}

/// The names of slots.
fn names(slots: Slots) -> impl Iterator<Item = String> {
    slots.into_iter().map(|(name, _)| name.to_string())
}

impl Scene {
    /// Reads a scene of a [built-in](Catalogue::built_in) problem.
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

    /// The scene as a file that [`Catalogue::parse`] reads: what differs from defaults, and all
    /// settings of its problem.
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
        // Scenes are plain lists, numbers and names: they can always be written.
        self.readable(options().to_string_pretty(self, pretty).unwrap_or_default())
    }

    /// The scene on one line, with all that was set: what results are known by.
    pub fn in_words(&self) -> String {
        self.readable(options().to_string(self).unwrap_or_default())
    }

    /// A text of the scene, its problem as scenes state it.
    fn readable(&self, text: String) -> String {
        let (name, written) = (self.problem.name(), self.problem.written());
        text.replacen(&format!("{name}({written})"), &format!("{name}{written}"), 1)
    }

    /// Changes a parameter, a setting of the problem or of the continuation, by name.
    ///
    /// # Errors
    /// [`SceneError::UnknownName`], with a suggestion; [`SceneError::Value`] if the value cannot be
    /// read; [`SceneError::Varied`] if the scene's runs set it by themselves.
    ///
    /// ```
    /// use tangency::scene::{BUILT_IN, Scene};
    /// let mut scene = Scene::parse(BUILT_IN[0].text)?;
    /// scene.set("gap_ratio", "2")?;
    /// assert_eq!(scene.value("gap_ratio"), Some(2.0));
    /// let error = scene.set("gap_ration", "2").unwrap_err();
    /// assert!(error.to_string().contains("did you mean `gap_ratio`"), "{error}");
    /// # Ok::<(), tangency::scene::SceneError>(())
    /// ```
    pub fn set(&mut self, name: &str, value: &str) -> Result<(), SceneError> {
        for run in &self.runs {
            if let Some((_, own)) = run.set.iter().find(|(key, _)| key == name) {
                let (name, run, value) = (name.into(), run.name.clone(), own.clone());
                return Err(SceneError::Varied { name, run, value });
            }
        }
        let mut changed = self.clone();
        // It is of the whole scene: what runs set goes without it.
        if !assign(changed.own_slots(), name, value)? {
            changed.assign(name, value)?;
        }
        // The runs of a scene that is being made are checked when they are there.
        if changed.runs.is_empty() && changed.sweeps.is_empty() {
            changed.check_accuracy()?;
        } else {
            changed.check()?;
        }
        *self = changed;
        Ok(())
    }

    /// Refuses settings that change nothing in any run.
    ///
    /// # Errors
    /// [`SceneError::NoEffect`] names the setting under which one has no effect.
    ///
    /// ```
    /// use tangency::scene::{BUILT_IN, Scene};
    /// let mut scene = Scene::parse(BUILT_IN.iter().find(|scene| scene.name == "bratu").expect("a scene").text)?;
    /// scene.set("segments", "4")?;
    /// let error = scene.check_effects(["segments"]).unwrap_err();
    /// assert!(error.to_string().starts_with("`segments` has no effect where `method` is `collocation`"));
    /// scene.set("method", "shooting")?;
    /// assert!(scene.check_effects(["segments"]).is_ok());
    /// # Ok::<(), tangency::scene::SceneError>(())
    /// ```
    pub fn check_effects<'a>(
        &self,
        set: impl IntoIterator<Item = &'a str>,
    ) -> Result<(), SceneError> {
        for name in set {
            let mut decided = None;
            for run in &self.runs {
                let seen = self.seen_by(run)?;
                decided = seen.problem.model().without_effect(name);
                if decided.is_none() {
                    break;
                }
            }
            if let Some((under, value)) = decided {
                return Err(SceneError::NoEffect { name: name.into(), under, value });
            }
        }
        Ok(())
    }

    /// The value of a parameter at the start.
    pub fn value(&self, parameter: &str) -> Option<f64> {
        let given = self.parameters.iter().cloned().map(|(name, value)| (name, Some(value)));
        let mut all = given.chain(self.problem.parameters());
        all.find(|(name, _)| name == parameter)?.1
    }

    /// All parameters at the start, in the problem's order.
    ///
    /// # Errors
    /// [`SceneError::MissingParameters`] if the problem states no defaults for some that the scene
    /// does not give.
    pub fn values(&self) -> Result<Vec<f64>, SceneError> {
        let names = self.problem.parameter_names();
        let (given, missing): (Vec<String>, Vec<String>) =
            names.into_iter().partition(|name| self.value(name).is_some());
        match missing.is_empty() {
            true => Ok(given.iter().filter_map(|name| self.value(name)).collect()),
            false => Err(SceneError::MissingParameters { problem: self.problem.name(), missing }),
        }
    }

    /// The scene with some values set, without runs and sweeps: as one of them sees it.
    pub(super) fn with(&self, set: &[(String, String)]) -> Result<Scene, SceneError> {
        let mut scene = Scene {
            title: self.title.clone(),
            problem: self.problem.clone(),
            model: self.model.clone(),
            parameters: self.parameters.clone(),
            accuracy: self.accuracy,
            settings: self.settings.clone(),
            plot: self.plot.clone(),
            runs: Vec::new(),
            sweeps: Vec::new(),
        };
        for (name, value) in set {
            scene.assign(name, value)?;
        }
        Ok(scene)
    }

    /// The scene with the settings of a run. A run from a Hopf point traces orbits, unless the run
    /// holds a condition or sets `solution`.
    pub(super) fn seen_by(&self, run: &Run) -> Result<Scene, SceneError> {
        let mut seen = self.with(&run.set)?;
        let at_hopf = matches!(run.start, Start::From { kind: Kind::HB, .. });
        let holds = run.hold.is_some() || run.hold_level.is_some();
        let says = run.set.iter().any(|(name, _)| name == SOLUTION);
        let has_both = seen.problem.settings().iter().any(|(name, _)| *name == SOLUTION);
        if at_hopf && has_both && !holds && !says {
            seen.assign(SOLUTION, "orbit")?;
        }
        Ok(seen)
    }

    /// Changes one value, or nothing at all.
    fn assign(&mut self, name: &str, value: &str) -> Result<(), SceneError> {
        let mut changed = self.clone();
        let out_of_range = |error: SettingError| SceneError::value(name, value, error.to_string());
        if changed.problem.set(name, value)? {
            changed.problem.model().check().map_err(out_of_range)?;
            changed.check_parameters()?;
        } else if assign(continuation_slots(&mut changed.settings), name, value)? {
            changed.settings.check().map_err(out_of_range)?;
        } else if !changed.assign_to_sweeps(name, value)? {
            changed.assign_parameter(name, value)?;
        }
        *self = changed;
        Ok(())
    }

    /// The settings that a scene states for all of its runs.
    fn own_slots(&mut self) -> Slots<'_> {
        vec![("accuracy", Box::new(Usual(&mut self.accuracy)))]
    }

    /// Changes how the runs of all sweeps are followed; false if nothing of this name says that.
    fn assign_to_sweeps(&mut self, name: &str, value: &str) -> Result<bool, SceneError> {
        let mut known = false;
        for sweep in &mut self.sweeps {
            known |= assign(sweep_slots(sweep), name, value)?;
        }
        Ok(known)
    }

    fn assign_parameter(&mut self, name: &str, value: &str) -> Result<(), SceneError> {
        self.require_parameter(name, true)?;
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

    /// Refuses a name that is no parameter of the problem.
    pub(super) fn require_parameter(
        &self,
        name: &str,
        with_settings: bool,
    ) -> Result<(), SceneError> {
        let mut known = self.problem.parameter_names();
        if known.iter().any(|known| known == name) {
            return Ok(());
        }
        if let Some(line) = self.problem.text().and_then(|text| text.line_of_definition(name)) {
            let rule = "only parameters can be set and varied: change it there, or move it to `parameters` (sizes of \
                        arrays must be definitions)";
            return Err(SceneError::invalid(
                format!("`{name}`"),
                format!("a definition ({line})"),
                rule,
            ));
        }
        if !with_settings {
            return Err(UnknownName::new("parameter", name, known).into());
        }
        let mut scene = self.clone();
        known.extend(self.problem.settings().into_iter().map(|(name, _)| name.to_string()));
        known.extend(names(continuation_slots(&mut scene.settings)));
        known.extend(
            scene.sweeps.first_mut().into_iter().flat_map(|sweep| names(sweep_slots(sweep))),
        );
        known.extend(names(scene.own_slots()));
        Err(UnknownName::new("parameter or setting", name, known).into())
    }

    /// Every parameter and setting by name, to be saved with the branches.
    pub(super) fn record(&self) -> Vec<(String, String)> {
        let mut record: Vec<(String, String)> =
            self.problem.settings().into_iter().map(|(k, v)| (k.into(), v)).collect();
        let names = self.problem.parameter_names().into_iter();
        record.extend(names.filter_map(|name| self.value(&name).map(|v| (name, v.to_string()))));
        record
    }
}
