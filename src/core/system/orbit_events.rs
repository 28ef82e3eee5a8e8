//! Solutions with events, and the branches that emanate from the boundary of the admissible
//! solutions.

use super::System;
use crate::core::failure::Failure;

/// A system whose solutions (orbits, or equilibria of a mode) can have events: which solutions are
/// admissible, and which solutions emanate where a solution ceases to be admissible.
///
/// *Limits* are monitors that are positive on admissible solutions. If a limit vanishes at a
/// solution, branches of solutions with other events emanate there, and the present branch ends
/// unless the caller continues it beyond this solution.
pub trait OrbitEvents {
    /// Returns the limits, which are monitors that are positive on admissible solutions, at the
    /// parameters `p`.
    fn limits(&self, p: &[f64]) -> Vec<Limit>;

    /// Checks the order of the events on a solution, because the equations do not determine this
    /// order: a branch must not start from a solution on which an event outside the solution's
    /// itinerary would occur first, and points of the branch with a wrong order of events are
    /// marked. `check` is not called at limits of admissible solutions, since the order of events
    /// is undecided there.
    ///
    /// # Errors
    /// [`Failure::Mismatch`], with the name of the event whose outcome differs from the assumed
    /// order of events; [`Failure::OutOfDomain`] if the equations are undefined at the solution.
    fn check(&self, x: &[f64]) -> Result<(), Failure>;

    /// Compares two solutions, and returns the first discontinuity of an event's reset between
    /// them; `None` if all resets are continuous between the two solutions.
    fn jump_between(&self, _solutions: [&[f64]; 2]) -> Option<Jump> {
        None
    }

    /// Returns the standard name of the bifurcation at a solution `x = (z, p)` at which this
    /// monitor vanishes; `None` if the bifurcation does not have a standard name.
    fn name_of_limit(&self, monitor: usize, x: &[f64]) -> Option<&'static str>;

    /// Given an orbit at a limit of admissible solutions, returns the same orbit as a solution of
    /// the system on the other side of the limit. If orbits of this system have the vanishing event
    /// (`passes`), the other system consists of the equations without this event; otherwise it
    /// consists of the equations with the event. `None` if the system on the other side of the
    /// limit is unknown.
    ///
    /// # Errors
    /// [`Failure`] if the computation of the system or orbit on the other side of the limit fails.
    fn across(&mut self, x: &[f64], passes: bool) -> Result<Option<Across<'_>>, Failure>;

    /// Returns the start of a branch that emanates at a limit of admissible solutions; `which` is
    /// the index of the branch, counted from 0.
    ///
    /// # Errors
    /// [`Failure`] if no branch with this index is known.
    fn emanating(&self, x: &[f64], which: usize) -> Result<Emanating, Failure>;
}

/// A discontinuity of an event's reset between one solution and another.
#[derive(Clone, Debug, PartialEq, miette::Diagnostic, thiserror::Error)]
#[error(
    "the reset of the event `{event}` is discontinuous: the value of {state} after the event jumps \
     from {:.6e} to {:.6e}", states[0], states[1]
)]
pub struct Jump {
    /// The position of the discontinuity on the line between the two solutions, from 0 to 1.
    pub share: f64,
    /// The event.
    pub event: String,
    /// The name of the state with the largest jump.
    pub state: String,
    /// The two values, on the two sides of the discontinuity, of the jumping state after the event.
    pub states: [f64; 2],
}

/// A monitor that is positive on admissible solutions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limit {
    /// The position of the monitor among all monitors.
    pub monitor: usize,
    /// The typical size of the monitor; tolerances are relative to this size.
    pub scale: f64,
    /// Whether the monitor that vanishes at the limit belongs to an event that occurs on the
    /// solutions; for example, the speed of an impact belongs to the impact. The monitor at any
    /// other limit is a distance to a surface that solutions do not reach, or the margin of a
    /// decision.
    pub passes: bool,
}

/// A solution at a limit of admissible solutions, given in the unknowns of the system on the other
/// side of the limit.
pub struct Across<'a> {
    /// The system whose solutions are the orbits on the other side of the limit.
    pub system: &'a mut dyn System,
    /// The solution at the limit, as `x = (z, p)` of the system on the other side.
    pub x: &'a [f64],
}

/// The start of a branch that emanates at a limit of admissible solutions.
pub struct Emanating {
    /// The system of equations that the solutions on the emanating branch satisfy.
    pub system: Box<dyn System>,
    /// The unknowns `z` of the solution at the limit, in the system of the emanating branch.
    pub z: Vec<f64>,
    /// The direction `(z, p)` of the emanating branch, if the equations are singular at its start;
    /// the branch is then traced only in this direction.
    pub along: Option<Vec<f64>>,
}
