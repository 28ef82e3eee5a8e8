//! Why a boundary-value problem cannot be discretised as asked.

use super::terms::Shape;
use crate::core::failure::Failure;

/// Sizes of a boundary-value problem that do not fit together.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum BoundaryError {
    /// Not one mesh for each segment.
    #[error(
        "{segments} segments and {meshes} meshes: each segment needs one mesh, and at least one segment"
    )]
    Meshes {
        /// The number of segments.
        segments: usize,
        /// The number of meshes.
        meshes: usize,
    },
    /// A segment without states.
    #[error("segment {0} has no states")]
    NoStates(usize),
    /// A segment without intervals.
    #[error("segment {0} has no intervals: it needs at least one")]
    NoIntervals(usize),
    /// More integral and phase conditions than there is to determine.
    #[error(
        "{closing} integral and phase conditions, but only {unknowns} states and extras to determine: drop \
         conditions or add extras"
    )]
    Conditions {
        /// States of all segments, and extras.
        unknowns: usize,
        /// Integral conditions, and the phase condition.
        closing: usize,
    },
    /// Segments or conditions that a shape does not have.
    #[error(
        "{segments} segments with {boundary} boundary conditions and {closing} integral and phase conditions do \
         not make {shape:?}: a periodic orbit is one segment that closes, with as many boundary conditions as \
         states, and cycles have no integral conditions"
    )]
    Shape {
        /// The shape.
        shape: Shape,
        /// The number of segments.
        segments: usize,
        /// The number of boundary conditions.
        boundary: usize,
        /// The number of integral and phase conditions.
        closing: usize,
    },
    /// A monitor of a state that there is not.
    #[error(
        "the monitor `{name}` is that of state {state} on segment {segment}, which does not exist"
    )]
    Monitor {
        /// The monitor.
        name: String,
        /// The segment.
        segment: usize,
        /// The state.
        state: usize,
    },
    /// No affordable mesh keeps the error below a tolerance.
    #[error(
        "an error of {tolerance:.1e} needs {needed:.0} intervals on segment {segment}, but {most} are the \
         most: raise the tolerance or the number of points in an interval"
    )]
    TooFine {
        /// The segment.
        segment: usize,
        /// The tolerance.
        tolerance: f64,
        /// The number of intervals that it needs.
        needed: f64,
        /// The largest number of intervals.
        most: usize,
    },
    /// A solution could not be carried over to another mesh.
    #[error(transparent)]
    Evaluation(#[from] Failure),
}
