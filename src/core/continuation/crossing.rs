//! Branch points: the directions of the branches that cross there.

use super::corrector::Corrector;
use super::curve_point::CurvePoint;
use super::metric::ScaledNorm;
use super::newton::NewtonError;
use crate::core::bifurcation::{branches_at, vertical_reach};
use crate::core::failure::Failure;
use crate::core::linalg::{difference, dot};

/// (H) The largest part of a step from a branch point along the branch that leads to it, compared
/// with the part along the branch that is traced: on the right branch the former is of second order
/// in the step.
const MOST_OF_PARENT: f64 = 0.5;

/// A branch point that a curve leaves, along a tangent that differs from that of the branch which
/// leads to it.
pub(super) struct Departure {
    unknowns: Vec<f64>,
    /// Of scaled length 1, both.
    tangent: Vec<f64>,
    parent: Vec<f64>,
}

impl Departure {
    /// From a branch point to which a branch with the tangent `parent` leads.
    pub fn new(norm: &ScaledNorm, start: &CurvePoint, mut parent: Vec<f64>) -> Self {
        norm.rescale(&mut parent);
        Departure { unknowns: start.unknowns.clone(), tangent: start.tangent.clone(), parent }
    }

    /// Refuses a first step that lies on the branch one comes from: the step from the branch point
    /// is resolved into parts along both tangents.
    pub fn check(
        &self,
        norm: &ScaledNorm,
        unknowns: &[f64],
        length: f64,
    ) -> Result<(), NewtonError> {
        let step = difference(unknowns, &self.unknowns);
        let [along, back] = [&self.tangent, &self.parent].map(|t| norm.covector(t));
        let (a, b, cosine) = (dot(&along, &step), dot(&back, &step), dot(&along, &self.parent));
        // Up to the determinant 1 − cosine².
        let parts = [a - cosine * b, b - cosine * a];
        match parts[1].abs() > MOST_OF_PARENT * parts[0].abs() {
            true => Err(NewtonError::SameBranch(length)),
            false => Ok(()),
        }
    }
}

/// The tangents, of scaled length 1, of the branches that cross at a branch point where `F_z` has a
/// null space of this dimension beyond that of a regular point.
///
/// # Errors
/// [`Failure::Undetermined`] where the algebraic bifurcation equations do not determine any.
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

/// (R) The part of a tangent along the parameter, in units of its scale, that is rounding where the
/// unknowns move by theirs.
const VERTICAL: f64 = 1e-9;

/// How far a tangent at a branch point goes until the parameter has moved by its scale, if the
/// tangent is vertical and that is known.
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
