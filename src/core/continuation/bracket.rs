//! Bracketing an event on the corrected branch.

use super::SpecialPoint;
use super::event::Event;
use super::hermite::{Knot, hermite};
use super::located::Located;
use super::stepper::{Place, Stepper};
use crate::core::extended::Closing;
use crate::core::test_function::Test;

/// A bracket this short, in units of the step, is a point.
const POINT: f64 = 1e-12;

/// The number of halvings that make a step a point.
fn halvings() -> i32 {
    (1.0 / POINT).log2().ceil() as i32
}

/// No more evaluations than this, beyond those of bisection.
const BEYOND_BISECTION: i32 = 1;

/// A part of the step from one place that holds the event.
pub(super) struct Bracket {
    /// The event.
    pub index: usize,
    pub low: f64,
    pub high: f64,
    pub ends: [Place; 2],
    /// The values of the event's test function at the ends.
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
                let [start, end] = self.at_ends(parameter);
                let rise = end - start;
                turn_of_cubic(low, high, rise / length)
            }
            _ => low / (low - high),
        };
        self.between(fraction.clamp(0.02, 0.98))
    }

    /// A place between the ends, on the cubic that has their tangents.
    pub fn between(&self, fraction: f64) -> Vec<f64> {
        let length = self.high - self.low;
        // The tangents' lengths are those of scaled arclength, of which the bracket is a part.
        let [a, b] = &self.ends;
        let knots = [
            Knot { u: 0.0, x: &a.unknowns, tangent: &a.tangent, speed: 1.0 },
            Knot { u: length, x: &b.unknowns, tangent: &b.tangent, speed: 1.0 },
        ];
        hermite(&knots, fraction * length)
    }

    /// A component of the unknowns at both ends.
    pub fn at_ends(&self, component: usize) -> [f64; 2] {
        [0, 1].map(|end| self.ends[end].unknowns[component])
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
    /// The whole step from a place to another one, `length` apart, in which event `index` lies.
    pub fn bracket(&mut self, index: usize, from: &Place, to: &Place, length: f64) -> Bracket {
        let level = self.events[index].test.level();
        let value = |place: &Place| place.tests[index].unwrap_or_default();
        Bracket {
            index,
            low: 0.0,
            high: length,
            ends: [from.clone(), to.clone()],
            tests: [value(from), value(to)],
            slope: level.and_then(|(quantity, _)| self.slope_of(quantity, to)),
        }
    }

    /// Cuts the bracket at a corrected point of the branch, this far behind the place; false if
    /// that fails.
    pub fn narrow(&mut self, from: &Place, row: &[f64], bracket: &mut Bracket, along: f64) -> bool {
        let index = bracket.index;
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
        bracket.ends[side] = place;
        bracket.tests[side] = test;
        bracket.slope = bracket.slope.filter(|_| side == 0);
        *(if side == 0 { &mut bracket.low } else { &mut bracket.high }) = along;
        bracket.high - bracket.low > POINT * bracket.high
    }

    /// The point at which a test function vanishes that has no defining system, by the ITP method
    /// (I. F. D. Oliveira and R. H. C. Takahashi, ACM Trans. Math. Softw. 47:5, 2020): as fast as
    /// the secant method, and never slower than bisection but for one evaluation.
    pub fn bracketed(&mut self, from: &Place, row: &[f64], bracket: &mut Bracket) -> Located {
        let whole = bracket.high - bracket.low;
        let halvings = halvings() + BEYOND_BISECTION;
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
            if !self.narrow(from, row, bracket, along) {
                break;
            }
        }
        let [a, b] = bracket.tests.map(f64::abs);
        let side = usize::from(b <= a);
        let error = self.reach(bracket);
        let event = &self.events[bracket.index];
        // What an orbit's events decide has no value that vanishes: nothing converges.
        let short = b == 0.0 || bracket.high - bracket.low <= 1e3 * POINT * whole;
        let converged = short && event.test != Test::Itinerary;
        let along = if side == 0 { bracket.low } else { bracket.high };
        let unknowns = bracket.ends[side].unknowns.clone();
        Located::of(bracket.index, event, along, unknowns, error).converged(converged)
    }

    /// How far the continued parameter changes in a bracket, and the error of its ends.
    fn reach(&self, bracket: &Bracket) -> f64 {
        let [start, end] = bracket.at_ends(self.equations.parameters_at());
        (end - start).abs() + self.parameter_error()
    }

    /// The last point before event `index` that can be recorded, by bisection, where the event
    /// itself cannot: as at the bound `p = 0` of a branch with a monitor `1/p`.
    pub fn last_recorded(
        &mut self,
        index: usize,
        from: &Place,
        to: &Place,
        length: f64,
    ) -> Located {
        let row = self.covector(&from.tangent);
        let mut bracket = self.bracket(index, from, to, length);
        for _ in 0..halvings() {
            let middle = 0.5 * (bracket.low + bracket.high);
            if !self.narrow(from, &row, &mut bracket, middle) {
                break;
            }
        }
        let error = self.reach(&bracket);
        let ends = bracket.at_ends(self.equations.parameters_at());
        let [place, _] = bracket.ends;
        let Event { kind, name, .. } = self.events[index].clone();
        let special = self.saved_point(&place, kind, &name, 0);
        let special = SpecialPoint { error, bracket: ends, converged: false, ..special };
        Located { event: Some(index), along: bracket.low, unknowns: place.unknowns, special }
    }
}
