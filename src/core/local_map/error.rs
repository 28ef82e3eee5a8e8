//! Why there is no local map, or none that can be trusted.

use crate::core::failure::{Failure, FlowError};
use crate::core::ode::SettingsError;
use crate::core::problem::UnknownName;
use crate::core::scalar::JetError;

/// Why a local map cannot be computed, or used.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum GrazingError {
    /// The orbit, its linearisation or its multipliers cannot be computed, or no branch emanates at
    /// it.
    #[error(transparent)]
    Failure(#[from] Failure),
    /// The order or the number of variables is too high.
    #[error(transparent)]
    Jet(#[from] JetError),
    /// A setting of the flow has no meaning.
    #[error(transparent)]
    Settings(#[from] SettingsError),
    /// There is no such parameter, or no such measure.
    #[error("{0}")]
    Unknown(#[from] UnknownName),
    /// A grazing point that does not belong to the system.
    #[error("the grazing point does not belong to the system: {0}")]
    Foreign(String),
    /// Deviations of another number than there are coordinates or parameters.
    #[error("{found} deviations of {what} are given, there are {expected}")]
    Length {
        /// Coordinates or parameters.
        what: &'static str,
        /// How many are given.
        found: usize,
        /// How many there are.
        expected: usize,
    },
    /// The phase of a period has no meaning.
    #[error("the phase grows by {0} in a period of the forcing: it should be a positive number")]
    Phase(f64),
    /// The order is none.
    #[error("a local map has at least order 1, not {0}")]
    Order(usize),
    /// What happens at the grazing is of a higher order than the map's.
    #[error(
        "a local map of order 1 does not tell what happens at a grazing where the discontinuity map has no root: take order 2 or \
         more"
    )]
    NoRoot,
    /// The touched mode has too few states for coordinates on a section.
    #[error(
        "at the touch of guard `{guard}`, the guard and its rate do not determine two states of mode \
         `{mode}` (their gradients are dependent to {pivot:.1e}): a local map needs a guard whose rate can \
         be changed by itself"
    )]
    NoSection {
        /// The guard.
        guard: String,
        /// The mode.
        mode: String,
        /// What is left of the second gradient.
        pivot: f64,
    },
    /// The orbit does not touch at the point.
    #[error(
        "the orbit does not touch guard `{guard}` at t = {time:.9e}: the guard is {value:.1e} and its rate \
         {rate:.1e} there, both should vanish; locate the grazing (G) first"
    )]
    NoTouch {
        /// The guard.
        guard: String,
        /// When.
        time: f64,
        /// The guard.
        value: f64,
        /// Its rate.
        rate: f64,
    },
    /// The guard has no quadratic minimum.
    #[error(
        "guard `{guard}` has no quadratic minimum along the orbit at t = {time:.9e}, where it is touched: \
         its second rate is {curvature:.3e}, and should be positive"
    )]
    Curvature {
        /// The guard.
        guard: String,
        /// When.
        time: f64,
        /// The second rate.
        curvature: f64,
    },
    /// A flow ends.
    #[error("in mode `{mode}`: {source}")]
    Flow {
        /// The mode.
        mode: String,
        /// Why.
        source: FlowError,
    },
    /// An event is not where it is expected.
    #[error(
        "the motion in mode `{mode}` does not come to {surface} near t = {time:.9e}: Newton's iteration \
         still moves it by {step:.1e}; give durations of the legs that are nearer, or locate the grazing (G) \
         first"
    )]
    NotReached {
        /// The mode.
        mode: String,
        /// What is not reached.
        surface: String,
        /// When.
        time: f64,
        /// The last change of the time.
        step: f64,
    },
    /// Motion that is back on the touched surface at once ends there for the touching orbit only.
    #[error(
        "the motion that begins at a touch of guard `{touched}` ends at once by guard `{back}`, but beside the touch both \
         surfaces lie {left:.1e} apart: there is no local map in powers of the root of the penetration; state both guards by one \
         function"
    )]
    Apart {
        /// The guard that is touched.
        touched: String,
        /// The guard that ends what follows.
        back: String,
        /// How far the surfaces are apart, as a coefficient in units of the scales.
        left: f64,
    },
    /// The orbit does not come back to the touch.
    #[error(
        "the orbit does not return to the touch: after one turn coordinate `{coordinate}` is {missed:.3e} \
         away; give the durations of its legs, and locate the grazing (G) first"
    )]
    NoReturn {
        /// The coordinate that is farthest away.
        coordinate: String,
        /// By how much.
        missed: f64,
    },
    /// Newton's iteration for the grazing orbit does not converge.
    #[error(
        "no grazing orbit near the point for parameter `{parameter}`: after {iterations} iterations the \
         orbit misses its start by {residual:.1e}; begin nearer, or take another parameter"
    )]
    NotLocated {
        /// The parameter that was free.
        parameter: String,
        /// The number of iterations.
        iterations: usize,
        /// What is left.
        residual: f64,
    },
    /// Too far from grazing.
    #[error(
        "the local map of order {order} is used too far from grazing: its last order still changes the \
         image by {estimate:.1e}, where {tolerance:.1e} is allowed, at a penetration of {penetration:.1e}; \
         take a higher order or come nearer"
    )]
    TooFar {
        /// The order.
        order: usize,
        /// The estimate of the error.
        estimate: f64,
        /// The error allowed.
        tolerance: f64,
        /// The penetration, negative on this side of the surface.
        penetration: f64,
    },
}
