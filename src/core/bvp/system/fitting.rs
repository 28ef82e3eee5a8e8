//! Adaptive numbers of intervals along a branch: the meshes are fine enough to keep the mesh error
//! below a target; for shooting, they keep the error of the flow, which grows over a segment, below
//! the target.

use super::carry::remesh;
use super::mesh_error::intervals_for;
use super::meshed::{MOST_INTERVALS, Meshed};
use super::solutions::Solutions;
use crate::core::bvp::error::BoundaryError;
use crate::core::bvp::mesh::Mesh;

/// Heuristic: the largest factor by which the number of intervals grows in one step, because an
/// estimate from a coarse mesh can be wrong.
const MOST_GROWTH: f64 = 2.0;

/// Heuristic: the smallest factor by which the number of intervals grows, and the safety factor of
/// a mesh that shrinks, so that the number of intervals does not change at every point.
const SPARE: f64 = 1.25;

/// Heuristic: the number of intervals shrinks if this fraction of the current number is sufficient,
/// including the safety factor.
const FEW: f64 = 0.5;

/// Heuristic: the smallest factor by which the number of intervals shrinks in one step, because an
/// estimate from a fine mesh can be wrong for a coarse mesh.
const LEAST_KEPT: f64 = 0.75;

/// Heuristic: if the mesh error exceeds the target by this factor, redistributing the intervals is
/// not sufficient.
const FAR: f64 = 4.0;

/// Heuristic: if a branch starts on a uniform mesh and the estimated mesh error exceeds this
/// fraction of the target, the start is corrected on an adapted mesh, because the estimate is too
/// small if a uniform mesh does not resolve a layer.
const DOUBTFUL: f64 = 0.1;

/// Heuristic: the largest number of intervals of a segment along a branch: a solution that needs
/// more intervals is too stiff for polynomials.
const MOST_FITTED: usize = 1024;

impl Meshed {
    /// Adapts the numbers of intervals to the solution `x`, and transfers `x` and the given
    /// directions to the new meshes. Returns whether the mesh changed.
    pub fn fit_mesh(
        &mut self,
        x: &mut Vec<f64>,
        directions: &mut [&mut Vec<f64>],
        target: f64,
    ) -> bool {
        let Some(meshes) = fitting_meshes(self, x, target) else { return false };
        let Solutions { equations, phase, .. } = &self.solutions;
        let Ok(other) = equations.on(meshes) else { return false };
        let given = std::iter::once(&*x).chain(directions.iter().map(|d| &**d));
        let mut vectors: Vec<Vec<f64>> = given.cloned().collect();
        let refers = !phase.reference.is_empty();
        vectors.extend(refers.then(|| phase.reference.clone()));
        remesh(equations, &other.meshes, &mut vectors);
        if equations.method.error_constant().is_none() {
            // Between nodes, flows compute the solution itself.
            let Ok(carried) = equations.carried(&other, x) else { return false };
            vectors[0] = carried;
        }
        let mut fitted = Meshed::new(other);
        fitted.solutions.refers_to_problem_of(&self.solutions);
        if refers
            && let Some(reference) = vectors.pop()
            && fitted.set_reference(&reference).is_err()
        {
            return false;
        }
        // A branch that begins on a finer mesh keeps it.
        if self.followed > 0 {
            fitted.least.clone_from(&self.least);
        }
        (fitted.followed, fitted.refinements) = (self.followed, self.refinements);
        fitted.assembly.active.clone_from(&self.assembly.active);
        *self = fitted;
        let given = std::iter::once(x).chain(directions.iter_mut().map(|d| &mut **d));
        given.zip(vectors).for_each(|(vector, new)| *vector = new);
        true
    }
}

