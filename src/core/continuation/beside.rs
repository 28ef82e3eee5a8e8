//! Steps onto another branch: where two branches come near each other without crossing, a long step goes straight on, from one to the
//! other.

use super::event::Test;
use super::stepper::{Place, Step, Stepper};
use crate::core::extended::Closing;
use crate::core::newton::{NewtonError, scaled_norm};
use crate::core::vector::along;

/// Branches nearer than this, in scaled arclength, cross: discretised equations with a symmetry that their meshes do not have miss a
/// branch point by as much.
const CROSSING: f64 = 3e-4;

impl Stepper<'_> {
    /// Refuses a step that has passed a branch point which is not on the curve.
    ///
    /// The defining system of branch points unfolds the problem, `F + β b = 0`. Where `β ≠ 0` at its solution, branches turn away from
    /// each other instead of crossing. With a point of the curve at a distance `s`, of which the linearised equations have the solution
    /// at a distance `d`, they are `2 √(d s)` apart, as `u v = d s` is at the bend.
    pub fn stays(&mut self, from: &Place, step: &Step) -> Result<(), NewtonError> {
        let index = self.events.iter().position(|event| event.test == Test::BranchPoint);
        let Some(index) = index.filter(|_| self.held.is_empty()) else { return Ok(()) };
        if from.tests[index] * step.place.tests[index] >= 0.0 {
            return Ok(());
        }
        let event = self.events[index].clone();
        let middle = from.unknowns.iter().zip(&step.place.unknowns).map(|(a, b)| 0.5 * (a + b));
        // What is no branch point at all is left to the events.
        let Ok((point, _)) = self.finish(&event, middle.collect()) else { return Ok(()) };
        let row = self.covector(&from.tangent);
        let length = along(&row, &point, &from.unknowns);
        if !(0.0..=step.length).contains(&length) {
            return Ok(());
        }
        let closing = Closing { row: &row, base: &from.unknowns, length };
        let mut miss = vec![0.0; point.len()];
        self.equations.assemble(&from.unknowns)?;
        self.equations.factor(Some(&row))?;
        self.equations.residual(&point, Some(closing), &mut miss)?;
        self.equations.solve(&mut miss);
        let gap = 2.0 * (scaled_norm(&miss, &self.weights) * length).sqrt();
        if gap > CROSSING { Err(NewtonError::Beside { gap }) } else { Ok(()) }
    }
}
