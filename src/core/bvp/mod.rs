//! Discretisation of boundary-value problems, which consist of trajectories on segments with
//! conditions at the segments' ends.
//!
//! A [`BoundaryProblem`] defines the equations of a boundary-value problem. A [`Method`] replaces
//! each trajectory by values at nodes and by equations on the intervals of a [`Mesh`]. The methods
//! are [`Collocation`] at Gauss points (C. de Boor and B. Swartz, 1973; U. Ascher, R. Mattheij and
//! R. Russell, 1988) and [`Shooting`]. A [`BoundarySystem`] assembles all intervals and conditions
//! into a [`System`](crate::core::system::System), which can be continued like any other system.
//!
//! ```
//! use tangency::prelude::*;
//! use tangency::problems::classic::Bratu;
//! // Bratu's problem `u'' + λeᵘ = 0`, `u(0) = u(1) = 0`, on 10 intervals with 4 Gauss points each.
//! let mut bratu = BoundarySystem::new(Bratu, Collocation::new(4)?, vec![Mesh::uniform(10)])?;
//! let branch = Continuation::new(&mut bratu)
//!     .along("lambda", 0.0..=4.0)
//!     .bound("max_u", ..=3.0)
//!     .trace()?;
//! let fold = branch.of_kind(Kind::LP).next().expect("a fold");
//! assert!((fold.parameters[0] - 3.51383071912516).abs() < 1e-12);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod collocation;
mod colored;
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
