//! Errors of Newton's method.

use crate::core::failure::Failure;

/// Reasons why Newton's method failed.
#[derive(Clone, Debug, PartialEq, miette::Diagnostic, thiserror::Error)]
#[non_exhaustive]
pub enum NewtonError {
    /// The corrections do not shrink, even with damping.
    #[error(
        "Newton stagnated after {iterations} iterations at a scaled correction of {correction:.1e} (damping \
         {damping:.1e})"
    )]
    #[diagnostic(help("start closer to a solution; near a fold, use continuation by arclength"))]
    Stagnation {
        /// The number of factorisations.
        iterations: usize,
        /// The scaled norm of the last correction.
        correction: f64,
        /// The last damping factor.
        damping: f64,
    },
    /// The equations or their matrix cannot be evaluated, or the matrix is singular.
    #[error("{}", evaluation(*iteration, cause))]
    #[diagnostic(forward(cause))]
    Evaluation {
        /// The iteration; 0 at the start.
        iteration: usize,
        /// The cause.
        #[source]
        cause: Failure,
    },
    /// The maximal number of iterations was reached.
    #[error(
        "Newton's method did not converge in {iterations} iterations: the last scaled correction \
         is {correction:.1e}, and the contraction factor is {contraction:.2}"
    )]
    #[diagnostic(help("raise `max_iterations` or loosen `tolerance`"))]
    IterationLimit {
        /// The number of factorisations.
        iterations: usize,
        /// The scaled norm of the last correction.
        correction: f64,
        /// The ratio of the last two corrections.
        contraction: f64,
    },
    /// The tangent turned too far in one step.
    #[error(
        "the tangent turned by {angle:.2} in one step, more than the limit of {largest:.2}: the curve \
         bends too sharply for the step"
    )]
    #[diagnostic(help("lower `min_step`"))]
    Turned {
        /// The angle in radians.
        angle: f64,
        /// The largest allowed angle.
        largest: f64,
    },
    /// The curve between the ends of the step is too far from a cubic.
    #[error(
        "between the ends of the step, the curve deviates from its cubic interpolant by \
         {error:.1e}, more than the allowed `curve_error` of {largest:.1e}"
    )]
    #[diagnostic(help("lower `min_step` or raise `curve_error`"))]
    Bent {
        /// The estimated distance in scaled arclength.
        error: f64,
        /// The value of the setting `curve_error`.
        largest: f64,
    },
    /// The step crossed to a neighbouring branch, at this distance in scaled arclength, where the
    /// curve turns away from that branch.
    #[error(
        "the step jumps to another branch, whose distance from the traced branch is {0:.1e} where \
         the two branches are close"
    )]
    #[diagnostic(help(
        "lower `min_step`, or change the parameter that separates the two branches"
    ))]
    BranchJump(f64),
    /// The corrected point is far from the predicted one, relative to the step: it may belong to
    /// another branch.
    #[error(
        "the distance between the corrected point and the predicted point is {distance:.1e} after \
         a step of {length:.1e}: another branch is near, or the curve bends too sharply for the \
         step"
    )]
    #[diagnostic(help("lower `min_step`"))]
    Far {
        /// The distance in scaled arclength.
        distance: f64,
        /// The length of the step.
        length: f64,
    },
    /// No point of the curve was found halfway along a step of this length: the step may have
    /// skipped a bend to another branch.
    #[error(
        "no point of the curve was found halfway along a step of {0:.1e}: another branch is near, or the \
         curve bends too sharply for the step"
    )]
    #[diagnostic(help("lower `min_step`"))]
    NoMiddle(f64),
    /// A cycle shrank to an equilibrium, which solves the equations with any period, in one step of
    /// this length.
    #[error(
        "the cycle shrinks to an equilibrium in a single step of {0:.1e}: errors of rounding and \
         discretisation are too large to distinguish nearby cycles from the equilibrium"
    )]
    #[diagnostic(help("take more `intervals`, or collocation"))]
    Shrunk(f64),
    /// A step of this length from a branch point returned to the parent branch.
    #[error(
        "a step of {0:.1e} from the branch point returned to the parent branch: the second \
         derivatives do not determine the direction of the other branch"
    )]
    SameBranch(f64),
}

fn evaluation(iteration: usize, cause: &Failure) -> String {
    match cause {
        Failure::Singular { .. } => format!(
            "{cause} in Newton iteration {iteration}; the point is possibly a fold or branch point with respect to \
             the released parameters"
        ),
        Failure::Unsupported(_) | Failure::Mismatch(_) | Failure::NoBranch { .. } => {
            cause.to_string()
        }
        _ => format!("{cause} (in iteration {iteration})"),
    }
}

/// Converts an evaluation that failed at the start of the iteration.
impl From<Failure> for NewtonError {
    fn from(cause: Failure) -> Self {
        NewtonError::Evaluation { iteration: 0, cause }
    }
}
