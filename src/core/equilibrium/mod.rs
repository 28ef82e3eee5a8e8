//! Equilibria of hybrid and Filippov systems: [`HybridEquilibria`].
//!
//! Motion rests in a mode where the mode's field vanishes while its guards are positive. Where a
//! guard vanishes as well the equilibrium is at the *boundary* of its mode, and an equilibrium of
//! the mode behind the guard may be at the same place: of sliding motion (a pseudo-equilibrium)
//! where a field of a Filippov system vanishes on the surface.

mod boundary;
mod equilibria;
mod error;
mod near;
mod rest;

pub use equilibria::HybridEquilibria;
pub use error::EquilibriumError;
pub use near::equilibrium_near;
pub(in crate::core) use near::place_in_words;
