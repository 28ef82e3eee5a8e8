//! The interface of maps for which stable and unstable manifolds can be computed.

use crate::core::manifold::{Manifold, ManifoldError, ManifoldSettings, Side};

/// A map for whose saddles stable and unstable manifolds can be computed.
pub(super) trait PlaneMap {
    /// Returns the names of the map's states.
    fn states(&self) -> Vec<String>;

    /// Computes the stable or the unstable manifold of the map's cycle near the given states; these
    /// are the first state of the cycle, or the states of all its iterates.
    fn manifold(
        &self,
        states: &[f64],
        p: &[f64],
        side: Side,
        settings: &ManifoldSettings,
    ) -> Result<Vec<Manifold>, ManifoldError>;
}
