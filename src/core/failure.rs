//! Defines the errors of equations that cannot be evaluated or solved.
//!
//! ```
//! use tangency::core::failure::Failure;
//! use tangency::core::linalg::{Border, BorderedLu};
//! use tangency::core::system::{Dense, System};
//! use tangency::problems::classic::ParallelPlate;
//! // The plate's deflection u = 1.5 lies beyond the electrode.
//! let failure = Dense::new(ParallelPlate).residual(&[1.5, 0.1], &mut [0.0]).unwrap_err();
//! let message = failure.to_string();
//! assert!(message.starts_with("u = 1.500000e0 is outside the domain of the equations"));
//! // The matrix [1 2; 2 4] is singular.
//! let failure = BorderedLu::default().factor(&[1.0, 2.0, 2.0, 4.0], Border::NONE).unwrap_err();
//! assert!(matches!(failure, Failure::Singular { pivot: 0.0, .. }));
//! ```

use super::cancel::Cancelled;
use miette::Diagnostic;

/// A pivot of a factorisation counts as zero if it is smaller than this fraction of the largest
/// pivot of an equilibrated matrix, or of the largest entry of its row.
pub(in crate::core) const SINGULAR: f64 = 1e-15;

/// Returns the message of an error with its help, in one line: `message; help`.
///
/// ```
/// use tangency::core::failure::{OutOfDomain, one_line};
/// let error = OutOfDomain::new("u", 1.5, "keep u below 1");
/// assert_eq!(one_line(&error), "u = 1.500000e0 is outside the domain of the equations; keep u below 1");
/// ```
pub fn one_line(error: &dyn Diagnostic) -> String {
    error.help().map_or(error.to_string(), |help| format!("{error}; {help}"))
}

/// Implements `Debug` as the message with its help: a program whose `main` returns the error prints
/// this text.
macro_rules! debug_is_message {
    ($($error:ty),* $(,)?) => {$(
        impl std::fmt::Debug for $error {
            fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
                f.write_str(&$crate::core::failure::one_line(self))
            }
        }
    )*};
}
pub(crate) use debug_is_message;

/// A value outside the domain of the equations.
#[derive(Clone, Debug, PartialEq, miette::Diagnostic, thiserror::Error)]
#[error("{quantity} = {value:.6e} is outside the domain of the equations")]
#[diagnostic(help("{remedy}"))]
pub struct OutOfDomain {
    /// The name of the quantity whose value is outside its domain.
    pub quantity: String,
    /// The offending value.
    pub value: f64,
    /// The domain of the quantity, or a remedy.
    pub remedy: String,
}

impl OutOfDomain {
    /// Creates the error for a value outside its domain.
    pub fn new(quantity: impl Into<String>, value: f64, remedy: impl Into<String>) -> Self {
        OutOfDomain { quantity: quantity.into(), value, remedy: remedy.into() }
    }
}

/// The error of a trajectory that ended early, with the reason.
#[derive(Clone, Debug, PartialEq, miette::Diagnostic, thiserror::Error)]
#[non_exhaustive]
pub enum FlowError {
    /// The trajectory leaves the domain of the field.
    #[error("at t = {time:.9e}: {left}")]
    #[diagnostic(forward(left))]
    OutOfDomain {
        /// The time.
        time: f64,
        /// The quantity that left its domain.
        left: OutOfDomain,
    },
    /// The computation was cancelled.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Cancelled(#[from] Cancelled),
    /// A state, its slope or the result of a step is not finite.
    #[error(
        "at t = {time:.9e}: the state {state} or its time derivative is not finite ({value:e})"
    )]
    #[diagnostic(help("end the flow before the field becomes undefined"))]
    NotFinite {
        /// The time.
        time: f64,
        /// The name of the state that is not finite.
        state: String,
        /// The value of the state that is not finite.
        value: f64,
    },
    /// The step size became too small for the tolerance: the solution or a derivative of the field is
    /// singular.
    #[error(
        "at t = {time:.9e} even a time step of {step:.1e} is too large: the solution blows up, or \
         the vector field is not smooth"
    )]
    #[diagnostic(help(
        "if the solution blows up, a state leaves the domain of the model, as at pull-in: integrate \
         over a shorter time, or end the motion by an event; if the vector field is not smooth, \
         split the integration there"
    ))]
    StepTooSmall {
        /// The time.
        time: f64,
        /// The step size, in units of time, that is too large for the tolerance.
        step: f64,
    },
    /// The flow took more steps than allowed.
    #[error(
        "at t = {time:.9e} the integration reached the limit of {steps} steps; the length of the \
         last step was {step:.1e}"
    )]
    #[diagnostic(help(
        "allow more steps, loosen the tolerance, split the time interval, or use the implicit \
         method Rodas5P if the vector field is stiff"
    ))]
    TooManySteps {
        /// The time.
        time: f64,
        /// The number of steps that the flow took.
        steps: usize,
        /// The size of the last step, in units of time.
        step: f64,
    },
    /// Stability, not accuracy, limits the step size of an explicit method.
    #[error(
        "at t = {time:.9e} the vector field is stiff: a step of {step:.1e}, multiplied by the \
         fastest rate of the field, is {product:.1}, the stability limit of the explicit method"
    )]
    #[diagnostic(help("use the implicit method Rodas5P"))]
    Stiff {
        /// The time.
        time: f64,
        /// The size of the step at the limit of stability, in units of time.
        step: f64,
        /// The estimate of `h |λ|`: the step size times the fastest rate of the field.
        product: f64,
    },
}

