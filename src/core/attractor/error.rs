//! Errors of stroboscopic maps and of the search for crises.

use crate::core::hybrid::HybridError;
use crate::core::problem::UnknownName;

/// Reasons why a motion cannot be sampled stroboscopically.
#[derive(Clone, Debug, PartialEq, miette::Diagnostic, thiserror::Error)]
#[non_exhaustive]
pub enum StroboscopicError {
    /// The simulation of the hybrid motion ends with an error.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Hybrid(#[from] HybridError),
    /// The system has no forcing.
    #[error("the system has no forcing, so its motion cannot be sampled once per forcing period")]
    #[diagnostic(help(
        "define a forcing (`period` in a model), or sample the motion at an event (`--at EVENT`; \
         `at` in a scene; `ReturnMap` in Rust)"
    ))]
    NoPeriod,
    /// Sampling at an event was requested, but the system has a forcing.
    #[error(
        "the system has a forcing, so its motion is sampled once per forcing period and not at an \
         event"
    )]
    #[diagnostic(help("omit the event `{0}` at which the motion should be sampled"))]
    Forced(String),
    /// A motion without forcing has not returned to its sampling event within the waiting time.
    #[error(
        "the event `{event}`, at which the motion is sampled, does not occur within a time of {within} ({units} \
         time scales), although the motion is not at rest"
    )]
    #[diagnostic(help(
        "sample at another event, wait longer (`ReturnMap::waiting`), or set the time scale (`scales`)"
    ))]
    Late {
        /// The event.
        event: String,
        /// The waiting time.
        within: f64,
        /// The waiting time in units of the system's time scale.
        units: f64,
    },
    /// The system has no measure or event of the given name, or a measure refers to a scalar that
    /// the system does not have.
    #[error(transparent)]
    #[diagnostic(transparent)]
    NoMeasure(#[from] UnknownName),
    /// No crisis was found in the interval of the parameter.
    #[error(
        "no crisis was found in {steps} steps of the parameter from {from} to {to}: a crisis lies \
         between a value at which the motion does not settle on a cycle, and later values at which \
         the motion settles on a cycle or ends"
    )]
    #[diagnostic(help(
        "change the ends of the parameter's range, or use more steps or a longer transient"
    ))]
    NoCrisis {
        /// The first value of the varied parameter.
        from: f64,
        /// The last value of the varied parameter.
        to: f64,
        /// The number of steps of the search.
        steps: usize,
    },
    /// A setting of the search for a crisis is invalid.
    #[error(transparent)]
    #[diagnostic(transparent)]
    CrisisSearch(#[from] CrisisSearchError),
    /// The iterates of a discrete map have left its range of validity.
    #[error("{0}")]
    Map(String),
}

/// Heuristic: the maximal number of steps of a search for a crisis; a larger number is most likely
/// a mistake of units.
pub(super) const MOST_STEPS: usize = 1_000_000;

/// An invalid setting of a search for a crisis.
#[derive(Clone, Debug, PartialEq, miette::Diagnostic, thiserror::Error)]
#[non_exhaustive]
pub enum CrisisSearchError {
    /// The parameter to vary does not exist in the system.
    #[error(
        "the search for a crisis varies the parameter with number {parameter}, but the system has \
         only {parameters} parameters, numbered from 0"
    )]
    Parameter {
        /// The index of the parameter to vary.
        parameter: usize,
        /// The number of the system's parameters.
        parameters: usize,
    },
    /// An end of the parameter interval is not finite.
    #[error("the search for a crisis goes from {from} to {to}, but both ends must be finite")]
    Interval {
        /// The first value of the varied parameter.
        from: f64,
        /// The last value of the varied parameter.
        to: f64,
    },
    /// The number of steps of the search is out of range.
    #[error(
        "the search for a crisis has {0} steps, but the number of steps must be between 1 and \
         {MOST_STEPS}"
    )]
    Steps(usize),
    /// The tolerance of the search is not a positive number.
    #[error(
        "the search for a crisis has a tolerance of {0}, but the tolerance must be positive and \
         finite"
    )]
    Tolerance(f64),
}
