//! Computes the equilibria of hybrid and Filippov systems, and their boundary points.
//!
//! An equilibrium of a mode is a zero of the mode's field at which the mode's guards are positive.
//! Where a guard also vanishes, the equilibrium is at the *boundary* of its mode, and an
//! equilibrium of the mode that follows the guard may coincide with it, such as an equilibrium of
//! sliding motion (a pseudo-equilibrium) where a field of a Filippov system vanishes on the surface
//! (M. di Bernardo et al., *SIAM Review* 50:629, 2008). [`HybridEquilibria`] is the problem for
//! continuation.
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
