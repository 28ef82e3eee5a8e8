//! Special points located between two points of the branch.

use super::branch::SpecialPoint;
use crate::core::system::Kind;

/// A special point between two points of the branch.
#[derive(Clone)]
pub(super) struct Located {
    /// The event's position among those of the curve; `None` if it is unclassified.
    pub event: Option<usize>,
    /// How far behind the first point it lies, in scaled arclength.
    pub along: f64,
    /// The unknowns of the curve.
    pub unknowns: Vec<f64>,
    /// The saved point: first its kind, its error and its numbers, all values once it is described.
    pub special: SpecialPoint,
}

impl Located {
    /// A point that is not described yet, with the estimated error of the continued parameter.
    pub fn new((kind, event): (Kind, &str), along: f64, unknowns: Vec<f64>, error: f64) -> Self {
        let special = SpecialPoint { error, ..SpecialPoint::new(kind, event) };
        Located { event: None, along, unknowns, special }
    }

    /// The same point, seen from a point that lies so far before the first one.
    pub fn farther(mut self, offset: f64) -> Self {
        self.along += offset;
        let slopes = self.special.slopes.take();
        self.special.slopes = slopes.map(|slopes| slopes.placed(offset, 1.0));
        self
    }

    /// The same point, with whether it is converged on its defining system or bracket.
    pub fn converged(mut self, converged: bool) -> Self {
        self.special.converged = converged;
        self
    }
}
