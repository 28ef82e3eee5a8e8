//! A part of an interval that holds an event.

use super::corrector::Corrector;
use super::curve_point::{CurvePoint, Interval};
use super::event::Event;
use super::hermite::{Knot, hermite};
use crate::core::bifurcation::{Bracketed, TestFunction};

/// (R) A bracket this short, in units of the step, is a point: 1e4 ε, since differences of points
/// in it lose all but four digits.
pub(super) const POINT: f64 = 1e-12;

/// The number of halvings that make a step a point.
pub(super) fn halvings() -> i32 {
    (1.0 / POINT).log2().ceil() as i32
}

/// A part of an interval that holds an event.
pub(super) struct Bracket {
    /// The event's position among those of the curve.
    pub index: usize,
    pub low: f64,
    pub high: f64,
    pub ends: [CurvePoint; 2],
    /// The values of the event's test function at the ends.
    pub tests: [f64; 2],
    /// How fast the test function grows at the second end, if that is known.
    pub slope: Option<f64>,
    /// Whether the event is in neither half of the bracket: counts that changed do so by several
    /// other events.
    pub is_empty: bool,
}

impl Bracket {
    /// The whole interval.
    pub fn new(
        corrector: &mut Corrector,
        Interval { from, to, length }: Interval,
        (index, event): (usize, &Event),
    ) -> Self {
        let value = |place: &CurvePoint| place.tests[index].unwrap_or_default();
        let level = event.test.level();
        Bracket {
            index,
            low: 0.0,
            high: length,
            tests: [value(from), value(to)],
            slope: level.and_then(|(quantity, _)| corrector.slope_of(quantity, to.on_curve())),
            ends: [from.clone(), to.clone()],
            is_empty: false,
        }
    }

    /// Where the test function probably vanishes; the continued parameter is at the position
    /// `parameter` in `X`.
    pub fn guess(&self, test: &dyn TestFunction, parameter: usize) -> Vec<f64> {
        let [start, end] = self.at_ends(parameter);
        let fraction = test.guess(&Bracketed {
            values: self.tests,
            length: self.high - self.low,
            rise: end - start,
            slope: self.slope,
        });
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

    /// How far the continued parameter changes, and the error of the ends.
    pub fn reach(&self, corrector: &Corrector) -> f64 {
        let [start, end] = self.at_ends(corrector.equations.parameters_at());
        (end - start).abs() + corrector.parameter_error()
    }

    /// A component of the unknowns at both ends.
    pub fn at_ends(&self, component: usize) -> [f64; 2] {
        [0, 1].map(|end| self.ends[end].unknowns[component])
    }
}
