//! Errors of the computation of local maps.

use crate::core::failure::{Failure, FlowError};
use crate::core::ode::SettingsError;
use crate::core::problem::UnknownName;
use crate::core::scalar::JetError;

/// Reasons why a local map cannot be computed or used.
#[derive(Clone, Debug, PartialEq, miette::Diagnostic, thiserror::Error)]
#[non_exhaustive]
pub enum GrazingError {
    /// The orbit, its linearisation or its multipliers cannot be computed, or no branch emanates
    /// from the point.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Failure(#[from] Failure),
    /// The order of the polynomials or the number of their variables is too high.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Jet(#[from] JetError),
    /// A setting of the integration is invalid.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Settings(#[from] SettingsError),
    /// The named parameter or measure does not exist.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Unknown(#[from] UnknownName),
    /// The grazing point does not belong to the system.
    #[error("the grazing point does not belong to the system: {0}")]
    Foreign(String),
    /// The number of deviations differs from the number of coordinates or parameters.
    #[error(
        "{found} deviations of {what} are given, but the local map needs {expected} deviations"
    )]
    Length {
        /// `coordinates` or `parameters`.
        what: &'static str,
        /// The number of given deviations.
        found: usize,
        /// The number of coordinates or parameters of the map, as expected.
        expected: usize,
    },
    /// The phase of a forcing period is invalid.
    #[error(
        "the phase of the forcing grows by {0} in a forcing period, but this increment must be \
         positive"
    )]
    Phase(f64),
    /// The order of the map is 0, but must be at least 1.
    #[error("the order of a local map must be at least 1, not {0}")]
    Order(usize),
    /// The order of the map is too low for the dynamics near the grazing.
    #[error(
        "a local map of order 1 cannot classify a grazing whose discontinuity map has no \
         square-root term"
    )]
    #[diagnostic(help("take order 2 or more"))]
    NoRoot,
    /// The grazed mode has too few independent states for coordinates on a section.
    #[error(
        "a local map needs a guard whose rate varies independently of its value, but at the \
         grazing point of guard `{guard}` in mode `{mode}` the gradients of the guard and of its \
         rate are linearly dependent, to {pivot:.1e}"
    )]
    NoSection {
        /// The guard.
        guard: String,
        /// The mode.
        mode: String,
        /// The relative length of the part of one gradient (of the guard or of its rate) that is
        /// orthogonal to the other gradient.
        pivot: f64,
    },
    /// The orbit does not graze the guard's surface at the given point.
    #[error(
        "the orbit does not graze guard `{guard}` at t = {time:.9e}: the value of the guard is \
         {value:.1e} and its rate is {rate:.1e}, but both must vanish"
    )]
    #[diagnostic(help("locate the grazing (G) first"))]
    NoTouch {
        /// The guard.
        guard: String,
        /// The time.
        time: f64,
        /// The value of the guard at the given point.
        value: f64,
        /// The rate of change of the guard along the motion.
        rate: f64,
    },
    /// The guard has no quadratic minimum along the orbit.
    #[error(
        "guard `{guard}` has no quadratic minimum along the orbit at the grazing point, t = {time:.9e}: \
         the second derivative of the guard with respect to time is {curvature:.3e}, but must be positive"
    )]
    Curvature {
        /// The guard.
        guard: String,
        /// The time.
        time: f64,
        /// The second derivative of the guard with respect to time.
        curvature: f64,
    },
    /// A flow ends.
    #[error("in mode `{mode}`: {source}")]
    #[diagnostic(forward(source))]
    Flow {
        /// The mode.
        mode: String,
        /// The cause.
        source: FlowError,
    },
    /// An event of the orbit does not occur near its expected time.
    #[error(
        "the motion in mode `{mode}` does not reach {surface} near t = {time:.9e}: the last Newton \
         step for the time is {step:.1e}"
    )]
    #[diagnostic(help(
        "give more accurate durations of the orbit's legs, or locate the grazing (G) first"
    ))]
    NotReached {
        /// The mode.
        mode: String,
        /// The name of the surface that is not reached.
        surface: String,
        /// The time.
        time: f64,
        /// The last change of the event's time in Newton's method.
        step: f64,
    },
    /// The motion from the grazing point ends immediately at another guard, and near the grazing
    /// point the surface of that guard differs from the grazed surface.
    #[error(
        "the motion from the grazing point of guard `{touched}` ends immediately at guard \
         `{back}`, but near the grazing point the surfaces of the two guards are {left:.1e} apart: \
         no local map in powers of the square root of the penetration exists"
    )]
    #[diagnostic(help("use the same function for the two guards"))]
    Apart {
        /// The name of the guard that the orbit grazes.
        touched: String,
        /// The name of the guard at which the motion from the grazing point ends immediately.
        back: String,
        /// The coefficient that measures the distance between the surface of the grazed guard and
        /// the surface of the guard `back`, in units of the scales.
        left: f64,
    },
    /// The orbit does not return to the grazing point.
    #[error(
        "the orbit does not return to its grazing point: after one period, the coordinate \
         `{coordinate}` differs from the grazing point by {missed:.3e}"
    )]
    #[diagnostic(help(
        "give the durations of the legs of the orbit, and locate the grazing (G) first"
    ))]
    NoReturn {
        /// The name of the coordinate that deviates most from the grazing point after one period.
        coordinate: String,
        /// The deviation.
        missed: f64,
    },
    /// Newton's method for the grazing orbit does not converge.
    #[error(
        "no grazing orbit was found near the point by varying parameter `{parameter}`: after \
         {iterations} Newton iterations, the end of the orbit misses its start by {residual:.1e}"
    )]
    #[diagnostic(help("start closer to the grazing orbit, or release another parameter"))]
    NotLocated {
        /// The released parameter.
        parameter: String,
        /// The number of Newton iterations.
        iterations: usize,
        /// The remaining residual.
        residual: f64,
    },
    /// The local map is evaluated at a point too far from grazing.
    #[error(
        "the local map of order {order} is used too far from grazing: the terms of the highest \
         order change the image by {estimate:.1e} (allowed: {tolerance:.1e}) at a penetration of \
         {penetration:.1e}"
    )]
    #[diagnostic(help("use a local map of higher order, or a point closer to grazing"))]
    TooFar {
        /// The order of the local map.
        order: usize,
        /// The estimated error.
        estimate: f64,
        /// The allowed error.
        tolerance: f64,
        /// The penetration at the point at which the local map is evaluated; negative if the motion
        /// does not reach the surface.
        penetration: f64,
    },
}
