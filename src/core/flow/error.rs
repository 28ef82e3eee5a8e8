//! Why a flow cannot be computed.

use crate::core::domain::OutOfDomain;
use crate::core::interruption::Interrupted;

/// A setting of a flow without a meaning.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SettingsError {
    /// A tolerance is negative, not a number, or too small for arithmetic of 16 digits.
    #[error(
        "the tolerances of a flow are {relative:.1e} (relative) and {absolute:.1e} (absolute): \
         take a relative one of at least 1e-15, and an absolute one that is positive"
    )]
    Tolerance {
        /// The relative tolerance.
        relative: f64,
        /// The absolute tolerance.
        absolute: f64,
    },
    /// The first or the largest step is not a positive part of the whole.
    #[error("a step of a flow is a part of the whole: {0} is not between 0 and 1")]
    Step(f64),
    /// No step is allowed.
    #[error("a flow needs at least one step: allow more than 0")]
    Steps,
}

/// Why a trajectory ends before its time.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FlowError {
    /// The trajectory leaves the domain of the field.
    #[error("at t = {time:.9e}: {left}")]
    OutOfDomain {
        /// When.
        time: f64,
        /// What left which domain.
        left: OutOfDomain,
    },
    /// The work was given up.
    #[error(transparent)]
    Interrupted(#[from] Interrupted),
    /// A state, its slope or what comes of a step is not finite.
    #[error(
        "at t = {time:.9e}: state {state} or its slope is not finite ({value:e}); end the flow before the field \
         loses its meaning"
    )]
    NotFinite {
        /// When.
        time: f64,
        /// The name of the state.
        state: String,
        /// What the number is.
        value: f64,
    },
    /// No step is small enough for the tolerance: the solution or a derivative of the field is
    /// singular.
    #[error(
        "at t = {time:.9e} no step is small enough, not even {step:.1e}: the solution blows up or the \
         field is not smooth; end the flow earlier, or split it where the field changes"
    )]
    StepTooSmall {
        /// When.
        time: f64,
        /// The step, in units of time.
        step: f64,
    },
    /// More steps than allowed.
    #[error(
        "at t = {time:.9e} the flow has taken all {steps} steps it may, the last one of {step:.1e}: allow \
         more steps, loosen the tolerance, split the interval, or use the implicit method if the field is stiff"
    )]
    TooManySteps {
        /// When.
        time: f64,
        /// The number of steps.
        steps: usize,
        /// The last step, in units of time.
        step: f64,
    },
    /// Stability, not accuracy, limits the steps of an explicit method.
    #[error(
        "at t = {time:.9e} the field is stiff: steps of {step:.1e} times its fastest rate make \
         {product:.1}, where stability ends; use the implicit method"
    )]
    Stiff {
        /// When.
        time: f64,
        /// The step, in units of time.
        step: f64,
        /// The estimate of `h |λ|`.
        product: f64,
    },
}
