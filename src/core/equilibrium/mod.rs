//! Equilibria of hybrid and Filippov systems: [`HybridEquilibria`].
//!
//! An equilibrium of a mode is a zero of the mode's field at which the mode's guards are positive.
//! Where a guard also vanishes, the equilibrium is at the *boundary* of its mode, and an
//! equilibrium of the mode behind the guard may coincide with it, such as an equilibrium of sliding
//! motion (a pseudo-equilibrium) where a field of a Filippov system vanishes on the surface.

mod boundary;
mod equilibria;
mod error;
mod near;
mod rest;

pub use equilibria::HybridEquilibria;
pub use error::EquilibriumError;
pub use near::equilibrium_near;
pub(in crate::core) use near::place_in_words;
