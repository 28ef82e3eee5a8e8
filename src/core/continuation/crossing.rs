//! Branch switching at branch points.

use super::corrector::Corrector;
use super::curve_point::CurvePoint;
use super::metric::ScaledNorm;
use super::newton::NewtonError;
use crate::core::bifurcation::{branches_at, vertical_reach};
use crate::core::failure::Failure;
use crate::core::linalg::{difference, dot};

/// Heuristic: the largest ratio of two components of the first step from a branch point: its
/// component along the parent branch, and its component along the traced branch. If the step stays
/// on the traced branch, its component along the parent branch is of second order in the step.
const MOST_OF_PARENT: f64 = 0.5;

/// The start of a curve at a branch point, along the tangent of a branch other than the parent
/// branch.
pub(super) struct Departure {
    unknowns: Vec<f64>,
    /// The tangents of the parent branch and of the traced branch, both of scaled length 1.
    tangent: Vec<f64>,
    parent: Vec<f64>,
}

impl Departure {
    /// Creates the start at a branch point of a parent branch, whose tangent is `parent`.
    pub fn new(norm: &ScaledNorm, start: &CurvePoint, mut parent: Vec<f64>) -> Self {
        norm.rescale(&mut parent);
        Departure { unknowns: start.unknowns.clone(), tangent: start.tangent.clone(), parent }
    }

    /// Rejects a first step if its components along the two tangents show that it stays on the
    /// parent branch.
    pub fn check(
        &self,
        norm: &ScaledNorm,
        unknowns: &[f64],
        length: f64,
    ) -> Result<(), NewtonError> {
        let step = difference(unknowns, &self.unknowns);
        let [along, back] = [&self.tangent, &self.parent].map(|t| norm.covector(t));
        let (a, b, cosine) = (dot(&along, &step), dot(&back, &step), dot(&along, &self.parent));
        // The components, up to the determinant 1 − cosine².
        let parts = [a - cosine * b, b - cosine * a];
        match parts[1].abs() > MOST_OF_PARENT * parts[0].abs() {
            true => Err(NewtonError::SameBranch(length)),
            false => Ok(()),
        }
    }
}

/// Returns the tangents, of scaled length 1, of the branches that cross at a branch point. The
/// dimension of the null space of `F_z` at the branch point exceeds its dimension at a regular
/// point by the given number.
///
/// # Errors
/// [`Failure::Undetermined`] if the algebraic bifurcation equations do not determine a tangent.
pub(super) fn tangents_at_crossing(
    corrector: &mut Corrector,
    unknowns: &[f64],
    multiplicity: usize,
) -> Result<Vec<Vec<f64>>, Failure> {
    corrector.equations.load(unknowns);
    let parameter = corrector.equations.released[0];
    let directions = branches_at(corrector.equations.at(), parameter, multiplicity)?;
    let unloaded = directions.iter().map(|direction| {
        let mut tangent = corrector.equations.unload(direction);
        corrector.norm.rescale(&mut tangent);
        tangent
    });
    Ok(unloaded.collect())
}

/// Rounding: a parameter component of a tangent smaller than this threshold, in units of its scale,
/// is zero up to rounding if the unknowns change by their scales.
const VERTICAL: f64 = 1e-9;

/// Returns the distance from a branch point, along a branch with a vertical tangent there, at which
/// the parameter has changed by its scale; `None` if the distance is unknown, or if the tangent is
/// not vertical.
pub(super) fn reach_at_crossing(
    corrector: &mut Corrector,
    unknowns: &[f64],
    tangent: &[f64],
    multiplicity: usize,
) -> Option<f64> {
    if corrector.slope(tangent).abs() > VERTICAL * corrector.norm.of(tangent) {
        return None;
    }
    let scale = corrector.norm.scaled(corrector.equations.parameters_at(), 1.0).recip();
    corrector.equations.load(unknowns);
    let direction = corrector.equations.direction_of(tangent);
    let parameter = corrector.equations.released[0];
    let at = corrector.equations.at();
    vertical_reach(at, (parameter, multiplicity), scale, &direction).ok()?
}
