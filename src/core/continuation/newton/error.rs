//! Errors of Newton's method.

use crate::core::failure::Failure;

/// Reasons why Newton's method failed.
#[derive(Clone, Debug, PartialEq, miette::Diagnostic, thiserror::Error)]
#[non_exhaustive]
pub enum NewtonError {
    /// The corrections of Newton's method do not decrease, even with damping.
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
        /// The last damping factor that was tried.
        damping: f64,
    },
    /// The equations or their Jacobian cannot be evaluated, or the Jacobian is singular.
    #[error("{}", evaluation(*iteration, cause))]
    #[diagnostic(forward(cause))]
    Evaluation {
        /// The number of the iteration that failed; 0 at the start.
        iteration: usize,
        /// The cause.
        #[source]
        cause: Failure,
    },
    /// Newton's method did not converge within the maximal number of iterations.
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
        /// The ratio of the norms of the last two corrections.
        contraction: f64,
    },
    /// The first correction of Newton's method is longer than the allowed
    /// [`reach`](super::Tolerances::reach).
    #[error(
        "the first correction of Newton's method has the scaled length {correction:.1e}, more than the \
         allowed {reach:.1e}: no solution is near the start"
    )]
    #[diagnostic(help("start closer to a solution, or raise `reach`"))]
    OutOfReach {
        /// The scaled norm of the first correction.
        correction: f64,
        /// The largest allowed norm.
        reach: f64,
    },
    /// The angle between the tangents at both ends of a step is too large.
    #[error(
        "the tangent turned by {angle:.2} in one step, more than the limit of {largest:.2}: the curve \
         bends too sharply for the step"
    )]
    #[diagnostic(help("lower `min_step`"))]
    Turned {
        /// The angle between the two tangents, in radians.
        angle: f64,
        /// The largest allowed angle, in radians.
        largest: f64,
    },
    /// The distance between the curve and its cubic interpolant in the step is too large.
    #[error(
        "between the ends of the step, the curve deviates from its cubic interpolant by \
         {error:.1e}, more than the allowed `curve_error` of {largest:.1e}"
    )]
    #[diagnostic(help("lower `min_step` or raise `curve_error`"))]
    Bent {
        /// The estimated distance from the cubic interpolant, in scaled arclength.
        error: f64,
        /// The value of the setting `curve_error`.
        largest: f64,
    },
    /// The step crossed to a neighbouring branch at a point where the curve turns away from that
    /// branch. The number in the error is the distance between the two branches, in scaled
    /// arclength.
    #[error(
        "the step jumps to another branch, whose distance from the traced branch is {0:.1e} where \
         the two branches are close"
    )]
    #[diagnostic(help(
        "lower `min_step`, or change the parameter that separates the two branches"
    ))]
    BranchJump(f64),
    /// The distance between the corrected and the predicted point is too large compared with the
    /// step: the corrected point may lie on another branch.
    #[error(
        "the distance between the corrected point and the predicted point is {distance:.1e} after \
         a step of {length:.1e}: another branch is near, or the curve bends too sharply for the \
         step"
    )]
    #[diagnostic(help("lower `min_step`"))]
    Far {
        /// The distance between the two points, in scaled arclength.
        distance: f64,
        /// The length of the step, in scaled arclength.
        length: f64,
    },
    /// No point of the curve was found halfway along a step of the given length: the step may have
    /// jumped to another branch.
    #[error(
        "no point of the curve was found halfway along a step of {0:.1e}: another branch is near, or the \
         curve bends too sharply for the step"
    )]
    #[diagnostic(help("lower `min_step`"))]
    NoMiddle(f64),
    /// A cycle shrank to an equilibrium in one step of the given length; an equilibrium solves the
    /// equations of a cycle with any period.
    #[error(
        "the cycle shrinks to an equilibrium in a single step of {0:.1e}: errors of rounding and \
         discretisation are too large to distinguish nearby cycles from the equilibrium"
    )]
    #[diagnostic(help("take more `intervals`, or collocation"))]
    Shrunk(f64),
    /// A step of the given length from a branch point returned to the parent branch.
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

/// Converts the error of a failed evaluation at the start of Newton's iteration.
impl From<Failure> for NewtonError {
    fn from(cause: Failure) -> Self {
        NewtonError::Evaluation { iteration: 0, cause }
    }
}
