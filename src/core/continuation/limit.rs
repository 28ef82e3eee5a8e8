//! Points at which a curve is its own mirror image: a test function changes sign there, and everything else is even in it.
//! The curve goes back over itself beyond, and its equations are singular there, so that the values are limits.

use super::event::Test;
use super::found::Found;
use super::hermite::hermite;
use super::predictor::knots_of;
use super::stepper::{Place, Stepper};
use crate::core::extended::Closing;

/// Values of the test function, as shares of that at the beginning of the step, at which the curve is sampled: as near to
/// the end as its equations, which are singular there, allow.
const SHARES: [f64; 11] = [0.8, 0.65, 0.5, 0.4, 0.3, 0.2, 0.15, 0.12, 0.09, 0.06, 0.04];

/// How many samples make a polynomial, at least and at most.
const SAMPLES: [usize; 2] = [3, 5];

impl Stepper<'_> {
    /// The point between two places, `length` apart, where event `index` vanishes: the limit of polynomials in the square
    /// of its test function.
    pub fn limit(&mut self, index: usize, from: &Place, to: &Place, length: f64) -> Option<Found> {
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
        let at = |i: usize, first: usize| {
            let values = tests[first..].iter().zip(&places[first..]);
            even_limit(values.map(|(u, x)| (u * u, x[i])))
        };
        let mut unknowns: Vec<f64> = (0..from.unknowns.len()).map(|i| at(i, 0)).collect();
        if let Test::Own { unknown, level } = self.events[index].test {
            unknowns[self.equations.dimension() + unknown] = level;
        }
        let parameter = self.equations.parameters_at();
        // The rougher limit leaves out the sample that is farthest.
        let error = 4.0 * (unknowns[parameter] - at(parameter, 1)).abs() + self.parameter_error();
        Some(Found { along: root, unknowns, error, converged: true })
    }

    /// The value of a test function in which a curve is its own mirror image.
    pub fn mirrored(&mut self, test: Test, unknowns: &[f64]) -> Option<f64> {
        match test {
            Test::Amplitude => {
                let x = self.equations.load(unknowns).to_vec();
                self.equations.system().cycles()?.amplitude(&x)
            }
            Test::Own { unknown, level } => {
                Some(unknowns[self.equations.dimension() + unknown] - level)
            }
            _ => None,
        }
    }
}

/// The value at 0 of the polynomial through points (Lagrange).
fn even_limit(points: impl Iterator<Item = (f64, f64)>) -> f64 {
    let points: Vec<(f64, f64)> = points.collect();
    let weight = |k: usize| -> f64 {
        let others = points.iter().enumerate().filter(|(j, _)| *j != k);
        others.map(|(_, (v, _))| v / (v - points[k].0)).product()
    };
    points.iter().enumerate().map(|(k, (_, value))| weight(k) * value).sum()
}
