//! What a long step passes unseen: pairs of events, at which a test function has the same sign at
//! both ends of the step; and the way over to another branch, where two come near each other
//! without crossing.

use super::hermite::hermite;
use super::located::Located;
use super::predictor::knots_of;
use super::stepper::{Before, MOST_DISTANT, Place, Step, Stepper};
use super::test_values::turns;
use crate::core::extended::Closing;
use crate::core::newton::{NewtonError, scaled_norm};
use crate::core::vector::{difference, dot};

/// Branches nearer than this, in scaled arclength, cross: discretised equations with a symmetry
/// that their meshes do not have miss a branch point by as much.
const CROSSING: f64 = 3e-4;

/// An extremum predicted to come this near to zero, compared with the ends, is looked at.
const NEAR: f64 = 0.3;

/// Trial points spent on one extremum.
const TRIALS: usize = 4;

impl Stepper<'_> {
    /// Refuses a step that has passed a branch point which is not on the curve.
    ///
    /// The defining system of branch points unfolds the problem, `F + β b = 0`. Where `β ≠ 0` at
    /// its solution, branches turn away from each other instead of crossing. With a point of the
    /// curve at a distance `s`, of which the linearised equations have the solution at a distance
    /// `d`, they are `2 √(d s)` apart, as `u v = d s` is at the bend.
    pub fn stays(&mut self, from: &Place, step: &Step) -> Result<(), NewtonError> {
        let index = self.branch_points().filter(|_| self.held.is_empty());
        let passed = |i: &usize| turns(from.tests[*i], step.place.tests[*i]);
        let Some(index) = index.filter(passed) else { return Ok(()) };
        let event = self.events[index].clone();
        let middle = from.unknowns.iter().zip(&step.place.unknowns).map(|(a, b)| 0.5 * (a + b));
        // What is no branch point at all is left to the events.
        let row = self.covector(&from.tangent);
        let finished = self.finish(&event, middle.collect(), (&row, from));
        let Ok(Located { along: length, unknowns: point, .. }) = finished else { return Ok(()) };
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

    /// A shorter step, to a place between `from` and the end of `step` where some test function has
    /// the other sign than at both: found where the parabola through its last three values has an
    /// extremum close to zero or beyond.
    pub fn hidden(&mut self, before: &Before, from: &Place, step: &Step) -> Option<Step> {
        (0..self.events.len()).find_map(|index| {
            let places = [&before.place, from, &step.place];
            let values = places.map(|place| self.smooth_test(index, place));
            let [Some(a), Some(b), Some(c)] = values else { return None };
            let lengths = [-before.length, 0.0, step.length];
            (b * c > 0.0).then(|| self.search(index, (from, step), lengths, [a, b, c])).flatten()
        })
    }

    fn search(
        &mut self,
        index: usize,
        (from, step): (&Place, &Step),
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
            let predicted = hermite(&knots_of(from, (&step.place, step.length), &row), length);
            let mut unknowns = predicted.clone();
            let closing = Closing { row: &row, base: &from.unknowns, length };
            let report = self.correct(&mut unknowns, closing).ok()?;
            let distance = scaled_norm(&difference(&unknowns, &predicted), &self.weights);
            if distance > MOST_DISTANT * length {
                return None;
            }
            // Eigenvalues are computed where they decide, and where the step is to end.
            let decide = self.events[index].test.is_spectral() && self.wants_stability();
            let mut place = self.arrive(unknowns, &row, report.matrix_error, decide).ok()?;
            if dot(&row, &place.tangent) < self.settings.max_angle.cos() {
                return None;
            }
            let test = self.smooth_test(index, &place)?;
            if sign * test < 0.0 {
                if !decide && self.wants_stability() {
                    place = self.arrive(place.unknowns, &row, f64::INFINITY, true).ok()?;
                }
                let next = end - length;
                let crossings = self.crossings(from, &row, length, &mut place);
                return Some(Step { place, length, next, crossings });
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
