//! Pairs of events within one step: a test function that has the same sign at both ends of a step may
//! have changed it twice.

use super::event::Test;
use super::stepper::{Before, Place, Step, Stepper};
use crate::core::extended::Closing;
use crate::core::vector::advanced;

/// An extremum predicted to come this near to zero, compared with the ends, is looked at.
const NEAR: f64 = 0.3;

/// Trial points spent on one extremum.
const TRIALS: usize = 4;

impl Stepper<'_> {
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
