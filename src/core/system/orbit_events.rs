//! Solutions with events, and the branches that emanate where they cease to be admissible.

use super::System;
use crate::core::failure::Failure;

/// Solutions with events, orbits or equilibria of a mode: the admissible solutions, and the
/// solutions that emanate where a solution ceases to be admissible.
///
/// *Limits* are monitors that are positive on admissible solutions. Where a limit vanishes,
/// branches of solutions with other events emanate, and the branch ends unless the caller continues
/// it beyond the limit.
pub trait OrbitEvents {
    /// Returns the limits at parameters `p`.
    fn limits(&self, p: &[f64]) -> Vec<Limit>;

    /// Checks the order of events, which the equations do not determine: a branch must not start
    /// where another event would follow, and its points with another order are marked. Not called
    /// where a limit vanishes, since the order is undecided at a limit.
    ///
    /// # Errors
    /// [`Failure::Mismatch`] names the event whose outcome differs from the assumed order of
    /// events; [`Failure::OutOfDomain`] if the equations are undefined at the solution.
    fn check(&self, x: &[f64]) -> Result<(), Failure>;

    /// Returns the first jump of a reset between one solution and another; `None` if no reset
    /// jumps.
    fn jump_between(&self, _solutions: [&[f64]; 2]) -> Option<Jump> {
        None
    }

    /// The standard name of the solution `(z, p)` at which the limit with this monitor vanishes;
    /// `None` if the solution does not have a standard name.
    fn name_of_limit(&self, monitor: usize, x: &[f64]) -> Option<&'static str>;

    /// Returns the orbit at a limit in the system on the other side: the system of orbits without
    /// the vanishing event if this system `passes` that event, otherwise with the event. `None` if
    /// that system is unknown.
    ///
    /// # Errors
    /// [`Failure`] if the computation of that system or orbit fails.
    fn across(&mut self, x: &[f64], passes: bool) -> Result<Option<Across<'_>>, Failure>;

    /// Returns the start of a branch that emanates at a limit, with the index `which` from 0.
    ///
    /// # Errors
    /// [`Failure`] if no such branch is known.
    fn emanating(&self, x: &[f64], which: usize) -> Result<Emanating, Failure>;
}

/// A discontinuity of a reset between one solution and another.
#[derive(Clone, Debug, PartialEq, miette::Diagnostic, thiserror::Error)]
#[error(
    "the reset of the event `{event}` is discontinuous: the value of {state} after the event jumps \
     from {:.6e} to {:.6e}", states[0], states[1]
)]
pub struct Jump {
    /// The position of the jump between the two solutions, from 0 to 1.
    pub share: f64,
    /// The event.
    pub event: String,
    /// The state that jumps most.
    pub state: String,
    /// The values of that state after the event: before the jump, and beyond the jump.
    pub states: [f64; 2],
}

/// A monitor that is positive on admissible solutions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limit {
    /// The position of the monitor.
    pub monitor: usize,
    /// The typical size of the monitor, to which tolerances are relative.
    pub scale: f64,
    /// Whether the limit belongs to an event that solutions pass, for example the speed of an
    /// impact. All other limits are distances to surfaces that solutions do not pass.
    pub passes: bool,
}

/// A solution at a limit, in the system of the orbits on the other side.
pub struct Across<'a> {
    /// The system of these orbits.
    pub system: &'a mut dyn System,
    /// The solution, as `x = (z, p)` of that system.
    pub x: &'a [f64],
}

/// The start of a branch that emanates at a limit.
pub struct Emanating {
    /// The system of its solutions.
    pub system: Box<dyn System>,
    /// The unknowns `z` of the solution at the limit in that system.
    pub z: Vec<f64>,
    /// The direction `(z, p)` of the branch, on one side only, where the equations are singular.
    pub along: Option<Vec<f64>>,
}
