//! Traits and macros for the models that users define: zero problems, vector fields, maps,
//! potentials and measures.
//!
//! A model implements one trait, such as [`ZeroProblem`], [`VectorField`] or [`DiscreteMap`],
//! generically for all [`Scalar`](crate::core::scalar::Scalar) types, and returns the [`Names`] of
//! its states and parameters; the macros [`zero_problem!`](crate::zero_problem) and
//! [`vector_field!`](crate::vector_field) implement the trait from formulas. Continuation uses
//! object-safe versions of the model traits.
//!
//! ```
//! use tangency::prelude::*;
//! vector_field! {
//!     /// Lotka and Volterra's prey `x` and predators `y`.
//!     struct Hunt [x, y; birth, death] {
//!         d/dt x = x * (birth - y);
//!         d/dt y = y * (x - death);
//!         monitor total = x + y;
//!     }
//! }
//! assert_eq!(Hunt.names().parameters, ["birth", "death"]);
//! let (x, p, mut rates) = ([3.0, 0.5], [2.0, 1.0], [0.0; 2]);
//! Hunt.field(0.0, &x, &p, &mut rates);
//! assert_eq!((rates, Hunt.monitor(0, 0.0, &x, &p)), ([4.5, 1.0], 3.5));
//! ```

mod discrete_map;
mod erasure;
mod extremes;
mod field;
mod forward;
mod measure;
pub(crate) mod names;
mod potential;
mod scalar_field;
mod stated;
mod watch;
mod zero;
mod zero_equations;

pub use discrete_map::DiscreteMap;
pub(in crate::core) use erasure::erased;
pub(in crate::core) use extremes::{Extremes, Overall, Sighting};
pub use field::{Equilibria, Forcing, VectorField};
pub(in crate::core) use forward::forward;
pub(crate) use measure::columns_showing;
pub(in crate::core) use measure::larger;
pub use measure::{Integral, Measure};
pub(crate) use names::distinct;
pub use names::{Group, Names, UnknownName, position};
pub(crate) use potential::PotentialGradient;
pub(crate) use scalar_field::{Domains, FieldIn, FieldRef, Fields, Pace, WideFields};
pub(in crate::core) use scalar_field::{WIDTH, Wide};
pub use watch::{Observable, State, Watch, WatchIn, Watchable};
pub(in crate::core) use watch::{Opposite, change_by, gradient};
pub use zero::{Dynamics, PlaneField, Profile, ZeroProblem};
pub(in crate::core) use zero_equations::{
    ROOM, TracedEquations, ZeroEquations, ZeroFunctions, ZeroMonitors, ZeroNumber,
};
