//! Special points located between two points of a branch.

use super::branch::SpecialPoint;
use super::mesh_share::Shortfall;
use crate::core::system::Kind;

/// A special point located between two points of a branch.
#[derive(Clone)]
pub(super) struct Located {
    /// The index of the event among all events of the curve; `None` if the event is unclassified.
    pub event: Option<usize>,
    /// The distance of the special point from the first of the two points, in scaled arclength.
    pub along: f64,
    /// The unknowns of the curve at the special point.
    pub unknowns: Vec<f64>,
    /// The special point to be saved. Initially only its kind, error and named numbers are set;
    /// `describe` sets all other values.
    pub special: SpecialPoint,
    /// The column of the special point whose discretisation error is larger than requested, if any.
    pub shortfall: Option<Shortfall>,
}

impl Located {
    /// Creates a located point whose recorded values are not yet set; `error` is the estimated
    /// error of the continued parameter.
    pub fn new((kind, event): (Kind, &str), along: f64, unknowns: Vec<f64>, error: f64) -> Self {
        let special = SpecialPoint { error, ..SpecialPoint::new(kind, event) };
        Located { event: None, along, unknowns, special, shortfall: None }
    }

    /// Shifts the origin of the distance `along` to a point at the distance `offset` before the
    /// first point.
    pub fn farther(mut self, offset: f64) -> Self {
        self.along += offset;
        let slopes = self.special.slopes.take();
        self.special.slopes = slopes.map(|slopes| slopes.placed(offset, 1.0));
        self
    }

    /// Sets whether the point has converged, either by Newton's method or by bracketing.
    pub fn converged(mut self, converged: bool) -> Self {
        self.special.converged = converged;
        self
    }
}
