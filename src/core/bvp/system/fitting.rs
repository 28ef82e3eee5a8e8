//! Numbers of intervals that follow a solution: as many as keep the error that the mesh causes
//! below a target, or the growth of the flow's errors over a segment of shooting.

use super::carry::remesh;
use super::mesh_error::intervals_for;
use super::meshed::{MOST_INTERVALS, Meshed};
use super::solutions::Solutions;
use crate::core::bvp::error::BoundaryError;
use crate::core::bvp::mesh::Mesh;

/// (H) A mesh grows by no more than this factor at once: what a coarse mesh says about a solution
/// may be wrong.
const MOST_GROWTH: f64 = 2.0;

/// (H) A mesh grows by no less than this factor, and one that shrinks has as much to spare, so that
/// the number of intervals does not change from point to point.
const SPARE: f64 = 1.25;

/// (H) A mesh shrinks where this part of its intervals would do, with those to spare.
const FEW: f64 = 0.5;

/// (H) A mesh keeps this part of its intervals at least: what a fine mesh says about a coarse one may
/// be wrong.
const LEAST_KEPT: f64 = 0.75;

/// (H) Where the error is larger than the target by this factor, a better distribution of the
/// intervals alone does not help.
const FAR: f64 = 4.0;

/// (H) A start on a uniform mesh with a larger part of the target's error is corrected on a mesh that
/// is distributed for it: the estimate is too small where the mesh does not resolve a layer.
const DOUBTFUL: f64 = 0.1;

/// (H) No segment gets more intervals than this on the way: a solution that needs more is too
/// stiff for a polynomial.
const MOST_FITTED: usize = 1024;

impl Meshed {
    /// Lets the number of intervals follow the solution `x`, and carries `x` and directions over;
    /// whether it changed.
    pub fn fit_mesh(
        &mut self,
        x: &mut Vec<f64>,
        directions: &mut [&mut Vec<f64>],
        target: f64,
    ) -> bool {
        let Some(meshes) = self.fitting_meshes(x, target) else { return false };
        let Solutions { equations, phase, .. } = &self.solutions;
        let Ok(other) = equations.on(meshes) else { return false };
        let given = std::iter::once(&*x).chain(directions.iter().map(|d| &**d));
        let mut vectors: Vec<Vec<f64>> = given.cloned().collect();
        let refers = !phase.reference.is_empty();
        vectors.extend(refers.then(|| phase.reference.clone()));
        remesh(equations, &other.meshes, &mut vectors);
        if equations.method.error_constant().is_none() {
            // Between nodes flows know the solution itself.
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

    /// The meshes that a solution needs, if they have other numbers of intervals than the present
    /// ones.
    pub fn fitting_meshes(&mut self, x: &[f64], target: f64) -> Option<Vec<Mesh>> {
        if self.solutions.equations.method.error_constant().is_none() {
            return divided_meshes(self, target);
        }
        self.solutions.load(x);
        let Solutions { equations, monitors, plain, .. } = &mut self.solutions;
        let worst = monitors.mesh_error.largest(equations, &plain.nodes, &plain.numbers)?;
        let mut all = equations.meshes.iter().zip(&self.least);
        let mut changed = self.followed == 0
            && worst.error > DOUBTFUL * target
            && equations.meshes.iter().all(Mesh::is_uniform);
        if worst.error <= target && !changed && all.all(|(mesh, least)| mesh.intervals() <= *least)
        {
            return None;
        }
        let count = |segment: usize, now: usize, density: &[f64]| {
            let needed = intervals_for(equations, segment, density, target);
            if worst.error <= target {
                return fewer(now, self.least[segment], needed);
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
}

/// The meshes of shooting divided in two, if errors of the flow grow beyond the target over a
/// segment of the solution assembled last.
fn divided_meshes(meshed: &Meshed, target: f64) -> Option<Vec<Mesh>> {
    let equations = &meshed.solutions.equations;
    let known = !meshed.assembly.at.is_empty();
    let sensitive =
        known && meshed.assembly.growth(equations) * equations.method.flow_error() > target;
    let few = equations.meshes.iter().all(|mesh| 2 * mesh.intervals() <= MOST_FITTED);
    let divided = || equations.meshes.iter().map(|mesh| mesh.divided(2)).collect();
    (sensitive && few).then(divided)
}

impl Solutions {
    /// Meshes on which the estimated error of a solution is below a tolerance, each with at least
    /// `least` intervals.
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

/// How many intervals a segment gets whose error is too large, or another one's is: `needed` if they
/// were distributed evenly, `far` where that does not suffice.
fn more(now: usize, needed: f64, far: bool) -> usize {
    let least = if far || needed > now as f64 { SPARE * now as f64 } else { now as f64 };
    let count = needed.clamp(least, MOST_GROWTH * now as f64).ceil();
    if count.is_finite() { (count as usize).min(MOST_FITTED.max(now)) } else { now }
}

/// How many intervals a segment keeps whose error is small.
fn fewer(now: usize, least: usize, needed: f64) -> usize {
    let enough = (SPARE * needed).ceil();
    let kept = enough.max((LEAST_KEPT * now as f64).ceil());
    if enough <= FEW * now as f64 { (kept as usize).max(least).min(now) } else { now }
}
