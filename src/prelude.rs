//! What a crate needs to state problems, follow their branches, and have the command line for them.
//!
//! ```
//! use tangency::prelude::*;
//! ```

pub use crate::core::bvp::{
    BoundaryProblem, BoundarySystem, Collocation, Ends, Mesh, Monitor, Shooting,
};
pub use crate::core::continuation::{Branch, Continuation, SpecialPoint};
pub use crate::core::equilibrium::HybridEquilibria;
pub use crate::core::failure::OutOfDomain;
pub use crate::core::hybrid::{Guard, HybridSystem, Mode, Passage};
pub use crate::core::orbit::{HybridOrbit, Itinerary};
pub use crate::core::problem::{
    Equilibria, Forcing, Integral, Measure, Names, VectorField, ZeroProblem,
};
pub use crate::core::scalar::Scalar;
pub use crate::core::system::{Dense, Kind, System};
#[cfg(feature = "scene")]
pub use crate::scene::Catalogue;
pub use crate::{hybrid_system, vector_field, zero_problem};
