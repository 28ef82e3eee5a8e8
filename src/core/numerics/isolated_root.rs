//! Isolated roots of systems of equations that have several roots, by Newton's method from many starts.

use crate::core::linalg::generic;
use nalgebra::{DMatrix, DVector};

/// The maximal number of iterations.
const ITERATIONS: usize = 60;

/// Heuristic: the longest correction. A longer correction leaves the region in which the equations are
/// nearly linear.
const LONGEST: f64 = 0.5;

/// Rounding: the iteration has converged if the correction is shorter than this threshold.
const CONVERGED: f64 = 1e-13;

/// Rounding: a root is isolated if all pivots of the Jacobian are larger than this threshold.
const ISOLATED: f64 = 1e-7;

/// Returns a fixed pseudo-random direction of length 1, from which a search for roots begins.
pub(crate) fn starting_direction(count: usize, seed: usize) -> DVector<f64> {
    (DVector::from_vec(generic(count, seed)) - DVector::repeat(count, 0.1)).normalize()
}

/// Finds a root of a system of equations by Newton's method; `None` if the root is not isolated, or if the
/// method does not converge. `linearised` returns the left sides of the equations and their Jacobian; the
/// coefficients of the equations must be of the order of 1.
pub(crate) fn isolated_root(
    mut y: DVector<f64>,
    linearised: impl Fn(&DVector<f64>) -> (DVector<f64>, DMatrix<f64>),
) -> Option<DVector<f64>> {
    for _ in 0..ITERATIONS {
        let (residual, jacobian) = linearised(&y);
        let lu = jacobian.lu();
        let isolated = lu.u().diagonal().iter().all(|pivot| pivot.abs() > ISOLATED);
        let correction = lu.solve(&residual)?;
        let length = correction.norm();
        if !length.is_finite() {
            return None;
        }
        y -= correction * (LONGEST / length).min(1.0);
        if length < CONVERGED {
            return isolated.then_some(y);
        }
    }
    None
}
