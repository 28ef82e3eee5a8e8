//! Checks of the sweeps of a scene.

use super::error::SceneError;
use super::local::Local;
use super::requirements::{require_durations, require_finite, require_map, require_unique};
use super::resolve::ResolvedSweep;
use super::statement::{Scene, Sweep};
use crate::core::attractor::StroboscopicError;
use crate::core::problem::{Forcing, Measure, position};
use crate::core::spelling::shown;
use std::ops::RangeInclusive;

/// The range of allowed tolerances with which a sweep integrates the flow.
const FLOW_TOLERANCES: RangeInclusive<f64> = 1e-15..=1e-3;

/// A sweep whose consistency is checked, with the scene that the checks need.
pub(super) struct SweepCheck<'s> {
    /// The scene that contains the sweep.
    pub scene: &'s Scene,
    /// The sweep.
    pub resolved: ResolvedSweep,
}

impl SweepCheck<'_> {
    /// Returns an error if the sweep is invalid.
    pub fn check(&self) -> Result<(), SceneError> {
        require_durations(&self.resolved.problem, &self.resolved.values)?;
        self.check_tolerances()?;
        self.check_values()?;
        match &self.resolved.sweep.local {
            Some(local) => self.check_local(local),
            None => self.check_sampling(),
        }
    }

    /// Returns the name of a setting of the sweep for error messages.
    fn place(&self, what: &str) -> String {
        format!("sweep `{}`, {what}", self.resolved.sweep.name)
    }

    fn check_tolerances(&self) -> Result<(), SceneError> {
        let Sweep { flow_tolerance, search, .. } = &self.resolved.sweep;
        if !FLOW_TOLERANCES.contains(flow_tolerance) {
            let setting = self.place("flow_tolerance");
            let message =
                format!("{setting} is {flow_tolerance}, but must be between 1e-15 and 1e-3");
            return Err(SceneError::invalid(message));
        }
        let tolerance = search.tolerance;
        if !(tolerance > 0.0 && tolerance < 1.0) {
            let setting = self.place("tolerance");
            let message = format!("{setting} is {tolerance}, but must be between 0 and 1");
            return Err(SceneError::invalid(message));
        }
        Ok(())
    }

    /// Returns an error if a value is given twice, or if a start is not finite.
    fn check_values(&self) -> Result<(), SceneError> {
        let Sweep { set, starts, .. } = &self.resolved.sweep;
        require_unique("setting of a sweep", set.iter().map(|(name, _)| name))?;
        for start in starts {
            require_unique("state of a start", start.iter().map(|(name, _)| name))?;
            for (name, value) in start {
                require_finite(&self.place(&format!("start of `{name}`")), *value)?;
            }
        }
        Ok(())
    }

    /// Returns an error if the local map that the sweep iterates is invalid, or if the sweep names
    /// an event.
    fn check_local(&self, local: &Local) -> Result<(), SceneError> {
        let sweep = &self.resolved.sweep;
        if let Some(at) = &sweep.at {
            let (setting, at) = (self.place("at"), shown(at));
            let message =
                format!("{setting} names the event `{at}`, but a local map has no events");
            return Err(SceneError::invalid(message).with_help("omit `at`"));
        }
        let over = sweep.over.iter().map(|grid| &grid.name);
        let names = sweep.set.iter().map(|(name, _)| name).chain(over);
        let parameters = names.filter(|name| self.scene.value(name).is_some());
        require_map(local, &format!("sweep `{}`", sweep.name), &self.scene.runs, parameters)
    }

    /// Returns an error if the sweep cannot sample the motion, or records an unknown measure.
    fn check_sampling(&self) -> Result<(), SceneError> {
        let Sweep { at, measures, .. } = &self.resolved.sweep;
        let motion = self.resolved.motion()?;
        match (at, motion.forcing()) {
            (None, Forcing::None) => return Err(StroboscopicError::NoPeriod.into()),
            (Some(event), Forcing::None) => {
                let guards = motion.guards();
                position("event", event, guards.iter().map(|guard| &guard.name))?;
            }
            (Some(event), _) => return Err(StroboscopicError::Forced(event.clone()).into()),
            (None, _) => {}
        }
        self.resolved.plan(&motion.modes()[0])?;
        let known = motion.measures().into_iter().map(|(name, _)| name);
        let known: Vec<String> = known.chain([Measure::PENETRATION.into()]).collect();
        for name in measures {
            position("measure", name, &known)?;
        }
        Ok(())
    }
}
