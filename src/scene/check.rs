//! Checks of the contents of a scene, for example that numbers are finite, names are unique and
//! runs are consistent.

use super::error::SceneError;
use super::local::Local;
use super::problem::Problem;
use super::reach::Ends;
use super::simulate::Simulated;
use super::statement::{Run, Scene, Start, Sweep};
use crate::core::attractor::StroboscopicError;
use crate::core::bifurcation::catalogue::of_curves;
use crate::core::hybrid::check_period;
use crate::core::problem::{Forcing, Measure, UnknownName, position};
use crate::core::spelling::shown;
use std::collections::HashSet;
use std::ops::RangeInclusive;

/// The range of allowed tolerances with which a sweep integrates the flow.
const FLOW_TOLERANCES: RangeInclusive<f64> = 1e-15..=1e-3;

/// The maximum number of unused parameters that a warning lists.
const MOST_UNUSED: usize = 5;

/// The range of allowed durations of simulations, in the model's unit of time. The maximum number
/// of steps, and not the duration, limits the computing time of simulations.
const TIMES: RangeInclusive<f64> = 0.0..=1e15;

impl Scene {
    pub(super) fn check(&self) -> Result<(), SceneError> {
        self.check_words()?;
        if self.runs.is_empty() && self.sweeps.is_empty() {
            return Err(SceneError::invalid("the scene has neither runs nor sweeps"));
        }
        self.check_parameters()?;
        check_durations(&self.problem, &self.values()?)?;
        unique("parameter", self.parameters.iter().map(|(name, _)| name))?;
        unique("run", self.runs.iter().map(|run| &run.name))?;
        unique("sweep", self.sweeps.iter().map(|sweep| &sweep.name))?;
        unique("column of a label", self.plot.labels.iter().map(|(column, _)| column))?;
        for (name, value) in &self.parameters {
            if !value.is_finite() {
                let name = shown(name);
                let message = format!("parameter `{name}` is {value}, but must be a finite number");
                return Err(SceneError::invalid(message));
            }
        }
        self.check_settings()?;
        self.check_names()?;
        let aperiodic = self.problem.text().is_some_and(|model| model.is_aperiodic());
        if aperiodic
            && (self.runs.iter().any(|run| !run.along.is_empty()) || !self.sweeps.is_empty())
        {
            return Err(SceneError::invalid(
                "the equations contain the time `t` but have no period, and branches need a period",
            )
            .with_help(
                "state the period of the forcing, as in `period: \"2*pi/w\"`; convert an .ode file \
                 with `tangency import` first",
            ));
        }
        if let Ok(motion) = self.problem.model().motion() {
            motion.check_measures()?;
        }
        let ends = Ends::of(&self.runs);
        for (index, run) in self.runs.iter().enumerate() {
            self.check_run((run, &ends), &self.runs[..index])?;
        }
        self.sweeps.iter().try_for_each(|sweep| self.check_sweep(sweep))?;
        self.check_accuracy()
    }

    /// Returns an error if a parameter has the name of a setting, because the option `--set` would
    /// be ambiguous.
    fn check_names(&self) -> Result<(), SceneError> {
        let settings = self.setting_names();
        let named = |name: &&String| settings.contains(name);
        match self.problem.parameter_names().iter().find(named) {
            None => Ok(()),
            Some(name) => {
                let name = shown(name);
                let message = format!("a parameter and a setting have the same name, `{name}`");
                Err(SceneError::invalid(message).with_help("rename the parameter"))
            }
        }
    }

