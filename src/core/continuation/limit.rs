//! Points at which a curve is its own mirror image: a test function changes sign there, and
//! everything else is even in it. The curve goes back over itself beyond, and its equations are
//! singular there, so that the values are limits.

use super::hermite::hermite;
use super::located::Located;
use super::predictor::knots_of;
use super::stepper::{Place, Stepper};
use super::unexplained::interpolated;
use crate::core::extended::Closing;

/// Values of the test function, as shares of that at the beginning of the step, at which the curve
/// is sampled: as near to the end as its equations, which are singular there, allow.
const SHARES: [f64; 11] = [0.8, 0.65, 0.5, 0.4, 0.3, 0.2, 0.15, 0.12, 0.09, 0.06, 0.04];

/// How many samples make a polynomial, at least and at most.
const SAMPLES: [usize; 2] = [3, 5];

impl Stepper<'_> {
    /// The point between two places, `length` apart, where event `index` vanishes: the limit of
    /// polynomials in the square of its test function.
    pub fn limit(
        &mut self,
        index: usize,
        from: &Place,
        to: &Place,
        length: f64,
    ) -> Option<Located> {
        let row = self.covector(&from.tangent);
        let test = self.events[index].test;
        let before = self.mirrored(test, &from.unknowns)?;
        let after = self.mirrored(test, &to.unknowns)?;
        let root = length * before / (before - after);
        let knots = knots_of(from, (to, length), &row);
        let (mut tests, mut places) = (vec![before], vec![from.unknowns.clone()]);
        for share in SHARES {
            let along = root * (1.0 - share);
            let mut unknowns = hermite(&knots, along);
            let closing = Closing { row: &row, base: &from.unknowns, length: along };
            if self.correct(&mut unknowns, closing).is_err() {
                break;
            }
            tests.push(self.mirrored(test, &unknowns)?);
            places.push(unknowns);
        }
        let [least, most] = SAMPLES;
        if tests.len() < least {
            return None;
        }
        let farther = tests.len().saturating_sub(most);
        tests.drain(..farther);
        places.drain(..farther);
        let squares: Vec<f64> = tests.iter().map(|test| test * test).collect();
        let at = |i: usize, first: usize| {
            let values: Vec<f64> = places[first..].iter().map(|x| x[i]).collect();
            interpolated(&squares[first..], &values, 0.0)
        };
        let mut unknowns: Vec<f64> = (0..from.unknowns.len()).map(|i| at(i, 0)).collect();
        if let Some((unknown, level)) = self.events[index].test.own() {
            unknowns[self.equations.dimension() + unknown] = level;
        }
        let parameter = self.equations.parameters_at();
        // The rougher limit leaves out the sample that is farthest.
        let error = 4.0 * (unknowns[parameter] - at(parameter, 1)).abs() + self.parameter_error();
        Some(Located::of(index, &self.events[index], root, unknowns, error))
    }
}
