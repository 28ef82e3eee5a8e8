//! Adaptation of the number of mesh intervals along a curve.

use super::curve::Curve;
use super::curve_point::CurvePoint;
use super::extended::{Closing, Extended};
use super::half::Half;
use super::metric::Metric;
use super::newton::NewtonError;
use crate::core::failure::Failure;
use crate::core::system::{Kind, Solution};

/// Heuristic: the number of points after which a coarser mesh is tried again, if a coarser mesh has
/// failed.
const PATIENCE: usize = 10;

/// The points of one half of a branch that are interpolated to a new mesh, together with their
/// previous mesh.
struct Before {
    solution: Solution,
    metric: Metric,
    last: CurvePoint,
    others: Vec<[Vec<f64>; 2]>,
    /// The discretisation error on the previous mesh.
    error: f64,
}

/// Adapts the number of mesh intervals to the last point of one half of a branch, and corrects this
/// point on the new mesh. The old mesh is kept if the correction fails, if an event would be
/// missed, or if the error on the new mesh exceeds both the old error and the target.
pub(super) fn fit_mesh(curve: &mut Curve, half: &mut Half, target: f64) {
    let is_fine = curve.corrector.mesh_error(&half.last.unknowns) <= target;
    if is_fine && half.points.len() < half.keeps_mesh
        || !curve.corrector.needs_fit(&half.last.unknowns, target)
    {
        return;
    }
    let corrector = &mut curve.corrector;
    let before = Before {
        error: corrector.mesh_error(&half.last.unknowns),
        solution: corrector.solution_at(&half.last),
        metric: corrector.norm.metric.clone(),
        last: half.last.clone(),
        others: others(half).map(|it| [it.unknowns.clone(), it.tangent.clone()]).collect(),
    };
    let mut unknowns = half.last.unknowns.clone();
    let earlier = std::iter::once(&mut half.start).chain(half.predictor.places());
    let mut directions: Vec<&mut Vec<f64>> =
        earlier.flat_map(|it| [&mut it.unknowns, &mut it.tangent]).collect();
    directions.push(&mut half.last.tangent);
    if !corrector.fit(&mut unknowns, &mut directions, target) {
        return;
    }
    let row = curve.corrector.norm.covector(&half.last.tangent);
    let is_resized = unknowns.len() != before.last.unknowns.len();
    match arrived(curve, unknowns, &row, is_resized) {
        Ok(place)
            if same_side(curve, &before.last, &place)
                && curve.corrector.mesh_error(&place.unknowns) <= before.error.max(target) =>
        {
            take(curve, half, place);
        }
        _ => {
            half.keeps_mesh = half.points.len() + PATIENCE;
            go_back(curve, half, before);
        }
    }
}

/// Corrects the last point of one half of a branch on the mesh to which it was interpolated. After
/// a large change of the mesh, the interpolated point may be far from the curve. If the point is
/// the start of the branch, the continued parameter is fixed.
pub(super) fn settle(curve: &mut Curve, half: &mut Half) {
    let unknowns = half.last.unknowns.clone();
    let mut row = curve.corrector.norm.covector(&half.last.tangent);
    if half.points.is_empty()
        && curve.corrector.slope(&half.last.tangent).abs() > half.last.vertical
    {
        let parameter = curve.corrector.equations.parameters_at();
        row.fill(0.0);
        row[parameter] = half.last.tangent[parameter].signum();
    }
    if let Ok(place) = arrived(curve, unknowns, &row, false)
        && same_side(curve, &half.last, &place)
    {
        take(curve, half, place);
    }
}

/// Iterates over the points of one half of a branch that are interpolated to the new mesh, except
/// the last point.
fn others(half: &mut Half) -> impl Iterator<Item = &mut CurvePoint> {
    std::iter::once(&mut half.start).chain(half.predictor.places())
}

/// Corrects a point on the current mesh, in the hyperplane that passes through the point and is
/// defined by the covector `row`. If the number of unknowns has changed, the held defining systems
/// need new borders.
fn arrived(
    curve: &mut Curve,
    mut unknowns: Vec<f64>,
    row: &[f64],
    is_resized: bool,
) -> Result<CurvePoint, NewtonError> {
    let Curve { corrector, detector, recorder, refiner, .. } = &mut *curve;
    let metric = corrector.norm.metric.clone();
    let restored = corrector.restore(&unknowns, metric, &refiner.held);
    if is_resized {
        restored?;
    }
    let base = unknowns.clone();
    corrector.correct(&mut unknowns, Closing { row, base: &base, length: 0.0 })?;
    corrector.equations.load(&unknowns);
    detector.start(&mut corrector.equations)?;
    let stability = recorder.wants_stability();
    Ok(curve.arrive(unknowns, row, f64::INFINITY, stability)?)
}

