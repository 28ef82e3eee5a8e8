//! Boundary-value zero problems: segments of trajectories with conditions at their ends.

mod chunk;
mod collocation;
mod error;
mod mesh;
mod method;
mod problem;
mod shooting;
mod system;

pub use collocation::{Collocation, CollocationWork, PointsError};
pub use error::BoundaryError;
pub use mesh::{Mesh, MeshError};
pub use method::{Block, Method, Span};
pub use problem::{BoundaryProblem, Ends, Monitor, OnSegment};
pub use shooting::Shooting;
pub use system::BoundarySystem;
