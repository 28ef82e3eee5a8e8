//! Checks of the runs of a scene.

use super::error::SceneError;
use super::local::Local;
use super::requirements::{named, require_durations, require_finite, require_map, require_unique};
use super::resolve::Resolved;
use super::simulate::Simulated;
use super::statement::{Run, Scene, Start};
use crate::core::bifurcation::catalogue::of_curves;
use crate::core::hybrid::check_period;
use crate::core::spelling::shown;
use std::ops::RangeInclusive;

/// The range of allowed durations of simulations, in the model's unit of time. The maximum number
/// of steps, and not the duration, limits the computing time of simulations.
const TIMES: RangeInclusive<f64> = 0.0..=1e15;

/// A run whose consistency is checked, with the parts of its scene that the checks need.
pub(super) struct RunCheck<'s> {
    /// The scene that contains the run.
    pub scene: &'s Scene,
    /// The run.
    pub resolved: Resolved,
    /// The runs that precede the run in the scene.
    pub earlier: &'s [Run],
}

impl RunCheck<'_> {
    /// Returns an error if the run is invalid.
    pub fn check(&self) -> Result<(), SceneError> {
        let run = self.run();
        self.check_durations()?;
        self.check_ranges()?;
        require_unique("setting of a run", run.set.iter().map(|(name, _)| name))?;
        self.check_numbers("mark", &run.marks)?;
        self.check_numbers("grazing", &run.grazings)?;
        self.check_numbers("held level", &run.hold_level)?;
        check_held(run)?;
        self.check_start()?;
        match &run.local {
            Some(local) => self.check_local(local)?,
            None => no_map(run)?,
        }
        self.check_origin()
    }

    fn run(&self) -> &Run {
        &self.resolved.run
    }

    /// Returns the name of a setting of the run for error messages.
    fn place(&self, what: &str) -> String {
        format!("run `{}`, {what}", self.run().name)
    }

    /// Returns an error if one of the given numbers is infinite or not a number.
    fn check_numbers<'a>(
        &self,
        what: &str,
        numbers: impl IntoIterator<Item = &'a (String, f64)>,
    ) -> Result<(), SceneError> {
        for (name, value) in numbers {
            require_finite(&self.place(&format!("{what} of `{name}`")), *value)?;
        }
        Ok(())
    }

    /// Returns an error if the period of the forcing is invalid.
    fn check_durations(&self) -> Result<(), SceneError> {
        let Resolved { run, problem, values, .. } = &self.resolved;
        require_durations(problem, values)?;
        // Simulations and sweeps may have further frequencies.
        if let (false, Ok(motion)) = (run.along.is_empty(), self.resolved.motion()) {
            check_period(&*motion, values)?;
        }
        Ok(())
    }

    fn check_ranges(&self) -> Result<(), SceneError> {
        let Resolved { run, problem, .. } = &self.resolved;
        for range in run.along.iter().chain(&run.bounds) {
            for end in [range.low, range.high].into_iter().flatten() {
                require_finite(&self.place(&format!("range of `{}`", range.name)), end)?;
            }
        }
        run.along.iter().try_for_each(|range| problem.require_parameter(&range.name))?;
        require_unique("range", run.along.iter().map(|range| &range.name))
    }

    /// Returns an error if the start of the run is invalid, or if the run varies no parameter
    /// although its start is not a simulation.
    fn check_start(&self) -> Result<(), SceneError> {
        match &self.run().start {
            Start::Simulated(simulated) => self.check_simulated(simulated),
            _ if self.run().along.is_empty() => {
                let setting = self.place("along");
                let message = format!("{setting} is empty, but a branch must vary a parameter");
                Err(SceneError::invalid(message))
            }
            Start::Guess(values) => {
                require_unique("unknown", values.iter().map(|(name, _)| name))?;
                self.check_numbers("start", values)
            }
            Start::Profile(profile) => profile.check(&self.place("start")),
            Start::Rest | Start::From { .. } => Ok(()),
        }
    }

    fn check_simulated(&self, simulated: &Simulated) -> Result<(), SceneError> {
        require_unique("state", simulated.state.iter().map(|(name, _)| name))?;
        self.check_numbers("start", &simulated.state)?;
        let times = [("transient", simulated.transient), ("duration", simulated.duration)];
        if let Some((what, time)) = times.into_iter().find(|(_, time)| !TIMES.contains(time)) {
            let setting = self.place(what);
            let message = format!("{setting} is {time}, but must be between 0 and 1e15");
            return Err(SceneError::invalid(message));
        }
        if simulated.duration == 0.0 {
            let setting = self.place("duration");
            let message = format!("{setting} is 0, but a history needs a positive duration");
            return Err(SceneError::invalid(message));
        }
        if let Some(after) = &simulated.after {
            named(self.earlier, after)?;
        }
        Ok(())
    }

    /// Returns an error if the local map is invalid, or if the run has an option that does not
    /// apply to local maps.
    fn check_local(&self, local: &Local) -> Result<(), SceneError> {
        let run = self.run();
        let place = format!("run `{}`", run.name);
        let set = run.set.iter().map(|(name, _)| name);
        let held = set.filter(|name| self.scene.value(name).is_some());
        let along = run.along.iter().map(|range| &range.name);
        require_map(local, &place, self.earlier, held.chain(along))?;
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

    /// Returns an error if the run starts from a run whose solutions are of another kind.
    fn check_origin(&self) -> Result<(), SceneError> {
        let run = self.run();
        let Start::From { run: from, .. } = &run.start else { return Ok(()) };
        if run.is_akin_to(named(self.earlier, from)?) {
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
        "run `{}` has the field `{found}`, which is valid only for a local map, but the field \
         `local` is missing",
        run.name
    );
    Err(SceneError::invalid(message).with_help("for orbits of the flow, state `itinerary` instead"))
}
