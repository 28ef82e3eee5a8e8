//! Comparison of the points of a curve of special points with the same points on a finer mesh.
//!
//! Near canards and homoclinic orbits, the periods at folds of cycles depend on the parameters
//! exponentially. A discretisation error that hardly changes a cycle moves such a fold to a cycle
//! of another period.

use super::curve::Curve;
use super::fitting::fit_mesh;
use super::half::Half;
use super::mesh_target::EVERY;
use super::settings::Settings;
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

/// Adapts the number of mesh intervals to the last point of one half of a curve. On a curve of
/// special points, the target for the mesh error is reduced before if a comparison with a finer mesh
/// is due, and if the periods differ too much.
pub(super) fn adapt_mesh(curve: &mut Curve, half: &mut Half, settings: &Settings) {
    compare(curve, half);
    let target = target(curve, half, settings);
    fit_mesh(curve, half, target);
}

/// Returns the target for the mesh error at the next points of one half of a curve.
pub(super) fn target(curve: &Curve, half: &Half, settings: &Settings) -> f64 {
    half.mesh.share * settings.mesh_target(!curve.refiner.held.is_empty())
}

/// Reduces the target if a comparison is due, and if the period at the last point differs too much
/// from the period on a finer mesh.
fn compare(curve: &mut Curve, half: &mut Half) {
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
pub(super) fn rescue(curve: &mut Curve, half: &mut Half, settings: &Settings) -> bool {
    let before = target(curve, half, settings);
    let error = curve.corrector.mesh_error(&half.last.unknowns);
    if curve.refiner.held.is_empty()
        || half.mesh.is_least()
        || error <= FINEST
        || half.points.is_empty()
    {
        return false;
    }
    half.mesh.reduce(0.01 * error.min(before) / before);
    half.mesh.due = half.points.len() + 1;
    let reduced = target(curve, half, settings);
    fit_mesh(curve, half, reduced);
    curve.corrector.mesh_error(&half.last.unknowns) < error
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