impl FlowError {
    /// Whether an explicit method failed because the field is stiff or possibly stiff.
    pub fn is_stiff(&self) -> bool {
        matches!(self, FlowError::Stiff { .. } | FlowError::TooManySteps { .. })
    }
}

/// The reason why equations cannot be evaluated or solved.
#[derive(Clone, Debug, PartialEq, miette::Diagnostic, thiserror::Error)]
#[non_exhaustive]
pub enum Failure {
    /// The point lies outside the domain of the equations.
    #[error(transparent)]
    #[diagnostic(transparent)]
    OutOfDomain(#[from] OutOfDomain),
    /// A number that must be finite is infinite or NaN.
    #[error("{quantity} = {value:.6e} is not finite")]
    #[diagnostic(help("{remedy}"))]
    NotFinite {
        /// The name of the number that is not finite.
        quantity: String,
        /// The number.
        value: f64,
        /// The remedy.
        remedy: String,
    },
    /// A matrix is singular to working accuracy (16 digits).
    #[error(
        "the matrix is singular: one pivot is {pivot:.1e}, and the largest pivot is {largest:.1e}"
    )]
    #[diagnostic(help("{}", of_singular(*pivot)))]
    Singular {
        /// The smallest pivot.
        pivot: f64,
        /// The largest pivot.
        largest: f64,
    },
    /// A Krylov method did not solve a linear system.
    #[error(
        "the Krylov method did not solve a linear system: after {iterations} iterations, the \
         relative residual is {residual:.1e}, but at most {allowed:.0e} is usable"
    )]
    #[diagnostic(help(
        "use a preconditioner that is closer to the inverse of F_z, or factor F_z with `Sparse` or \
         `Dense`"
    ))]
    Unsolved {
        /// The number of iterations.
        iterations: usize,
        /// The residual, relative to the right-hand side.
        residual: f64,
        /// The largest relative residual of a usable solution.
        allowed: f64,
    },
    /// A trajectory ended early.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Flow(#[from] FlowError),
    /// The computation was cancelled.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Cancelled(#[from] Cancelled),
    /// Deviations, and rounding errors with them, grow so much over a shooting segment that too few
    /// digits are left.
    #[error(
        "deviations and rounding errors grow by {0:.1e} over a segment, which leaves too few digits"
    )]
    #[diagnostic(help("use more shooting segments, or the collocation method"))]
    Growth(f64),
    /// A segment of a trial solution lasts longer than allowed: Newton's iteration diverges.
    #[error(
        "a segment of a trial solution lasts {duration:.3e}, longer than the limit of {longest:.3e} (ten times \
         the last solution): Newton's iteration diverges"
    )]
    #[diagnostic(help("take smaller steps"))]
    Astray {
        /// The duration of the segment of the trial solution.
        duration: f64,
        /// The longest duration.
        longest: f64,
    },
    /// The iteration for eigenvalues or Floquet multipliers did not converge.
    #[error(
        "the iteration for the {0} does not converge: entries of the matrix are possibly not \
         finite, or of very different sizes"
    )]
    Eigenvalues(&'static str),
    /// No complex pair of eigenvalues or Floquet multipliers can become critical.
    #[error(
        "no complex pair of eigenvalues is near the imaginary axis, and no complex pair of \
         multipliers is near the unit circle: the point is not a Hopf or torus point, but possibly \
         a neutral saddle"
    )]
    NoComplexPair,
    /// The equations do not determine the requested result at this point; the message gives the
    /// reason.
    #[error("{0}")]
    Undetermined(String),
    /// The system or problem does not support the requested operation.
    #[error("{0}")]
    Unsupported(String),
    /// The requested index of a branch at a special point is too large.
    #[error(
        "the other branch with index {which} does not exist: {count} other branches begin or cross \
         at this point, numbered from 0"
    )]
    NoBranch {
        /// The requested index.
        which: usize,
        /// The number of other branches that begin or cross at the special point.
        count: usize,
    },
    /// A solution, a position or a setting does not fit the problem.
    #[error("{0}")]
    Mismatch(String),
}