/// Whether the test functions of all events at a point have the same signs as on its former mesh.
/// A change of the sign of the continued parameter's slope is ignored if the number of unstable
/// multipliers is unchanged: at a true fold, a multiplier would pass 1, so the sign change is a
/// discretisation error.
fn same_side(curve: &Curve, before: &CurvePoint, after: &CurvePoint) -> bool {
    let counts = [before.point.unstable, after.point.unstable];
    let no_fold = counts[0].is_some() && counts[0] == counts[1];
    let is_decided = |index: usize| {
        let fold = curve.detector.events[index].kind == Kind::LP;
        !(curve.detector.is_sign_free(index) || fold && no_fold)
    };
    let tests = before.tests.iter().zip(&after.tests).enumerate();
    let mut decided = tests.filter(|(index, _)| is_decided(*index));
    let flips = |before: &Option<f64>, after: &Option<f64>| match (before, after) {
        (Some(before), Some(after)) => before * after < 0.0,
        _ => false,
    };
    !decided.any(|(_, (before, after))| flips(before, after))
}

/// Updates the sign of the determinant at a point on the current mesh, with the tangent of the
/// branch at this point. The sign of the discretised phase condition is constant only as long as
/// the mesh is unchanged, so the determinant may change sign after a return to an earlier mesh.
pub(super) fn restate_determinant(
    curve: &mut Curve,
    place: &mut CurvePoint,
) -> Result<bool, Failure> {
    let row = curve.corrector.norm.covector(&place.tangent);
    curve.corrector.equations.assemble(&place.unknowns)?;
    curve.corrector.factor_at(&place.unknowns, &row)?;
    let turned = curve.corrector.equations.factors.determinant_sign() * place.determinant < 0.0;
    if turned {
        turn_determinant(curve, place);
    }
    Ok(turned)
}

/// Reverses the sign of the determinant at a point, and of the test function of branch points.
fn turn_determinant(curve: &Curve, place: &mut CurvePoint) {
    place.determinant = -place.determinant;
    if let Some(index) = curve.detector.branch_points() {
        place.tests[index] = place.tests[index].map(|test| -test);
    }
}

/// Replaces the last point by a point on the new mesh, and adapts the signs of determinants and of
/// null vectors at all points to this mesh.
fn take(curve: &Curve, half: &mut Half, mut place: CurvePoint) {
    let last = &half.last;
    for (test, before) in place.tests.iter_mut().zip(&last.tests) {
        // A curve that starts on a level leaves the level; rounding does not bring it back.
        let starts = half.points.is_empty() && *before == Some(0.0);
        *test = if starts { *before } else { test.or(*before) };
    }
    place.stability = place.stability.or(last.stability);
    place.point.solution.clone_from(&last.point.solution);
    place.point.slopes.clone_from(&last.point.slopes);
    let flipped: Vec<bool> = (place.tests.iter().zip(&last.tests).enumerate())
        .map(|(index, (new, old))| {
            let opposite = new.zip(*old).is_some_and(|(new, old)| new * old < 0.0);
            curve.detector.is_sign_free(index) && opposite
        })
        .collect();
    let turned = place.determinant * last.determinant < 0.0;
    for earlier in half.predictor.places() {
        let tests = earlier.tests.iter_mut().zip(&flipped).filter(|(_, flipped)| **flipped);
        tests.for_each(|(test, _)| *test = test.map(|test| -test));
        earlier.determinant = if turned { -earlier.determinant } else { earlier.determinant };
    }
    half.last = place;
}

/// Restores the mesh of an earlier solution with the given unknowns.
pub(super) fn return_to_mesh(equations: &mut Extended, solution: &Solution, unknowns: &[f64]) {
    if let Some(discretised) = equations.system().discretised() {
        // The solution was computed on this mesh; if it no longer fits, the next step fails.
        let _ = discretised.return_to(solution);
    }
    equations.adopt(unknowns);
}

/// Restores the previous mesh, after a new mesh was rejected.
fn go_back(curve: &mut Curve, half: &mut Half, before: Before) {
    let Before { solution, metric, last, others: saved, error: _ } = before;
    let Curve { corrector, detector, refiner, .. } = curve;
    return_to_mesh(&mut corrector.equations, &solution, &last.unknowns);
    // The defining systems were started on this mesh before.
    let _ = corrector.restore(&last.unknowns, metric, &refiner.held);
    for (place, [unknowns, tangent]) in others(half).zip(saved) {
        (place.unknowns, place.tangent) = (unknowns, tangent);
    }
    half.last = last;
    corrector.equations.load(&half.last.unknowns);
    let _ = detector.start(&mut corrector.equations);
    if restate_determinant(curve, &mut half.last) == Ok(true) {
        others(half).for_each(|place| turn_determinant(curve, place));
    }
}
