//! What a crate needs to state problems, follow their branches, and have the command line for them.
//!
//! ```
//! use tangency::prelude::*;
//! ```

pub use crate::core::bvp::{
    BoundaryProblem, BoundarySystem, Collocation, Ends, Mesh, Monitor, Shooting,
};
pub use crate::core::continuation::{Branch, Continuation, Kind, SpecialPoint};
pub use crate::core::dense::Dense;
pub use crate::core::field::{Equilibria, Forcing, VectorField};
pub use crate::core::hybrid::{Guard, HybridSystem, Mode, Passage};
pub use crate::core::measure::{Integral, Measure};
pub use crate::core::orbit::{HybridOrbit, Itinerary};
pub use crate::core::scalar::Scalar;
pub use crate::core::zero::{Names, OutOfDomain, System, ZeroProblem};
#[cfg(feature = "scene")]
pub use crate::scene::Catalogue;
