//! What a branch says of itself.

use tangency::core::continuation::{Branch, End, SpecialPoint};
use tangency::core::system::Kind;

/// The monitor that states the error of a mesh.
pub const MESH_ERROR: &str = "mesh_error";

/// Whether a special point is one of the last before a homoclinic orbit, which have not converged,
/// or the end itself: it does not claim to be there.
pub fn is_unresolved(branch: &Branch, index: usize) -> bool {
    let behind = |s: &SpecialPoint| !s.converged || matches!(s.kind, Kind::MX | Kind::ND);
    let one = |end: &End| matches!(end, End::Homoclinic { .. });
    one(&branch.ends[1]) && branch.special[index..].iter().all(behind)
        || one(&branch.ends[0]) && branch.special[..=index].iter().all(behind)
}

/// The range of a column on a branch; what hardly varies is measured by itself.
pub fn range(branch: &Branch, column: usize) -> f64 {
    let points = branch.points.iter().filter_map(|point| point.value(column));
    let special = branch.special.iter().filter_map(|special| special.value(column));
    let [mut low, mut high, mut size] = [f64::INFINITY, f64::NEG_INFINITY, 0.0_f64];
    for value in points.chain(special).filter(|value| value.is_finite()) {
        (low, high, size) = (low.min(value), high.max(value), size.max(value.abs()));
    }
    (high - low).max(1e-3 * size)
}

/// What a point of a branch says of its mesh.
pub fn mesh_error(branch: &Branch, special: &SpecialPoint) -> Option<f64> {
    special.value(branch.column(MESH_ERROR)?)
}

/// The reason for an end, without numbers that depend on steps and meshes.
pub fn named(end: &End) -> String {
    match end {
        End::Closed { .. } => "closed".into(),
        End::PointLimit { .. } => "as many points as allowed".into(),
        End::StepTooSmall { .. } => "no step succeeds".into(),
        End::Homoclinic { .. } => "the period is long".into(),
        End::MeshTooCoarse { .. } => "the mesh is too coarse".into(),
        other => other.to_string(),
    }
}
