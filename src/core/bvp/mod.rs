//! Boundary-value zero problems: segments of trajectories with conditions at their ends.

mod method;
mod problem;

pub use method::{Block, Method, Span};
pub use problem::{BoundaryProblem, Ends, Monitor, OnSegment};
