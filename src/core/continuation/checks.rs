//! What a long step passes unseen: pairs of events, at which a test function has the same sign at both ends of the
//! step; the start, where a curve is closed; and the way over to another branch, where two come near each other without
//! crossing.

use super::event::Test;
use super::stepper::{Before, Place, Step, Stepper};
use crate::core::extended::Closing;
use crate::core::newton::{NewtonError, scaled_norm};
use crate::core::vector::{advanced, along, difference, dot};

/// Branches nearer than this, in scaled arclength, cross: discretised equations with a symmetry that their meshes do not have miss a
/// branch point by as much.
const CROSSING: f64 = 3e-4;

/// An extremum predicted to come this near to zero, compared with the ends, is looked at.
const NEAR: f64 = 0.3;

/// Trial points spent on one extremum.
const TRIALS: usize = 4;

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
        if gap > CROSSING { Err(NewtonError::Beside(gap)) } else { Ok(()) }
    }

    /// How far along a step it passes through the start, in the start's direction: a Newton correction
    /// at the start's own distance along the step decides.
    pub fn passes(&mut self, start: &Place, from: &Place, step: &Step) -> Option<f64> {
        let row = self.covector(&from.tangent);
        let offset = difference(&start.unknowns, &from.unknowns);
        let (along, alignment) = (dot(&row, &offset), dot(&row, &start.tangent));
        let distance = scaled_norm(&offset, &self.weights);
        if !(0.0..=step.length).contains(&along) || distance > 1.5 * step.length || alignment < 0.0
        {
            return None;
        }
        let whole = difference(&step.place.unknowns, &from.unknowns);
        let mut unknowns = advanced(&from.unknowns, along / step.length, &whole);
        let closing = Closing { row: &row, base: &from.unknowns, length: along };
        self.correct(&mut unknowns, closing).ok()?;
        let miss = scaled_norm(&difference(&unknowns, &start.unknowns), &self.weights);
        (miss < 1e3 * self.settings.tolerance.max(1e-12)).then_some(along)
    }

    /// A shorter step, to a place between `from` and the end of `step` where some test function has
    /// the other sign than at both: found where the parabola through its last three values has an
    /// extremum close to zero or beyond. Only the sign of a determinant or of a spectrum's product is
    /// no smooth function, so that pairs of branch points and Hopf points in one step are not seen.
    pub fn hidden(&mut self, before: &Before, from: &Place, step: &Step) -> Option<Step> {
        (0..self.events.len()).find_map(|index| {
            let smooth = !matches!(self.events[index].test, Test::BranchPoint | Test::Hopf);
            let values = [before.place.tests[index], from.tests[index], step.place.tests[index]];
            let one_sign = values[1] * values[2] > 0.0;
            let places = [-before.length, 0.0, step.length];
            (smooth && one_sign).then(|| self.search(index, from, places, values)).flatten()
        })
    }

    fn search(
        &mut self,
        index: usize,
        from: &Place,
        mut at: [f64; 3],
        mut values: [f64; 3],
    ) -> Option<Step> {
        let (sign, end) = (values[1].signum(), at[2]);
        let row = self.covector(&from.tangent);
        for _ in 0..TRIALS {
            let (length, value) = extremum(at, values)?;
            let least = values[1].abs().min(values[2].abs());
            let inside = length > 1e-3 * end && length < (1.0 - 1e-3) * end;
            if !inside || sign * value > NEAR * least {
                return None;
            }
            let mut unknowns = advanced(&from.unknowns, length, &from.tangent);
            let closing = Closing { row: &row, base: &from.unknowns, length };
            let report = self.correct(&mut unknowns, closing).ok()?;
            let stability = self.held.is_empty();
            let place = self.arrive(unknowns, &row, report.matrix_error, stability).ok()?;
            let test = place.tests[index];
            if sign * test < 0.0 {
                return Some(Step { place, length, next: end - length });
            }
            // The three that enclose the smallest.
            let [a, b, c] = at;
            let [fa, fb, fc] = values;
            (at, values) = if length > b {
                ([b, length, c], [fb, test, fc])
            } else {
                ([a, length, b], [fa, test, fb])
            };
        }
        None
    }
}

/// Where the parabola through three points has its extremum, and its value there.
fn extremum(at: [f64; 3], values: [f64; 3]) -> Option<(f64, f64)> {
    let slope = |i: usize, j: usize| (values[j] - values[i]) / (at[j] - at[i]);
    let curvature = (slope(1, 2) - slope(0, 1)) / (at[2] - at[0]);
    let middle = slope(0, 1) + curvature * (at[1] - at[0]);
    let offset = -0.5 * middle / curvature;
    offset.is_finite().then(|| (at[1] + offset, values[1] + 0.5 * middle * offset))
}
