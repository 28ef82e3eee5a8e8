//! Bracketing an event on the corrected branch.

use super::found::Found;
use super::hermite::{Knot, hermite};
use super::stepper::{Place, Stepper};
use crate::core::extended::Closing;
use crate::core::test_function::Test;

/// A bracket this short, in units of the step, is a point.
const POINT: f64 = 1e-12;

/// No more evaluations than this, beyond those of bisection.
const BEYOND_BISECTION: i32 = 1;

/// A part of the step from one place that holds the event.
pub(super) struct Bracket {
    pub low: f64,
    pub high: f64,
    pub ends: [Vec<f64>; 2],
    pub tangents: [Vec<f64>; 2],
    pub tests: [f64; 2],
    /// How fast the test function grows at the second end, if that is known.
    pub slope: Option<f64>,
}

impl Bracket {
    /// Where the test function would vanish if it were linear; the middle if only its sign counts.
    /// At a fold it is the slope of the parameter (at this position in `X`), which a cubic knows
    /// better.
    pub fn guess(&self, test: Test, parameter: usize) -> Vec<f64> {
        let [low, high] = self.tests;
        let length = self.high - self.low;
        let fraction = match (test, self.slope) {
            (test, _) if test.is_sign() => 0.5,
            (_, Some(slope)) => zero_of_parabola(low, high, slope * length),
            (Test::Fold, _) => {
                let rise = self.ends[1][parameter] - self.ends[0][parameter];
                turn_of_cubic(low, high, rise / length)
            }
            _ => low / (low - high),
        };
        self.between(fraction.clamp(0.02, 0.98))
    }

    /// A place between the ends, on the cubic that has their tangents.
    pub fn between(&self, fraction: f64) -> Vec<f64> {
        let [a, b] = &self.ends;
        let [s, t] = &self.tangents;
        let length = self.high - self.low;
        // The tangents' lengths are those of scaled arclength, of which the bracket is a part.
        let knots = [
            Knot { u: 0.0, x: a, tangent: s, speed: 1.0 },
            Knot { u: length, x: b, tangent: t, speed: 1.0 },
        ];
        hermite(&knots, fraction * length)
    }
}

/// Where a parabola vanishes that goes from `low` to `high`, of the other sign, on the interval
/// from 0 to 1, and ends with this `slope`.
fn zero_of_parabola(low: f64, high: f64, slope: f64) -> f64 {
    // high + slope (s − 1) + c (s − 1)²
    let c = low - high + slope;
    let root = (slope * slope - 4.0 * c * high).max(0.0).sqrt();
    // Of both roots the one without cancellation: the parabola passes zero once between the ends.
    1.0 - 2.0 * high / (slope + root.copysign(high - low))
}

/// Where the slope of a cubic vanishes that goes from `low` to `high`, of the other sign, on the
/// interval from 0 to 1, with this `mean`.
fn turn_of_cubic(low: f64, high: f64, mean: f64) -> f64 {
    // low (1 − s) + high s + 6 c s (1 − s), the integral of which is the mean.
    let c = mean - 0.5 * (low + high);
    let (a, b) = (-6.0 * c, high - low + 6.0 * c);
    let root = (b * b - 4.0 * a * low).sqrt();
    // Of both roots the one without cancellation, which is the one inside.
    -2.0 * low / (b + root.copysign(high - low))
}

impl Stepper<'_> {
    /// Cuts the bracket at a corrected point of the branch, this far behind the place; false if
    /// that fails.
    pub fn narrow(
        &mut self,
        index: usize,
        from: &Place,
        row: &[f64],
        bracket: &mut Bracket,
        along: f64,
    ) -> bool {
        let mut unknowns = bracket.between((along - bracket.low) / (bracket.high - bracket.low));
        let closing = Closing { row, base: &from.unknowns, length: along };
        let Ok(report) = self.correct(&mut unknowns, closing) else { return false };
        let event = &self.events[index];
        let stability =
            event.test.needs_eigenvalues() || event.condition.is_none() && self.wants_stability();
        let arrived = self.arrive(unknowns, row, report.matrix_error, stability);
        let Ok(place) = arrived else { return false };
        let Some(test) = place.tests[index] else { return false };
        let side = usize::from((test < 0.0) != (bracket.tests[0] < 0.0));
        bracket.ends[side] = place.unknowns;
        bracket.tangents[side] = place.tangent;
        bracket.tests[side] = test;
        bracket.slope = bracket.slope.filter(|_| side == 0);
        *(if side == 0 { &mut bracket.low } else { &mut bracket.high }) = along;
        bracket.high - bracket.low > POINT * bracket.high
    }

    /// The point at which a test function vanishes that has no defining system, by the ITP method
    /// (I. F. D. Oliveira and R. H. C. Takahashi, ACM Trans. Math. Softw. 47:5, 2020): as fast as
    /// the secant method, and never slower than bisection but for one evaluation.
    pub fn bracketed(
        &mut self,
        index: usize,
        from: &Place,
        row: &[f64],
        bracket: &mut Bracket,
    ) -> Found {
        let whole = bracket.high - bracket.low;
        let halvings = (1.0 / POINT).log2().ceil() as i32 + BEYOND_BISECTION;
        for done in 0..halvings {
            let (low, high, [a, b]) = (bracket.low, bracket.high, bracket.tests);
            if b == 0.0 {
                break;
            }
            let (width, middle) = (high - low, 0.5 * (low + high));
            let secant = (b * low - a * high) / (b - a);
            let towards = (middle - secant).signum();
            let shift = 0.2 * width * width / whole;
            let moved =
                if shift <= (middle - secant).abs() { secant + towards * shift } else { middle };
            let reach = POINT * whole * 2.0_f64.powi(halvings - done - 1) - 0.5 * width;
            let near = (moved - middle).abs() <= reach;
            let along = if near { moved } else { middle - towards * reach.max(0.0) };
            if !self.narrow(index, from, row, bracket, along) {
                break;
            }
        }
        let [a, b] = bracket.tests.map(f64::abs);
        let side = usize::from(b <= a);
        let p = self.equations.parameters_at();
        let error = (bracket.ends[1][p] - bracket.ends[0][p]).abs() + self.parameter_error();
        let converged = b == 0.0 || bracket.high - bracket.low <= 1e3 * POINT * whole;
        let along = if side == 0 { bracket.low } else { bracket.high };
        let (unknowns, own) = (bracket.ends[side].clone(), Vec::new());
        Found { along, unknowns, own, error, converged }
    }
}
