//! What is known of periodic solutions as closed curves: the same one may be given from any of its points.

use super::failure::Failure;
use super::solution::Solution;

/// Periodic solutions as closed curves: their phase, how often they repeat themselves, their amplitude.
pub trait Cycles {
    /// The unknowns, on the present mesh, of solutions that are the same as a saved one but for the point that they begin
    /// at: in the phase of the solution accepted last, or one for each period of the forcing that it lasts, at times near those
    /// of the solution `near`.
    ///
    /// # Errors
    /// [`Failure`] if the saved solution is not one of this problem.
    fn images(&mut self, solution: &Solution, near: &[f64]) -> Result<Vec<Vec<f64>>, Failure>;

    /// Whether a solution goes through everything twice, so that it has half the period.
    fn repeats(&mut self, x: &[f64]) -> bool;

    /// The oscillation of a cycle about its mean, as a share of that of the cycle accepted last: it changes sign where
    /// a family of cycles passes through an equilibrium. `None` if cycles cannot shrink to equilibria.
    fn amplitude(&mut self, x: &[f64]) -> Option<f64>;

    /// The period, if it is free: not one that a forcing prescribes.
    fn free_period(&mut self, x: &[f64]) -> Option<f64>;

    /// The estimated relative error of a solution that its mesh causes.
    fn mesh_error(&mut self, x: &[f64]) -> f64;
}
