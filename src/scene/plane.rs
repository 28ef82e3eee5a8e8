//! The capability of maps to have manifolds.

use crate::core::manifold::{Manifold, ManifoldError, ManifoldSettings, Side};

/// A map whose saddles have manifolds.
pub(super) trait PlaneMap {
    /// The names of the states.
    fn states(&self) -> Vec<String>;

    /// One of both manifolds of the cycle near some states: the first state, or the states of all
    /// iterates.
    fn manifold(
        &self,
        states: &[f64],
        p: &[f64],
        side: Side,
        settings: &ManifoldSettings,
    ) -> Result<Vec<Manifold>, ManifoldError>;
}
