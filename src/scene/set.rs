//! Changing a scene by name, reading it, and checking it.

use super::slot::{Plain, Slots, Usual, assign, read, slots};
use super::{Catalogue, Grid, Run, Scene, SceneError, Simulated, Start, Sweep};
use crate::core::attractor::AttractorSearch;
use crate::core::continuation::{SettingError, Settings};
use crate::core::names::UnknownName;

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
        eigenvalues: Plain,
    })
}

/// The settings of a sweep by name.
fn sweep_slots(sweep: &mut Sweep) -> Slots<'_> {
    let Sweep { search, flow_error, over, .. } = sweep;
    let mut slots = slots!(search => AttractorSearch {
        transient: Plain,
        recorded_periods: Plain,
        max_period: Plain,
        lyapunov_periods: Plain,
    } without tolerance);
    slots.push(("flow_error", Box::new(Plain(flow_error))));
    if let [Grid { count, .. }, ..] = &mut over[..] {
        slots.push(("count", Box::new(Plain(count))));
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
        changed.check_accuracy()?;
        *self = changed;
        Ok(())
    }

    /// The value of a parameter at the start.
    pub fn value(&self, parameter: &str) -> Option<f64> {
        let given = self.parameters.iter().find(|(name, _)| name == parameter).map(|(_, v)| *v);
        given.or_else(|| {
            let defaults = self.problem.parameters();
            defaults.into_iter().find(|(name, _)| *name == parameter).and_then(|(_, value)| value)
        })
    }

    /// All parameters at the start, in the problem's order.
    ///
    /// # Errors
    /// [`SceneError::MissingParameters`] if the problem states no defaults for some that the scene does not give.
    pub fn values(&self) -> Result<Vec<f64>, SceneError> {
        let names: Vec<String> =
            self.problem.parameters().into_iter().map(|(name, _)| name).collect();
        let missing = names.iter().filter(|name| self.value(name).is_none());
        let missing: Vec<String> = missing.cloned().collect();
        match missing.is_empty() {
            true => Ok(names.iter().filter_map(|name| self.value(name)).collect()),
            false => Err(SceneError::MissingParameters { problem: self.problem.name(), missing }),
        }
    }

    /// The scene as one of its runs sees it.
    pub(super) fn as_seen_by(&self, run: &Run) -> Result<Scene, SceneError> {
        self.with(&run.set)
    }

    /// The scene with some values set.
    pub(super) fn with(&self, set: &[(String, String)]) -> Result<Scene, SceneError> {
        let mut scene = self.clone();
        for (name, value) in set {
            scene.assign(name, value)?;
        }
        Ok(scene)
    }

    /// Changes one value, or nothing at all.
    fn assign(&mut self, name: &str, value: &str) -> Result<(), SceneError> {
        let mut changed = self.clone();
        let out_of_range = |error: SettingError| SceneError::Value {
            name: name.into(),
            value: value.into(),
            reason: error.to_string(),
        };
        if changed.problem.set(name, value)? {
            changed.problem.entry().check().map_err(out_of_range)?;
            changed.check_parameters()?;
        } else if assign(continuation_slots(&mut changed.settings), name, value)? {
            changed.settings.check().map_err(out_of_range)?;
        } else if !changed.assign_to_sweeps(name, value)? {
            changed.assign_parameter(name, value)?;
        }
        *self = changed;
        Ok(())
    }

    /// What a scene states for all of its runs.
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
        let number: f64 = read(name, value)?;
        if !number.is_finite() {
            return Err(SceneError::Value {
                name: name.into(),
                value: value.into(),
                reason: "a parameter must be a finite number".into(),
            });
        }
        match self.parameters.iter_mut().find(|(key, _)| key == name) {
            Some((_, slot)) => *slot = number,
            None => self.parameters.push((name.into(), number)),
        }
        Ok(())
    }

    /// Refuses a name that is no parameter of the problem.
    fn require_parameter(&self, name: &str, with_settings: bool) -> Result<(), SceneError> {
        let mut known: Vec<String> =
            self.problem.parameters().into_iter().map(|(name, _)| name).collect();
        if known.iter().any(|known| known == name) {
            return Ok(());
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

    fn check_parameters(&self) -> Result<(), SceneError> {
        self.parameters.iter().try_for_each(|(name, _)| self.require_parameter(name, false))
    }

    pub(super) fn check(&self) -> Result<(), SceneError> {
        if self.runs.is_empty() && self.sweeps.is_empty() {
            return Err(SceneError::Invalid {
                place: "the list of runs".into(),
                found: "empty".into(),
                rule: "a scene must hold one run, or one sweep, or more".into(),
            });
        }
        self.check_parameters()?;
        self.values()?;
        unique("parameter", self.parameters.iter().map(|(name, _)| name.as_str()))?;
        unique("run", self.runs.iter().map(|run| run.name.as_str()))?;
        unique("sweep", self.sweeps.iter().map(|sweep| sweep.name.as_str()))?;
        for (name, value) in &self.parameters {
            finite(&format!("parameter `{name}`"), *value)?;
        }
        let sound = self.problem.entry().check().and_then(|()| self.settings.check());
        sound.map_err(|error| SceneError::Invalid {
            place: format!("the setting `{}`", error.name),
            found: error.value.to_string(),
            rule: format!("must be {}", error.range),
        })?;
        for (index, run) in self.runs.iter().enumerate() {
            self.check_run(run, &self.runs[..index])?;
        }
        self.sweeps.iter().try_for_each(|sweep| self.check_sweep(sweep))?;
        self.check_accuracy()
    }

    fn check_sweep(&self, sweep: &Sweep) -> Result<(), SceneError> {
        let Some(local) = &sweep.local else { return Ok(()) };
        let over = sweep.over.iter().map(|grid| &grid.name);
        let names = sweep.set.iter().map(|(name, _)| name).chain(over);
        let parameters = names.filter(|name| self.value(name).is_some());
        local.check_map(&format!("sweep `{}`", sweep.name), &self.runs, parameters)
    }

    fn check_run(&self, run: &Run, earlier: &[Run]) -> Result<(), SceneError> {
        let scene = self.as_seen_by(run)?;
        for range in run.along.iter().chain(&run.bounds) {
            let place = format!("run `{}`, range of `{}`", run.name, range.name);
            for end in [range.low, range.high].into_iter().flatten() {
                finite(&place, end)?;
            }
        }
        run.along.iter().try_for_each(|range| scene.require_parameter(&range.name, false))?;
        unique("range", run.along.iter().map(|range| range.name.as_str()))?;
        unique("setting of a run", run.set.iter().map(|(name, _)| name.as_str()))?;
        for (name, value) in run.marks.iter().chain(&run.grazings).chain(&run.hold_level) {
            finite(&format!("run `{}`, mark of `{name}`", run.name), *value)?;
        }
        let simulated = match &run.start {
            Start::Simulated(simulated) => {
                self.check_simulated(run, simulated, earlier)?;
                true
            }
            _ => false,
        };
        if run.along.is_empty() && !simulated {
            return Err(SceneError::Invalid {
                place: format!("run `{}`, along", run.name),
                found: "empty".into(),
                rule: "a branch releases one parameter or more".into(),
            });
        }
        if let Start::Guess(values) = &run.start {
            unique("unknown", values.iter().map(|(name, _)| name.as_str()))?;
            for (name, value) in values {
                finite(&format!("run `{}`, start of `{name}`", run.name), *value)?;
            }
        }
        match &run.local {
            Some(local) => local.check(self, run, earlier)?,
            None => no_map(run)?,
        }
        let Start::From { run: from, .. } = &run.start else { return Ok(()) };
        let Some(from) = earlier.iter().find(|run| run.name == *from) else {
            let names = earlier.iter().map(|run| run.name.as_str());
            return Err(UnknownName::new("earlier run", from.clone(), names).into());
        };
        if run.is_akin_to(from) {
            return Ok(());
        }
        Err(SceneError::Invalid {
            place: format!("run `{}`, start", run.name),
            found: format!("`{}`", from.name),
            rule: "must follow the flow, or the same local map, as this one does".into(),
        })
    }

    fn check_simulated(
        &self,
        run: &Run,
        simulated: &Simulated,
        earlier: &[Run],
    ) -> Result<(), SceneError> {
        let place = |what: &str| format!("run `{}`, {what}", run.name);
        for (name, value) in &simulated.state {
            finite(&place(&format!("start of `{name}`")), *value)?;
        }
        let times = [("transient", simulated.transient), ("duration", simulated.duration)];
        let bad = |time: &f64| !(time.is_finite() && *time >= 0.0);
        if let Some((what, time)) = times.into_iter().find(|(_, time)| bad(time)) {
            let rule = "must be a finite number, and not less than 0".into();
            return Err(SceneError::Invalid { place: place(what), found: time.to_string(), rule });
        }
        let Some(after) = &simulated.after else { return Ok(()) };
        if !earlier.iter().any(|run| run.name == *after) {
            let names = earlier.iter().map(|run| run.name.as_str());
            return Err(UnknownName::new("earlier run", after.clone(), names).into());
        }
        Ok(())
    }

    /// What made the branches, for a document: every parameter and setting by name.
    pub(super) fn record(&self) -> Vec<(String, String)> {
        let mut record: Vec<(String, String)> =
            self.problem.settings().into_iter().map(|(k, v)| (k.into(), v)).collect();
        let values = self.problem.parameters().into_iter().filter_map(|(name, _)| {
            let value = self.value(&name)?.to_string();
            Some((name, value))
        });
        record.extend(values);
        record
    }
}

fn finite(place: &str, value: f64) -> Result<(), SceneError> {
    match value.is_finite() {
        true => Ok(()),
        false => Err(SceneError::Invalid {
            place: place.into(),
            found: value.to_string(),
            rule: "must be a finite number; leave an end of a range out to leave it open".into(),
        }),
    }
}

fn unique<'a>(what: &str, names: impl Iterator<Item = &'a str>) -> Result<(), SceneError> {
    let mut seen: Vec<&str> = Vec::new();
    for name in names {
        if seen.contains(&name) {
            return Err(SceneError::Invalid {
                place: format!("the {what} `{name}`"),
                found: "given twice".into(),
                rule: "may be given once only".into(),
            });
        }
        seen.push(name);
    }
    Ok(())
}

/// Refuses what belongs to points of a local map in a run without one.
fn no_map(run: &Run) -> Result<(), SceneError> {
    let found = match (run.impacts.is_empty(), run.expanded) {
        (true, None) => return Ok(()),
        (false, _) => format!("impacts: {:?}", run.impacts),
        (_, Some(kind)) => format!("expanded: {kind}"),
    };
    Err(SceneError::Invalid {
        place: format!("run `{}`", run.name),
        found,
        rule: "must state the local map that it is about, `local`; orbits of the flow have an `itinerary`".into(),
    })
}
