//! Comparison of the points of a curve of special points with the same points on a finer mesh.
//!
//! Near canards and homoclinic orbits, the periods at folds of cycles depend on the parameters
//! exponentially. A discretisation error that hardly changes a cycle moves such a fold to a cycle
//! of another period.

use super::curve::Curve;
use super::end::End;
use super::fitting::fit_mesh;
use super::half::Half;
use super::mesh_target::EVERY;
use crate::core::bifurcation::At;

/// Heuristic: the mesh is too coarse for a curve of special points if the period at a point changes
/// by more than this fraction on a finer mesh.
const LARGEST_SHIFT: f64 = 1e-4;

/// Heuristic: the change of the period after the mesh has been refined, from which the new target
/// for the mesh error is estimated.
const AIM: f64 = 1e-5;

/// The parameters of an orbit have errors of order `h^{2m}`, and `mesh_error` is of order
/// `h^{m+1}`: this is the ratio of the exponents for `m = 4`.
const ORDERS: f64 = 5.0 / 8.0;

/// Rounding: a mesh whose error is smaller than this threshold is not refined.
const FINEST: f64 = 1e-11;

/// Heuristic: a curve whose target has been reduced as far as possible approaches homoclinic orbits
/// if the period changes by less than the fraction `CRAWL` in `MOST_CRAWLING` points, and if the
/// cycles pass an equilibrium at a distance of less than the fraction `NEAR` of their extents.
const CRAWL: f64 = 0.03;
const MOST_CRAWLING: usize = 20;
const NEAR: f64 = 0.05;

/// Compares the period at the last point with the period on a finer mesh, if a comparison is due,
/// and reduces the target for the mesh error if the periods differ too much.
pub(super) fn check_mesh(curve: &mut Curve, half: &mut Half) {
    let points = half.points.len();
    let is_finest = half.mesh.is_least();
    if curve.refiner.held.is_empty() || is_finest || points < half.mesh.due {
        return;
    }
    half.mesh.due = points + EVERY;
    let Some(shift) = shift_on_finer_mesh(curve, half) else { return };
    if shift > LARGEST_SHIFT {
        half.mesh.reduce((AIM / shift).powf(ORDERS));
        half.mesh.due = points + 1;
    }
}

/// Refines the mesh of a curve of special points at a point where no step succeeds, and corrects
/// the point. Returns whether the mesh changed, so that a step may succeed.
pub(super) fn rescue(curve: &mut Curve, half: &mut Half, target: f64) -> bool {
    let error = curve.corrector.mesh_error(&half.last.unknowns);
    if curve.refiner.held.is_empty()
        || half.mesh.is_least()
        || error <= FINEST
        || half.points.is_empty()
    {
        return false;
    }
    let before = half.mesh.share;
    half.mesh.reduce(0.01 * error.min(target) / target);
    half.mesh.due = half.points.len() + 1;
    fit_mesh(curve, half, target * half.mesh.share / before);
    curve.corrector.mesh_error(&half.last.unknowns) < error
}

/// Returns the end of a curve of special points of cycles that approach homoclinic orbits: the
/// curve follows the homoclinic orbits closely, and its points are known no more accurately than
/// their distances from the homoclinic orbits.
pub(super) fn end_at_homoclinic(curve: &mut Curve, half: &mut Half) -> Option<End> {
    if curve.refiner.held.is_empty() || !half.mesh.is_least() {
        return None;
    }
    curve.corrector.equations.load(&half.last.unknowns);
    let At { system, x, .. } = curve.corrector.equations.at();
    let period = system.traits(x).free_period?;
    let (settled, crawling) = &mut half.mesh.settled;
    if (period - *settled).abs() >= CRAWL * *settled {
        (*settled, *crawling) = (period, 0);
        return None;
    }
    *crawling += 1;
    if *crawling < MOST_CRAWLING {
        return None;
    }
    let distance = system.discretised()?.approach(x)?.distance;
    (distance < NEAR).then_some(End::Homoclinic { period, distance })
}

/// Returns the relative change of the period at the last point if the mesh is refined, while the
/// released parameter that varies most along the curve is fixed. The change is infinite if Newton's
/// method fails on the finer mesh; `None` if the solutions have no mesh that could be too coarse.
fn shift_on_finer_mesh(curve: &mut Curve, half: &Half) -> Option<f64> {
    let Curve { corrector, recorder, refiner, .. } = curve;
    let last = &half.last;
    corrector.equations.load(&last.unknowns);
    let At { system, x, .. } = corrector.equations.at();
    let traits = system.traits(x);
    let period = traits.free_period.filter(|_| traits.mesh_error > FINEST)?;
    let first = corrector.equations.parameters_at();
    let change = |k: &usize| corrector.norm.scaled(first + k, last.tangent[first + k]).abs();
    let count = last.unknowns.len() - first;
    let most = (0..count).max_by(|a, b| change(a).total_cmp(&change(b)))?;
    let fixed = (corrector.equations.released[most], last.unknowns[first + most]);
    let finer = refiner.period_on_finer_mesh(corrector, recorder, fixed);
    Some(finer.map_or(f64::INFINITY, |finer| (finer / period - 1.0).abs()))
}
