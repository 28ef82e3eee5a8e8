//! Brackets: subintervals of a step that contain an event.

use super::corrector::Corrector;
use super::curve_point::{CurvePoint, Interval};
use super::event::Event;
use super::hermite::{Knot, hermite};
use crate::core::bifurcation::{Bracketed, TestFunction};

/// Rounding: a bracket shorter than this threshold, in units of the step, counts as a point. The
/// threshold for the length of a bracket is 1e4 ε: differences between points in a shorter bracket
/// have fewer than four correct digits.
pub(super) const POINT: f64 = 1e-12;

/// The number of bisections that reduce a step to a point.
pub(super) fn halvings() -> i32 {
    (1.0 / POINT).log2().ceil() as i32
}

/// A subinterval of a step that contains an event.
pub(super) struct Bracket {
    /// The index of the event among all events of the curve.
    pub index: usize,
    pub low: f64,
    pub high: f64,
    pub ends: [CurvePoint; 2],
    /// The values of the event's test function at the two ends of the bracket.
    pub tests: [f64; 2],
    /// The derivative of the event's test function at the second end of the bracket, if known.
    pub slope: Option<f64>,
    /// Whether neither half of the bracket contains the event: the numbers of unstable eigenvalues
    /// changed because of several other events.
    pub is_empty: bool,
}

impl Bracket {
    /// Creates the bracket that consists of a whole interval between two points of the curve.
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

    /// Estimates the point in the bracket at which the test function vanishes; `parameter` is the
    /// index of the continued parameter in the extended unknowns `X`.
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

    /// Returns a point between the ends of the bracket, on the cubic Hermite interpolant of the two
    /// ends and their tangents.
    pub fn between(&self, fraction: f64) -> Vec<f64> {
        let length = self.high - self.low;
        // Tangents are derivatives with respect to scaled arclength, and the bracket is part of a
        // step.
        let [a, b] = &self.ends;
        let knots = [
            Knot { u: 0.0, x: &a.unknowns, tangent: &a.tangent, speed: 1.0 },
            Knot { u: length, x: &b.unknowns, tangent: &b.tangent, speed: 1.0 },
        ];
        hermite(&knots, fraction * length)
    }

    /// Returns the change of the continued parameter over the bracket, increased by the error of
    /// this parameter at the ends of the bracket.
    pub fn reach(&self, corrector: &Corrector) -> f64 {
        let [start, end] = self.at_ends(corrector.equations.parameters_at());
        (end - start).abs() + corrector.parameter_error()
    }

    /// Returns one component of the unknowns at both ends of the bracket.
    pub fn at_ends(&self, component: usize) -> [f64; 2] {
        [0, 1].map(|end| self.ends[end].unknowns[component])
    }
}
