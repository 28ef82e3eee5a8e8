//! Why a motion cannot be followed period by period.

use crate::core::hybrid::HybridError;
use crate::core::problem::UnknownName;

/// Why a motion cannot be followed period by period.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum StroboscopicError {
    /// The hybrid motion ends.
    #[error(transparent)]
    Hybrid(#[from] HybridError),
    /// There is no forcing.
    #[error(
        "the system has no forcing, so its motion cannot be sampled once a period: state one (`HybridSystem::forcing`, \
         `period`), or sample it at an event (`--at EVENT`, `at` in a scene's sweep, `ReturnMap`)"
    )]
    NoPeriod,
    /// Sampling at an event was asked for, but the system has a forcing.
    #[error(
        "the system has a forcing, and its motion is sampled once a period: leave out that it is sampled at the event `{0}`"
    )]
    Forced(String),
    /// A motion without forcing has not come back to the event at which it is sampled so far.
    #[error(
        "the event `{event}`, at which the motion is sampled, does not come within a time of {within}, though the motion is not \
         at rest: sample it at another event, wait longer (`ReturnMap::waiting`), or state the scale of time (`scales`), of which \
         {units} are waited for"
    )]
    Late {
        /// The event.
        event: String,
        /// How long it was waited for.
        within: f64,
        /// The same in units of the scale of time.
        units: f64,
    },
    /// A measure or an event that the system does not have, or a scalar of a measure.
    #[error("{0}")]
    NoMeasure(#[from] UnknownName),
    /// No attractor is lost.
    #[error(
        "there is no crisis in {steps} steps from {from} to {to}: motion must be on no cycle at one of them, and on a cycle, or \
         end, at the last one; move the ends, take more steps, or a longer transient"
    )]
    NoCrisis {
        /// Where the search begins.
        from: f64,
        /// Where it ends.
        to: f64,
        /// In how many steps.
        steps: usize,
    },
    /// A setting of the search for a crisis is invalid.
    #[error(transparent)]
    CrisisSearch(#[from] CrisisSearchError),
    /// A map has left the place where it means anything.
    #[error("{0}")]
    Map(String),
}

/// (H) The largest number of steps of a search for a crisis: more would be a mistake of units.
pub(super) const MOST_STEPS: usize = 1_000_000;

/// An invalid setting of a search for a crisis.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CrisisSearchError {
    /// The system has no such parameter.
    #[error(
        "a crisis is sought along parameter {parameter}, but the system has {parameters} parameters, counted from 0"
    )]
    Parameter {
        /// The position of the parameter.
        parameter: usize,
        /// The number of parameters.
        parameters: usize,
    },
    /// An end of the interval is not finite.
    #[error("a crisis is sought from {from} to {to}: both ends must be finite")]
    Interval {
        /// Where the search begins.
        from: f64,
        /// Where it ends.
        to: f64,
    },
    /// The number of steps is out of range.
    #[error("a crisis is sought in {0} steps: their number must be from 1 to {MOST_STEPS}")]
    Steps(usize),
    /// The tolerance is not a positive number.
    #[error("a crisis is sought to a tolerance of {0}: the tolerance must be positive and finite")]
    Tolerance(f64),
}
