//! The usual imports of a crate that defines problems, traces their branches, and runs the command
//! line.
//!
//! ```
//! use tangency::prelude::*;
//! zero_problem! {
//!     struct ParallelPlate [u; load] { 0 = load / (T::one() - u).powi(2) - u; }
//! }
//! let mut plate = Dense::new(ParallelPlate);
//! let branch = Continuation::new(&mut plate).along("load", 0.0..=1.0).trace()?;
//! assert!((branch.of_kind(Kind::LP).next().expect("a fold").parameters[0] - 4.0 / 27.0).abs() < 1e-14);
//! # Ok::<(), tangency::core::continuation::TraceError>(())
//! ```

pub use crate::core::bvp::{
    BoundaryProblem, BoundarySystem, Collocation, Ends, Mesh, Monitor, Shooting,
};
pub use crate::core::continuation::{Branch, Continuation, Settings, SpecialPoint, TraceError};
pub use crate::core::equilibrium::HybridEquilibria;
pub use crate::core::failure::OutOfDomain;
pub use crate::core::hybrid::{Guard, HybridSystem, Mode, Passage};
pub use crate::core::orbit::{HybridOrbit, Itinerary, periodic_orbits};
pub use crate::core::problem::{
    Equilibria, Forcing, Integral, Measure, Names, VectorField, ZeroProblem,
};
pub use crate::core::scalar::Scalar;
pub use crate::core::system::{Dense, Kind, System};
#[cfg(feature = "scene")]
pub use crate::output::{COLUMN, Document, PAGE, csv, diagram, draw, write_atomically};
#[cfg(feature = "scene")]
pub use crate::scene::Catalogue;
pub use crate::{hybrid_system, vector_field, zero_problem};
