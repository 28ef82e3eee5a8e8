//! Errors of discretisations of boundary-value problems.

use super::terms::Shape;
use crate::core::failure::Failure;
use crate::core::failure::debug_is_message;

debug_is_message!(BoundaryError);

/// The error that reports sizes of a boundary-value problem (numbers of segments, states,
/// conditions and unknowns) that do not fit together.
#[derive(Clone, PartialEq, miette::Diagnostic, thiserror::Error)]
#[non_exhaustive]
pub enum BoundaryError {
    /// The number of meshes differs from the number of segments, or the number of segments is zero.
    #[error(
        "the problem has {segments} segments and {meshes} meshes, but needs at least one segment, \
         and exactly one mesh for each segment"
    )]
    Meshes {
        /// The number of segments of the problem.
        segments: usize,
        /// The number of meshes given for the segments.
        meshes: usize,
    },
    /// A segment does not have any states.
    #[error("segment {0} has no states")]
    NoStates(usize),
    /// The mesh of a segment does not have any intervals.
    #[error("the mesh of segment {0} has no intervals, but needs at least one interval")]
    NoIntervals(usize),
    /// The number of integral and phase conditions exceeds the number of unknowns.
    #[error(
        "the problem has {closing} integral and phase conditions, but only {unknowns} unknowns \
         (states and extra unknowns)"
    )]
    #[diagnostic(help("remove integral or phase conditions, or add extra unknowns"))]
    Conditions {
        /// The number of unknowns available to the conditions: the states of all segments, and the
        /// extra unknowns.
        unknowns: usize,
        /// The number of conditions: the integral conditions and the phase condition.
        closing: usize,
    },
    /// The number of segments or conditions does not match the shape of the problem, which says
    /// whether solutions are periodic and how one period leads to the next.
    #[error(
        "the problem has {segments} segments with {boundary} boundary conditions and {closing} \
         integral and phase conditions, which do not fit the shape {shape:?}: the shape Periodic is one \
         closed segment with as many boundary conditions as states, and the shape Cycle has no \
         integral conditions"
    )]
    Shape {
        /// The shape.
        shape: Shape,
        /// The number of segments of the problem.
        segments: usize,
        /// The number of boundary conditions of the problem.
        boundary: usize,
        /// The number of integral and phase conditions of the problem.
        closing: usize,
    },
    /// A monitor refers to a state that does not exist.
    #[error(
        "the monitor `{name}` refers to state {state} on segment {segment}, but this state does \
         not exist"
    )]
    Monitor {
        /// The monitor.
        name: String,
        /// The segment.
        segment: usize,
        /// The state.
        state: usize,
    },
    /// The tolerance requires more mesh intervals than the largest allowed number.
    #[error(
        "a discretisation error of {tolerance:.1e} needs {needed:.0} mesh intervals on segment \
         {segment}, but at most {most} intervals are allowed"
    )]
    #[diagnostic(help("raise the tolerance, or the number of collocation points per interval"))]
    TooFine {
        /// The segment.
        segment: usize,
        /// The tolerance.
        tolerance: f64,
        /// The number of intervals that the tolerance requires.
        needed: f64,
        /// The largest allowed number of intervals.
        most: usize,
    },
    /// A solution could not be transferred to another mesh.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Evaluation(#[from] Failure),
}
