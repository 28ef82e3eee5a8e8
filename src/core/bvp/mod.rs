//! Boundary-value zero problems: segments of trajectories with conditions at their ends.
//!
//! ```text
//!     dx_s/dτ = L_s(q) f_s(τ L_s(q), x_s, q),    0 ≤ τ ≤ 1,    s = 1 … S
//!     b(x_1(0), …, x_S(0), x_1(1), …, x_S(1), q) = 0
//!     Σ_s ∫ g_s(t, x_s, q) dt = 0
//! ```
//!
//! A [`BoundaryProblem`] states this once. A [`Method`] replaces each trajectory by values at nodes and
//! equations on the intervals of a [`Mesh`]: [`Collocation`] is one. A [`BoundarySystem`] puts all
//! intervals and conditions together into a [`System`](crate::core::zero::System), which is continued
//! like any other.

mod collocation;
mod erased;
mod error;
mod interpolation;
mod interval;
mod mesh;
mod method;
mod problem;
mod shooting;
mod system;

pub use collocation::{Collocation, CollocationWork, PointsError};
pub use erased::{EndFunctions, Equations, IntoEquations, Number, Residual, WatchNumber, Watches};
pub use error::BoundaryError;
pub use interval::{Block, Interval, Span, Watchlist};
pub use mesh::{Mesh, MeshError};
pub use method::Method;
pub use problem::{Birth, BoundaryProblem, Ends, Monitor, Return, Unknown, Watched};
pub use shooting::Shooting;
pub use system::BoundarySystem;
