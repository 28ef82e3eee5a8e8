//! Boundary-value zero problems: segments of trajectories with conditions at their ends.

mod method;
mod problem;
mod shooting;

pub use method::{Block, Method, Span};
pub use problem::{BoundaryProblem, Ends, Monitor, OnSegment};
pub use shooting::Shooting;
