//! Checks of a scene's contents, such as finite numbers, unique names and consistent runs.

use super::error::SceneError;
use super::local::Local;
use super::problem::Problem;
use super::simulate::Simulated;
use super::statement::{Run, Scene, Start, Sweep};
use crate::core::attractor::StroboscopicError;
use crate::core::bifurcation::catalogue::of_curves;
use crate::core::problem::{Forcing, Measure, UnknownName, position};
use crate::spelling::shown;
use std::collections::HashSet;
use std::ops::RangeInclusive;

/// The allowed tolerances of the flow of a sweep.
const FLOW_TOLERANCES: RangeInclusive<f64> = 1e-15..=1e-3;

/// The maximum number of unused parameters listed in a warning.
const MOST_UNUSED: usize = 5;

/// The allowed durations of simulations, in the model's unit of time. The number of steps, rather
/// than the duration, limits their cost.
const TIMES: RangeInclusive<f64> = 0.0..=1e15;

impl Scene {
    pub(super) fn check(&self) -> Result<(), SceneError> {
        self.check_words()?;
        if self.runs.is_empty() && self.sweeps.is_empty() {
            let rule = "a scene must have at least one run or one sweep";
            return Err(SceneError::invalid("the list of runs", "empty", rule));
        }
        self.check_parameters()?;
        check_durations(&self.problem, &self.values()?)?;
        unique("parameter", self.parameters.iter().map(|(name, _)| name))?;
        unique("run", self.runs.iter().map(|run| &run.name))?;
        unique("sweep", self.sweeps.iter().map(|sweep| &sweep.name))?;
        unique("column of a label", self.plot.labels.iter().map(|(column, _)| column))?;
        for (name, value) in &self.parameters {
            if !value.is_finite() {
                let rule = "must be a finite number";
                let place = format!("parameter `{}`", shown(name));
                return Err(SceneError::invalid(place, value.to_string(), rule));
            }
        }
        self.check_settings()?;
        self.check_names()?;
        let aperiodic = self.problem.text().is_some_and(|model| model.is_aperiodic());
        if aperiodic
            && (self.runs.iter().any(|run| !run.along.is_empty()) || !self.sweeps.is_empty())
        {
            let rule = "must be periodic where branches are traced: state the period of the forcing as `period: \"2*pi/w\"`, after `tangency import` for an .ode file";
            return Err(SceneError::invalid(
                "the time `t` in the equations",
                "without a period",
                rule,
            ));
        }
        if let Ok(motion) = self.problem.model().motion() {
            motion.check_measures()?;
        }
        for (index, run) in self.runs.iter().enumerate() {
            self.check_run(run, &self.runs[..index])?;
        }
        self.sweeps.iter().try_for_each(|sweep| self.check_sweep(sweep))?;
        self.check_accuracy()
    }

    /// Rejects a parameter with the name of a setting, which would make `--set` ambiguous.
    fn check_names(&self) -> Result<(), SceneError> {
        let settings = self.setting_names();
        let named = |name: &&String| settings.contains(name);
        match self.problem.parameter_names().iter().find(named) {
            None => Ok(()),
            Some(name) => {
                let place = format!("the name of the parameter `{}`", shown(name));
                let rule = "must be unambiguous for `--set`: rename the parameter";
                Err(SceneError::invalid(place, "also the name of a setting", rule))
            }
        }
    }

    /// Rejects settings outside their ranges.
    pub(super) fn check_settings(&self) -> Result<(), SceneError> {
        let sound = self.problem.model().check().and_then(|()| self.settings.check());
        sound.map_err(|error| {
            let (place, rule) =
                (format!("the setting `{}`", error.name), format!("must be {}", error.range));
            SceneError::invalid(place, error.value.to_string(), rule)
        })
    }

    pub(super) fn check_parameters(&self) -> Result<(), SceneError> {
        let known: HashSet<String> = self.problem.parameter_names().into_iter().collect();
        let mut unknown = self.parameters.iter().filter(|(name, _)| !known.contains(name));
        unknown.try_for_each(|(name, _)| self.problem.require_parameter(name))
    }