/// Returns the meshes that a solution needs; `None` if the current numbers of intervals are
/// right.
pub(super) fn fitting_meshes(meshed: &mut Meshed, x: &[f64], target: f64) -> Option<Vec<Mesh>> {
    if meshed.solutions.equations.method.error_constant().is_none() {
        return divided_meshes(meshed, target);
    }
    meshed.solutions.load(x);
    let Solutions { equations, monitors, plain, .. } = &mut meshed.solutions;
    let worst = monitors.mesh_error.largest(equations, &plain.nodes, &plain.numbers)?;
    let mut all = equations.meshes.iter().zip(&meshed.least);
    let mut changed = meshed.followed == 0
        && worst.error > DOUBTFUL * target
        && equations.meshes.iter().all(Mesh::is_uniform);
    if worst.error <= target && !changed && all.all(|(mesh, least)| mesh.intervals() <= *least) {
        return None;
    }
    let count = |segment: usize, now: usize, density: &[f64]| {
        let needed = intervals_for(equations, segment, density, target);
        if worst.error <= target {
            return fewer(now, meshed.least[segment], needed);
        }
        let far = worst.segment == segment && worst.error > FAR * target;
        more(now, needed, far)
    };
    let mut meshes = Vec::new();
    for (segment, mesh) in equations.meshes.iter().enumerate() {
        let density = monitors.mesh_error.density(equations, segment, plain);
        let count = count(segment, mesh.intervals(), &density);
        changed |= count != mesh.intervals();
        meshes.push(mesh.equidistributed(&density, count));
    }
    changed.then_some(meshes)
}

/// Heuristic: if deviations grow over an interval by at most this factor, halving the interval does
/// not reduce the error of the flow.
const SLOW_GROWTH: f64 = 10.0;

/// Returns the meshes of shooting with every interval halved, if errors of the flow grow beyond the
/// target over a segment of the solution that was assembled last, and if shorter intervals would
/// reduce this growth.
fn divided_meshes(meshed: &Meshed, target: f64) -> Option<Vec<Mesh>> {
    let equations = &meshed.solutions.equations;
    let known = !meshed.assembly.at.is_empty();
    let allowed = (target / equations.method.flow_error()).max(SLOW_GROWTH);
    let sensitive = known && meshed.assembly.growth(equations) > allowed;
    let few = equations.meshes.iter().all(|mesh| 2 * mesh.intervals() <= MOST_FITTED);
    let divided = || equations.meshes.iter().map(|mesh| mesh.divided(2)).collect();
    (sensitive && few).then(divided)
}

impl Solutions {
    /// Returns meshes on which the estimated error of a solution is below a tolerance, each with at
    /// least `least` intervals.
    pub fn meshes_for(
        &mut self,
        x: &[f64],
        tolerance: f64,
        least: usize,
    ) -> Result<Vec<Mesh>, BoundaryError> {
        self.load(x);
        let Solutions { equations, monitors, plain, .. } = self;
        let mut meshes = Vec::new();
        for (segment, mesh) in equations.meshes.iter().enumerate() {
            let density = monitors.mesh_error.density(equations, segment, plain);
            let needed = intervals_for(equations, segment, &density, tolerance).ceil();
            let most = MOST_INTERVALS;
            if needed.is_nan() || needed > most as f64 {
                return Err(BoundaryError::TooFine { segment, tolerance, needed, most });
            }
            meshes.push(mesh.equidistributed(&density, (needed as usize).max(least)));
        }
        Ok(meshes)
    }
}

/// Returns the new number of intervals of a segment whose error is too large: `needed` is the
/// number for an equidistributed error, and `far` is true if redistribution is not sufficient.
fn more(now: usize, needed: f64, far: bool) -> usize {
    let least = if far || needed > now as f64 { SPARE * now as f64 } else { now as f64 };
    let count = needed.clamp(least, MOST_GROWTH * now as f64).ceil();
    if count.is_finite() { (count as usize).min(MOST_FITTED.max(now)) } else { now }
}

/// Returns the new number of intervals of a segment whose error is small; the number does not
/// increase.
fn fewer(now: usize, least: usize, needed: f64) -> usize {
    let enough = (SPARE * needed).ceil();
    let kept = enough.max((LEAST_KEPT * now as f64).ceil());
    if enough <= FEW * now as f64 { (kept as usize).max(least).min(now) } else { now }
}
