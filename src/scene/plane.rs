//! The capability of maps to have manifolds.

use crate::core::manifold::{Manifold, ManifoldError, ManifoldSettings, Side};

/// A map whose saddles have manifolds.
pub(super) trait PlaneMap {
    /// Returns the names of the states.
    fn states(&self) -> Vec<String>;

    /// Computes one of the two manifolds of the cycle near the given states: the first state, or
    /// the states of all iterates.
    fn manifold(
        &self,
        states: &[f64],
        p: &[f64],
        side: Side,
        settings: &ManifoldSettings,
    ) -> Result<Vec<Manifold>, ManifoldError>;
}