    fn check_sweep(&self, sweep: &Sweep) -> Result<(), SceneError> {
        let resolved = self.resolved_sweep(sweep)?;
        check_durations(&resolved.problem, &resolved.values)?;
        let place = |what: &str| format!("sweep `{}`, {what}", sweep.name);
        if !FLOW_TOLERANCES.contains(&sweep.flow_tolerance) {
            let rule = "must be from 1e-15 to 1e-3";
            return Err(SceneError::invalid(
                place("flow_tolerance"),
                sweep.flow_tolerance.to_string(),
                rule,
            ));
        }
        let tolerance = sweep.search.tolerance;
        if !(tolerance > 0.0 && tolerance < 1.0) {
            let rule = "must be between 0 and 1";
            return Err(SceneError::invalid(place("tolerance"), tolerance.to_string(), rule));
        }
        if let (Some(at), Some(_)) = (&sweep.at, &sweep.local) {
            let rule = "must be omitted where a local map is iterated";
            return Err(SceneError::invalid(place("at"), at.clone(), rule));
        }
        let Some(local) = &sweep.local else {
            let motion = resolved.motion()?;
            match (&sweep.at, motion.forcing()) {
                (None, Forcing::None) => return Err(StroboscopicError::NoPeriod.into()),
                (Some(event), Forcing::None) => {
                    let guards = motion.guards();
                    position("event", event, guards.iter().map(|guard| &guard.name))?;
                }
                (Some(event), _) => return Err(StroboscopicError::Forced(event.clone()).into()),
                (None, _) => {}
            }
            resolved.plan(&motion.modes()[0])?;
            let known = motion.measures().into_iter();
            let known: Vec<String> =
                known.map(|(name, _)| name).chain([Measure::PENETRATION.into()]).collect();
            return Ok(sweep
                .measures
                .iter()
                .try_for_each(|name| position("measure", name, &known).map(|_| ()))?);
        };
        let over = sweep.over.iter().map(|grid| &grid.name);
        let names = sweep.set.iter().map(|(name, _)| name).chain(over);
        let parameters = names.filter(|name| self.value(name).is_some());
        check_map(local, &format!("sweep `{}`", sweep.name), &self.runs, parameters)
    }

    fn check_run(&self, run: &Run, earlier: &[Run]) -> Result<(), SceneError> {
        let resolved = self.resolved(run)?;
        check_durations(&resolved.problem, &resolved.values)?;
        let place = |what: &str| format!("run `{}`, {what}", run.name);
        for range in run.along.iter().chain(&run.bounds) {
            for end in [range.low, range.high].into_iter().flatten() {
                finite(&place(&format!("range of `{}`", range.name)), end)?;
            }
        }
        run.along.iter().try_for_each(|range| resolved.problem.require_parameter(&range.name))?;
        unique("range", run.along.iter().map(|range| &range.name))?;
        unique("setting of a run", run.set.iter().map(|(name, _)| name))?;
        for (name, value) in run.marks.iter().chain(&run.grazings).chain(&run.hold_level) {
            finite(&place(&format!("mark of `{name}`")), *value)?;
        }
        check_held(run)?;
        if let Start::Simulated(simulated) = &run.start {
            check_simulated(simulated, &place, earlier)?;
        } else if run.along.is_empty() {
            let rule = "a branch must vary at least one parameter";
            return Err(SceneError::invalid(place("along"), "empty", rule));
        }
        if let Start::Guess(values) = &run.start {
            unique("unknown", values.iter().map(|(name, _)| name))?;
            for (name, value) in values {
                finite(&place(&format!("start of `{name}`")), *value)?;
            }
        }
        if let Start::Profile(profile) = &run.start {
            profile.check(&place("start"))?;
        }
        match &run.local {
            Some(local) => self.check_local(local, run, earlier)?,
            None => no_map(run)?,
        }
        let Start::From { run: from, .. } = &run.start else { return Ok(()) };
        if run.is_akin_to(named(earlier, from)?) {
            return Ok(());
        }
        let rule = "must follow the flow, or the same local map, as this run does";
        Err(SceneError::invalid(place("start"), format!("`{from}`"), rule))
    }

    /// Rejects options of a run that do not apply to a local map.
    fn check_local(&self, local: &Local, run: &Run, earlier: &[Run]) -> Result<(), SceneError> {
        let place = format!("run `{}`", run.name);
        let held = run.set.iter().map(|(name, _)| name).filter(|name| self.value(name).is_some());
        let along = run.along.iter().map(|range| &range.name);
        check_map(local, &place, earlier, held.chain(along))?;
        if run.expanded.is_some() && (run.along.len(), local.parameters.len()) != (1, 2) {
            let found = format!("a map in {}", local.parameters.join(", "));
            let rule =
                "must vary one of the two parameters of a map: the series gives the other one";
            return Err(SceneError::invalid(place + ", expanded", found, rule));
        }
        if matches!(run.start, Start::Simulated(_)) {
            let rule =
                "must be `Guess` or `From` for points of a local map; a sweep iterates the map";
            return Err(SceneError::invalid(place + ", start", "a simulation", rule));
        }
        Ok(())
    }
}

impl Scene {
    /// Returns warnings of probable mistakes in equations given as text: unused parameters,
    /// discontinuous guards, and parts of a file that have no effect.
    pub fn warnings(&self) -> Vec<String> {
        let unused = self.problem.text().map_or(&[][..], |model| model.unused());
        let more = unused.len().saturating_sub(MOST_UNUSED);
        let unused = unused.iter().take(MOST_UNUSED);
        let unused = unused.map(|name| format!("no formula uses the parameter `{name}`"));
        let more = (more > 0).then(|| format!("no formula uses {more} further parameters"));
        let notes = self.problem.notes().iter().cloned();
        unused.chain(more).chain(self.problem.jumps()).chain(notes).collect()
    }
}

