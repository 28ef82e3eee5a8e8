//! Equilibria of hybrid and Filippov systems, and their boundary equilibria.
//!
//! An equilibrium of a mode is a zero of the vector field of the mode at which the guards of the
//! mode are positive. If a guard also vanishes at the equilibrium, the equilibrium lies on the
//! *boundary* of its mode. An equilibrium of the mode that follows the guard may coincide with the
//! boundary equilibrium. For example, if a vector field of a Filippov system vanishes at a point of
//! the surface, this equilibrium coincides with an equilibrium of sliding motion (a
//! pseudo-equilibrium) (M. di Bernardo et al., *SIAM Review* 50:629, 2008). [`HybridEquilibria`]
//! provides the equations of equilibria for continuation.
//!
//! ```
//! use tangency::prelude::*;
//! hybrid_system! {
//!     /// A mass on a spring, `x'' = q − x − 0.5 x'`, with a stop at 1; it rests at `x = q`.
//!     struct Mass [q = 0.0] {
//!         mode flight [x, v] {
//!             d/dt x = v; d/dt v = q - x - v * 0.5;
//!             event impact: -x + 1.0 => flight { x, v: -v * 0.8 };
//!         }
//!     }
//! }
//! let mut rest = HybridEquilibria::new(Mass, 0)?;
//! let branch = Continuation::new(&mut rest).along("q", 0.0..=2.0).trace()?;
//! // The mass at rest touches the stop at q = 1.
//! let boundary = branch.of_kind(Kind::G).next().expect("a boundary equilibrium");
//! assert!((boundary.parameters[0] - 1.0).abs() < 1e-12);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod boundary;
mod equilibria;
mod error;
mod near;
mod rest;

pub use equilibria::HybridEquilibria;
pub use error::EquilibriumError;
pub use near::equilibrium_near;
pub(crate) use near::place_in_words;
