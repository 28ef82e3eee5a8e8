//! Branch switching at branch points.

use super::corrector::Corrector;
use super::curve_point::CurvePoint;
use super::metric::ScaledNorm;
use super::newton::NewtonError;
use crate::core::bifurcation::{branches_at, vertical_reach};
use crate::core::failure::Failure;
use crate::core::linalg::{difference, dot};

/// (H) The largest ratio, for a step from a branch point, of its component along the parent branch
/// to its component along the traced branch: on the right branch the former is of second order in
/// the step.
const MOST_OF_PARENT: f64 = 0.5;

/// The start of a curve at a branch point, along a tangent other than the tangent of the parent
/// branch.
pub(super) struct Departure {
    unknowns: Vec<f64>,
    /// The two tangents, both of scaled length 1.
    tangent: Vec<f64>,
    parent: Vec<f64>,
}

impl Departure {
    /// Creates the departure from a branch point on a parent branch with the tangent `parent`.
    pub fn new(norm: &ScaledNorm, start: &CurvePoint, mut parent: Vec<f64>) -> Self {
        norm.rescale(&mut parent);
        Departure { unknowns: start.unknowns.clone(), tangent: start.tangent.clone(), parent }
    }

    /// Rejects a first step that lies on the parent branch, from its components along the two
    /// tangents.
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

/// Returns the tangents, of scaled length 1, of the branches that cross at a branch point where the
/// null space of `F_z` has this many more dimensions than at a regular point.
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

/// (R) A parameter component of a tangent, in units of its scale, that is rounding if the unknowns
/// change by their scales.
const VERTICAL: f64 = 1e-9;

/// Returns the distance along a vertical tangent at a branch point after which the parameter has
/// changed by its scale; `None` if unknown, or if the tangent is not vertical.
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