impl Problem {
    /// Returns the warnings of discontinuous guards, which are also saved with branches.
    pub(super) fn jumps(&self) -> impl Iterator<Item = String> + '_ {
        let jumping = self.text().map_or(Vec::new(), |model| model.jumping_guards());
        jumping.into_iter().map(|name| {
            format!(
                "the guard `{name}` is discontinuous: an event is located where a guard decreases through zero, and missed where \
                 a guard jumps away from zero, as in `1 - mod(t, 1)`; state events at given times with `at`, as in \
                 `at: \"n*period\"`"
            )
        })
    }
}

impl Run {
    /// Returns whether two runs follow the same motions: the motions of the flow, or of the same
    /// local map.
    pub(super) fn is_akin_to(&self, other: &Run) -> bool {
        let map = |run: &Run| {
            let order = run.set.iter().find(|(name, _)| name == "order").cloned();
            Some((run.local.clone()?, order))
        };
        map(self) == map(other)
    }
}

/// Rejects a period or length that is not positive for the initial parameters.
fn check_durations(problem: &Problem, p: &[f64]) -> Result<(), SceneError> {
    let refused = problem.text().and_then(|model| model.refused_duration(p));
    Ok(refused.map_or(Ok(()), Err)?)
}

/// Returns the earlier run with a given name.
fn named<'a>(earlier: &'a [Run], name: &str) -> Result<&'a Run, UnknownName> {
    let names = earlier.iter().map(|run| &run.name);
    Ok(&earlier[position("earlier run", name, names)?])
}

fn check_simulated(
    simulated: &Simulated,
    place: &dyn Fn(&str) -> String,
    earlier: &[Run],
) -> Result<(), SceneError> {
    for (name, value) in &simulated.state {
        finite(&place(&format!("start of `{name}`")), *value)?;
    }
    let times = [("transient", simulated.transient), ("duration", simulated.duration)];
    if let Some((what, time)) = times.into_iter().find(|(_, time)| !TIMES.contains(time)) {
        let rule = "must be from 0 to 1e15";
        return Err(SceneError::invalid(place(what), time.to_string(), rule));
    }
    let after = simulated.after.as_ref().map(|after| named(earlier, after)).transpose();
    Ok(after.map(|_| ())?)
}

/// Rejects an invalid local map of a run or sweep, which fixes some parameters and varies others.
fn check_map<'a>(
    local: &Local,
    place: &str,
    earlier: &[Run],
    mut parameters: impl Iterator<Item = &'a String>,
) -> Result<(), SceneError> {
    let place = format!("{place}, local");
    if named(earlier, &local.run)?.local.is_some() {
        let rule = "must be a run of the flow with a grazing";
        return Err(SceneError::invalid(place, format!("`{}`", local.run), rule));
    }
    if local.parameters.is_empty() {
        let rule = "must name the parameters of the map";
        return Err(SceneError::invalid(place, "without parameters", rule));
    }
    match parameters.find(|name| !local.parameters.contains(name)) {
        Some(name) => {
            let rule = format!("must be a parameter of the map: {}", local.parameters.join(", "));
            Err(SceneError::invalid(place, format!("`{name}`"), rule))
        }
        None => Ok(()),
    }
}

fn finite(place: &str, value: f64) -> Result<(), SceneError> {
    if value.is_finite() {
        return Ok(());
    }
    let rule = "must be a finite number; omit an end of a range to leave it open";
    Err(SceneError::invalid(place, value.to_string(), rule))
}

fn unique<'a>(what: &str, names: impl Iterator<Item = &'a String>) -> Result<(), SceneError> {
    let mut seen = HashSet::new();
    match names.into_iter().find(|name| !seen.insert(*name)) {
        Some(name) => {
            let place = format!("the {what} `{name}`");
            Err(SceneError::invalid(place, "given twice", "may be given only once"))
        }
        None => Ok(()),
    }
}

/// Rejects held points of kinds without curves in two parameters.
fn check_held(run: &Run) -> Result<(), SceneError> {
    let held = of_curves();
    let Some(kind) = run.hold.filter(|kind| !held.contains(kind)) else { return Ok(()) };
    let held: Vec<&str> = held.iter().map(|kind| kind.letters()).collect();
    let rule = format!("must be a kind that can be traced in two parameters: {}", held.join(", "));
    let found = format!("{kind} ({})", kind.meaning());
    Err(SceneError::invalid(format!("run `{}`, hold", run.name), found, rule))
}

/// Rejects options of a local map in a run without one.
fn no_map(run: &Run) -> Result<(), SceneError> {
    let found = match (run.impacts.is_empty(), run.expanded) {
        (true, None) => return Ok(()),
        (false, _) => format!("impacts: {:?}", run.impacts),
        (_, Some(kind)) => format!("expanded: {kind}"),
    };
    let rule = "must come with a local map, `local`; orbits of the flow have an `itinerary`";
    Err(SceneError::invalid(format!("run `{}`", run.name), found, rule))
}
