//! Equations in one unknown, on which Newton's iteration and steps are tried.

use crate::core::failure::OutOfDomain;
use crate::core::problem::{Names, ZeroProblem};
use crate::core::scalar::Scalar;

/// `λ/(1 − u)² = u`, the parallel-plate actuator in its units of length and force: it pulls in at
/// `u = 1/3`, `λ = 4/27`.
///
/// ```
/// use tangency::core::problem::ZeroProblem;
/// use tangency::problems::classic::ParallelPlate;
/// let mut r = [1.0_f64];
/// ParallelPlate.residual(&[1.0 / 3.0], &[4.0 / 27.0], &mut r);
/// assert!(r[0].abs() < 1e-15 && ParallelPlate.domain(&[1.0], &[0.0]).is_err());
/// ```
#[derive(Clone, Copy, Debug)]
pub struct ParallelPlate;

impl ZeroProblem for ParallelPlate {
    fn names(&self) -> Names {
        Names::new(["u"], ["load"])
    }

    fn residual<T: Scalar>(&self, u: &[T], p: &[T], r: &mut [T]) {
        r[0] = p[0] / (T::one() - u[0]).powi(2) - u[0];
    }

    fn domain(&self, u: &[f64], _p: &[f64]) -> Result<(), OutOfDomain> {
        if u[0] < 1.0 {
            return Ok(());
        }
        Err(OutOfDomain::new("u", u[0], "the plate touches the electrode at u = 1"))
    }
}

/// `x² = μ² + ε²`: two branches, `2ε` apart at `μ = 0`, where each turns by a right angle with the
/// curvature `1/ε`. They cross for `ε = 0` only; else the branch point between them is on neither.
///
/// ```
/// use tangency::core::problem::ZeroProblem;
/// use tangency::problems::classic::Hyperbola;
/// let mut r = [1.0];
/// Hyperbola.residual(&[5.0], &[3.0, 4.0], &mut r);
/// assert_eq!(r, [0.0]);
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Hyperbola;

impl ZeroProblem for Hyperbola {
    fn names(&self) -> Names {
        Names::new(["x"], ["mu", "epsilon"])
    }

    fn residual<T: Scalar>(&self, x: &[T], p: &[T], r: &mut [T]) {
        r[0] = x[0] * x[0] - p[0] * p[0] - p[1] * p[1];
    }
}
