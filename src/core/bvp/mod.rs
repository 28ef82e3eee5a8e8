//! Boundary-value problems: segments of trajectories with conditions at their ends, and their
//! discretisation.
//!
//! A [`BoundaryProblem`] defines the equations. A [`Method`], [`Collocation`] or [`Shooting`],
//! replaces each trajectory by values at nodes and equations on the intervals of a [`Mesh`]. A
//! [`BoundarySystem`] assembles all intervals and conditions into a
//! [`System`](crate::core::system::System), which can be continued like any other.

mod collocation;
mod derivatives;
mod erased;
mod error;
mod homoclinic;
mod interval;
mod itineraries;
mod mesh;
mod method;
mod problem;
mod shooting;
mod stated;
mod system;
mod terms;
mod trajectory;

pub use collocation::{Collocation, PointsError};
pub(in crate::core) use erased::{EndFunctions, Residual, Watches};
pub use erased::{Equations, ErasedProblem, IntoEquations};
pub use error::BoundaryError;
pub use interval::{Block, Interval, MonitoredFunctions, Span};
pub use itineraries::{Guess, Itineraries};
pub use mesh::{Mesh, MeshError};
pub use method::Method;
pub use problem::BoundaryProblem;
pub use shooting::Shooting;
pub use system::{BoundarySystem, DiscretisedProblem, phase_response, reduced_pencil};
pub use terms::{Ends, Monitor, Shape, Watched};
pub use trajectory::Trajectory;
