//! Points of a curve, and the intervals between them.

use super::branch::Point;
use super::hermite::{Knot, hermite};
use crate::core::bifurcation::Stability;
use crate::core::linalg::{Spectrum, dot};

/// A point of a curve with the data needed for the next step and for the detection of events.
#[derive(Clone)]
pub(super) struct CurvePoint {
    pub unknowns: Vec<f64>,
    /// The tangent, of scaled length 1.
    pub tangent: Vec<f64>,
    /// The values of the test functions of all events; an unknown value is `None`.
    pub tests: Vec<Option<f64>>,
    pub point: Point,
    /// All eigenvalues or multipliers, if known.
    pub spectrum: Option<Spectrum>,
    /// The numbers of unstable eigenvalues or multipliers, if known.
    pub stability: Option<Stability>,
    /// The bound below which slopes of the continued parameter may be due to discretisation errors.
    pub vertical: f64,
    /// The sign of the determinant of the Jacobian bordered by the tangent.
    pub determinant: f64,
    /// If eigenvalues are not computed, the distance beyond this point up to which the curve
    /// contains no branch point.
    pub quiet: f64,
}

impl CurvePoint {
    /// Returns the unknowns and the tangent of the point.
    pub fn on_curve(&self) -> [&[f64]; 2] {
        [&self.unknowns, &self.tangent]
    }
}

/// Two successive points of a curve.
#[derive(Clone, Copy)]
pub(super) struct Interval<'p> {
    pub from: &'p CurvePoint,
    pub to: &'p CurvePoint,
    /// The distance between the hyperplanes through the two points, measured along the tangent at
    /// the first point.
    pub length: f64,
}

impl Interval<'_> {
    /// Returns the point at the distance `along` from the first point, on the cubic Hermite
    /// interpolant of both ends and their tangents; `row` is the covector of the first tangent.
    pub fn cubic(&self, row: &[f64], along: f64) -> Vec<f64> {
        let Interval { from, to, length } = *self;
        let speed = dot(row, &to.tangent);
        let knots = [
            Knot { u: 0.0, x: &from.unknowns, tangent: &from.tangent, speed: 1.0 },
            Knot { u: length, x: &to.unknowns, tangent: &to.tangent, speed },
        ];
        hermite(&knots, along)
    }

    /// Returns the point on the chord between the two ends of the interval, at the given fraction
    /// of the chord's length.
    pub fn chord(&self, share: f64) -> Vec<f64> {
        let ends = self.from.unknowns.iter().zip(&self.to.unknowns);
        ends.map(|(a, b)| a + share * (b - a)).collect()
    }

    /// Returns one component of the unknowns at both ends of the interval.
    pub fn ends(&self, component: usize) -> [f64; 2] {
        [self.from, self.to].map(|end| end.unknowns[component])
    }
}