    /// Returns an error if a setting is outside its allowed range.
    pub(super) fn check_settings(&self) -> Result<(), SceneError> {
        let sound = self.problem.model().check().and_then(|()| self.settings.check());
        sound.map_err(|error| SceneError::invalid(error.to_string()))
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
            let (setting, found) = (place("flow_tolerance"), sweep.flow_tolerance);
            let message = format!("{setting} is {found}, but must be between 1e-15 and 1e-3");
            return Err(SceneError::invalid(message));
        }
        let tolerance = sweep.search.tolerance;
        if !(tolerance > 0.0 && tolerance < 1.0) {
            let setting = place("tolerance");
            let message = format!("{setting} is {tolerance}, but must be between 0 and 1");
            return Err(SceneError::invalid(message));
        }
        if let (Some(at), Some(_)) = (&sweep.at, &sweep.local) {
            let (setting, at) = (place("at"), shown(at));
            let message =
                format!("{setting} names the event `{at}`, but a local map has no events");
            return Err(SceneError::invalid(message).with_help("omit `at`"));
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

    fn check_run(&self, (run, ends): (&Run, &Ends), earlier: &[Run]) -> Result<(), SceneError> {
        let resolved = self.resolved_among(run, ends)?;
        check_durations(&resolved.problem, &resolved.values)?;
        // Simulations and sweeps may have further frequencies.
        if let (false, Ok(motion)) = (run.along.is_empty(), resolved.motion()) {
            check_period(&*motion, &resolved.values)?;
        }
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
            let setting = place("along");
            let message = format!("{setting} is empty, but a branch must vary a parameter");
            return Err(SceneError::invalid(message));
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
        let message = format!(
            "run `{}` starts from run `{}`, but the two runs follow different local maps, or one \
             of them follows the flow",
            run.name,
            shown(from)
        );
        Err(SceneError::invalid(message).with_help(
            "start a run of a local map from a run of the same local map, and a run of the flow \
             from a run of the flow",
        ))
    }

    /// Returns an error if a run of a local map has an option that does not apply to local maps.
    fn check_local(&self, local: &Local, run: &Run, earlier: &[Run]) -> Result<(), SceneError> {
        let place = format!("run `{}`", run.name);
        let held = run.set.iter().map(|(name, _)| name).filter(|name| self.value(name).is_some());
        let along = run.along.iter().map(|range| &range.name);
        check_map(local, &place, earlier, held.chain(along))?;
        if run.expanded.is_some() && (run.along.len(), local.parameters.len()) != (1, 2) {
            let message = format!(
                "{place}, field `expanded`: the local map must have two parameters, and the run \
                 must vary exactly one of them, so that the series gives the other parameter, but \
                 the local map has the parameters {}, and the run varies {} parameters",
                local.parameters.join(", "),
                run.along.len()
            );
            return Err(SceneError::invalid(message));
        }
        if matches!(run.start, Start::Simulated(_)) {
            let message = format!(
                "{place} starts from a simulation, but a run of a local map must start at `Guess` or \
                 `From`"
            );
            return Err(SceneError::invalid(message).with_help("iterate the map by a sweep"));
        }
        Ok(())
    }
}

impl Scene {
    /// Returns warnings about probable mistakes in equations given as text: unused parameters,
    /// guards with discontinuous functions, and parts of a file that have no effect.
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

impl Run {
    /// Returns whether two runs have solutions of the same kind: either both have solutions of the
    /// flow, or both have solutions of the same local map.
    pub(super) fn is_akin_to(&self, other: &Run) -> bool {
        let map = |run: &Run| {
            let order = run.set.iter().find(|(name, _)| name == "order").cloned();
            Some((run.local.clone()?, order))
        };
        map(self) == map(other)
    }
}

/// Returns an error if, for the initial parameters, the period of the forcing or the length of the
/// interval is not positive.
fn check_durations(problem: &Problem, p: &[f64]) -> Result<(), SceneError> {
    let refused = problem.text().and_then(|model| model.refused_duration(p));
    Ok(refused.map_or(Ok(()), Err)?)
}

/// Returns the run with a given name among the runs that precede a given run.
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
        let setting = place(what);
        let message = format!("{setting} is {time}, but must be between 0 and 1e15");
        return Err(SceneError::invalid(message));
    }
    if simulated.duration == 0.0 {
        let setting = place("duration");
        let message = format!("{setting} is 0, but a history needs a positive duration");
        return Err(SceneError::invalid(message));
    }
    let after = simulated.after.as_ref().map(|after| named(earlier, after)).transpose();
    Ok(after.map(|_| ())?)
}

/// Returns an error if the local map of a run or sweep is invalid; a local map fixes some
/// parameters and varies others.
fn check_map<'a>(
    local: &Local,
    place: &str,
    earlier: &[Run],
    mut parameters: impl Iterator<Item = &'a String>,
) -> Result<(), SceneError> {
    let place = format!("{place}, local");
    if named(earlier, &local.run)?.local.is_some() {
        let message = format!(
            "{place}: the run `{}` must trace orbits of the flow, but traces \
                               orbits of a local map",
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
                "{place}: `{name}` is not a parameter of the local map, whose parameters \
                         are {known}"
            );
            Err(SceneError::invalid(message))
        }
        None => Ok(()),
    }
}

fn finite(number: &str, value: f64) -> Result<(), SceneError> {
    if value.is_finite() {
        return Ok(());
    }
    Err(SceneError::invalid(format!("{number} is {value}, but must be a finite number"))
        .with_help("if a range has no bound at one end, omit that end"))
}

fn unique<'a>(what: &str, names: impl Iterator<Item = &'a String>) -> Result<(), SceneError> {
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

/// Returns an error if the setting `hold` of a run names a kind of special point for which curves
/// in two parameters cannot be traced.
fn check_held(run: &Run) -> Result<(), SceneError> {
    let held = of_curves();
    let Some(kind) = run.hold.filter(|kind| !held.contains(kind)) else { return Ok(()) };
    let held: Vec<&str> = held.iter().map(|kind| kind.letters()).collect();
    let message = format!(
        "run `{}` holds {kind} ({}), but the curve of these points in two parameters cannot be \
         traced",
        run.name,
        kind.meaning()
    );
    Err(SceneError::invalid(message).with_help(format!("hold one of {}", held.join(", "))))
}

/// Returns an error if a run that uses no local map has options that apply only to local maps.
fn no_map(run: &Run) -> Result<(), SceneError> {
    let found = match (run.impacts.is_empty(), run.expanded) {
        (true, None) => return Ok(()),
        (false, _) => format!("impacts: {:?}", run.impacts),
        (_, Some(kind)) => format!("expanded: {kind}"),
    };
    let message = format!(
        "run `{}` has the field `{found}`, which is valid only for a local map, \
                           but the field `local` is missing",
        run.name
    );
    Err(SceneError::invalid(message).with_help("for orbits of the flow, state `itinerary` instead"))
}