impl Failure {
    /// Creates the error for a number that is not finite.
    pub fn not_finite(quantity: impl Into<String>, value: f64, remedy: impl Into<String>) -> Self {
        Failure::NotFinite { quantity: quantity.into(), value, remedy: remedy.into() }
    }

    /// Creates the error for a branch index that is too large: `count` other branches begin or cross
    /// at the special point.
    pub fn no_branch(which: usize, count: usize) -> Self {
        Failure::NoBranch { which, count }
    }

    /// Extends the name of the quantity in the error by the place at which the quantity has its
    /// value.
    pub(in crate::core) fn at(mut self, place: std::fmt::Arguments) -> Self {
        if let Failure::OutOfDomain(OutOfDomain { quantity, .. })
        | Failure::NotFinite { quantity, .. } = &mut self
        {
            *quantity = format!("{quantity} {place}");
        }
        self
    }
}

fn of_singular(pivot: f64) -> &'static str {
    match pivot == 0.0 {
        true => {
            "check that every equation is written, and that every unknown occurs in at least one \
             equation"
        }
        false => "continue by arclength at a fold, or start away from the singular point",
    }
}

/// Creates the error for a pivot that is NaN, or that vanishes relative to the largest pivot.
pub(in crate::core) fn unusable(pivot: f64, largest: f64) -> Failure {
    match pivot.is_nan() {
        true => Failure::not_finite("a pivot", pivot, "all entries of the matrix must be finite"),
        false => Failure::Singular { pivot, largest },
    }
}

/// Returns an error if a number in a list is not finite; `name` gives the name of the number at a
/// position.
pub(crate) fn finite(
    numbers: &[f64],
    name: impl FnOnce(usize) -> String,
    remedy: &str,
) -> Result<(), Failure> {
    match not_finite(numbers) {
        Some(i) => Err(Failure::not_finite(name(i), numbers[i], remedy)),
        None => Ok(()),
    }
}

/// The position of the first infinite or NaN number in a list.
pub(in crate::core) fn not_finite(numbers: &[f64]) -> Option<usize> {
    let any = numbers.iter().fold(false, |any, number| any | !number.is_finite());
    if any { numbers.iter().position(|number| !number.is_finite()) } else { None }
}

/// The help of the errors for derivatives that are not finite.
pub(in crate::core) const DIFFERENTIABLE: &str =
    "the residual must be differentiable at this point (√x is not differentiable at x = 0)";

/// Returns an error if a component of a gradient, with respect to an unknown or a released
/// parameter, is infinite or NaN.
pub(crate) fn finite_gradient(
    gradient: &[f64],
    dimension: usize,
    released: &[usize],
) -> Result<(), Failure> {
    let (by_unknowns, by_parameters) = gradient.split_at(dimension);
    finite(by_unknowns, |i| format!("a derivative with respect to unknown {i}"), DIFFERENTIABLE)?;
    let wrong = released.iter().find(|p| !by_parameters[**p].is_finite());
    wrong.map_or(Ok(()), |&p| {
        let quantity = format!("a derivative with respect to parameter {p}");
        Err(Failure::not_finite(quantity, by_parameters[p], DIFFERENTIABLE))
    })
}

/// Creates the error for a derivative of an order that systems do not provide.
pub(crate) fn unknown_order(order: usize) -> Failure {
    Failure::Unsupported(format!("derivatives of order {order} are not supported"))
}
