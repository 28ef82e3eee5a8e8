//! Branch points: the directions of the branches that cross there.

use super::stepper::{Departure, Place, Stepper};
use crate::core::bifurcation::branches_at;
use crate::core::condition::Failure;
use crate::core::newton::{NewtonError, scale_to_one};
use crate::core::vector::{difference, dot};

/// The part along the branch one comes from that a step from a branch point may have, compared with
/// that along the branch that is traced.
const MOST_OF_PARENT: f64 = 0.5;

impl Stepper<'_> {
    /// How a curve leaves a branch point that it starts from, to which a branch with the tangent
    /// `parent` leads.
    pub fn departure(&self, start: &Place, mut parent: Vec<f64>) -> Departure {
        self.rescale(&mut parent);
        Departure { unknowns: start.unknowns.clone(), tangent: start.tangent.clone(), parent }
    }

    /// The tangents, of scaled length 1, of the branches that cross at a branch point where `F_z`
    /// has a null space of this dimension beyond that of a regular point.
    ///
    /// # Errors
    /// [`Failure::Undetermined`] where the algebraic bifurcation equations do not determine any.
    pub fn tangents_at_crossing(
        &mut self,
        unknowns: &[f64],
        multiplicity: usize,
    ) -> Result<Vec<Vec<f64>>, Failure> {
        self.equations.load(unknowns);
        let parameter = self.equations.released()[0];
        let directions = branches_at(self.equations.at(), parameter, multiplicity)?;
        let mut tangents: Vec<Vec<f64>> =
            directions.iter().map(|direction| self.equations.unload(direction)).collect();
        for tangent in &mut tangents {
            self.rescale(tangent);
        }
        Ok(tangents)
    }

    /// Scales a direction to length 1; the length that it had.
    pub fn rescale(&self, direction: &mut [f64]) -> f64 {
        scale_to_one(direction, &self.weights)
    }

    /// Refuses a first step that lies on the branch one comes from: the step from the branch point
    /// is resolved into parts along both tangents.
    pub fn departs(&self, unknowns: &[f64], length: f64) -> Result<(), NewtonError> {
        let Some(Departure { unknowns: start, tangent, parent }) = &self.departure else {
            return Ok(());
        };
        let step = difference(unknowns, start);
        let (along, back) = (self.covector(tangent), self.covector(parent));
        let (a, b, cosine) = (dot(&along, &step), dot(&back, &step), dot(&along, parent));
        // Up to the determinant 1 − cosine².
        let parts = [a - cosine * b, b - cosine * a];
        match parts[1].abs() > MOST_OF_PARENT * parts[0].abs() {
            true => Err(NewtonError::SameBranch(length)),
            false => Ok(()),
        }
    }
}
