//! Special points located between two points of the branch.

use super::branch::SpecialPoint;
use crate::core::system::Kind;

/// A special point between two points of the branch.
#[derive(Clone)]
pub(super) struct Located {
    /// The event's position among the events of the curve; `None` if it is unclassified.
    pub event: Option<usize>,
    /// The distance from the first point, in scaled arclength.
    pub along: f64,
    /// The unknowns of the curve.
    pub unknowns: Vec<f64>,
    /// The special point to be saved: initially its kind, error and numbers; all values after
    /// `describe`.
    pub special: SpecialPoint,
}

impl Located {
    /// Creates a point without a description; `error` is the estimated error of the continued
    /// parameter.
    pub fn new((kind, event): (Kind, &str), along: f64, unknowns: Vec<f64>, error: f64) -> Self {
        let special = SpecialPoint { error, ..SpecialPoint::new(kind, event) };
        Located { event: None, along, unknowns, special }
    }

    /// Shifts the origin to a point at the distance `offset` before the first one.
    pub fn farther(mut self, offset: f64) -> Self {
        self.along += offset;
        let slopes = self.special.slopes.take();
        self.special.slopes = slopes.map(|slopes| slopes.placed(offset, 1.0));
        self
    }

    /// Sets whether the point has converged on its defining system or bracket.
    pub fn converged(mut self, converged: bool) -> Self {
        self.special.converged = converged;
        self
    }
}
