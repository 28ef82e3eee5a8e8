//! Special points found in a step.

use super::SpecialPoint;

/// A special point found between two points of the branch.
#[derive(Clone)]
pub(super) struct Located {
    /// Which of the stepper's events it is; none of them, if it is unclassified.
    pub event: Option<usize>,
    /// How far behind the first point it lies, in scaled arclength.
    pub along: f64,
    pub special: SpecialPoint,
}

/// A special point found between two points of the branch, not described yet.
pub(super) struct Found {
    /// How far behind the first point it lies, in scaled arclength.
    pub along: f64,
    pub unknowns: Vec<f64>,
    /// The values of the unknowns of the event's condition that have names.
    pub own: Vec<f64>,
    /// The estimated error of the continued parameter.
    pub error: f64,
    pub converged: bool,
}

/// A solution of an event's defining system.
pub(super) struct Finished {
    pub unknowns: Vec<f64>,
    /// The values of the unknowns of the event's condition that have names.
    pub own: Vec<f64>,
    /// The estimated error of the continued parameter.
    pub error: f64,
}
