//! The target for the discretisation error along one half of a branch.

/// Heuristic: the number of points between two comparisons with a finer mesh. A comparison takes as
/// long as several steps.
pub(super) const EVERY: usize = 3;

/// Heuristic: the smallest fraction of the usual target. Close to a homoclinic orbit, no mesh
/// suffices, and finer meshes take most of the time.
const LEAST_SHARE: f64 = 1e-3;

/// The target for the mesh error along one half of a curve of special points.
pub(super) struct MeshTarget {
    /// The fraction of the usual target to which comparisons with finer meshes have reduced the
    /// target.
    pub share: f64,
    /// The number of points at which the next comparison is due.
    pub due: usize,
}

impl MeshTarget {
    /// Whether the target is not reduced further.
    pub fn is_least(&self) -> bool {
        self.share <= LEAST_SHARE
    }

    /// Reduces the target by at most a factor of 100.
    pub fn reduce(&mut self, factor: f64) {
        self.share = (self.share * factor.max(0.01)).max(LEAST_SHARE);
    }
}

impl Default for MeshTarget {
    fn default() -> Self {
        MeshTarget { share: 1.0, due: EVERY }
    }
}
