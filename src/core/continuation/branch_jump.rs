//! Branch-jump detection: rejects a continuation step that crosses to a neighbouring branch, or
//! that skips part of the branch.

use super::curve::Curve;
use super::curve_point::{CurvePoint, Interval};
use super::defining_system::solve;
use super::extended::Closing;
use super::located::Located;
use super::newton::NewtonError;

/// Discretisation: two branches closer to each other than this threshold, in scaled arclength, are
/// considered to cross. A mesh that lacks a symmetry of the equations perturbs a branch point into
/// two separate branches; their distance is the square root of the discretisation error, which is
/// 1e-7 on usual meshes and larger on coarse meshes.
const CROSSING: f64 = 3e-4;

/// Heuristic: the largest first correction of Newton's method towards a branch point near a step, in
/// units of the step. A branch point within the step is at most one step away from the guess, and
/// nearly linear equations lead there directly.
const REACH: f64 = 4.0;

/// A branch point near a continuation step, or a nearly crossing branch.
pub(super) struct Near {
    /// The distance of the branch point from the first point of the step.
    pub along: f64,
    /// The smallest distance between the two branches if they turn away from each other instead of
    /// crossing.
    pub gap: f64,
    /// Whether the two branches cross, up to the discretisation error of the mesh.
    pub crosses: bool,
}

/// Finds a branch point near a guess, within a step of the given length; `None` if no branch point
/// is found.
///
/// The defining system of branch points unfolds the problem, `F + β b = 0`. If `β ≠ 0` at the
/// solution of this defining system, the two branches turn away from each other instead of
/// crossing. Let `s` be the distance of the solution from the point `from` of the curve, measured
/// along the tangent at `from`. Let `d` be the size of the Newton correction of the branch-point
/// system's solution, computed with the equations linearised at `from`. Near the solution of the
/// defining system, the two branches are close to the hyperbola `u v = d s`, where `u` and `v` are
/// the coordinates along its asymptotes. The distance between the branches is therefore `2 √(d s)`.
pub(super) fn branch_point_near(
    curve: &mut Curve,
    from: &CurvePoint,
    guess: Vec<f64>,
    length: f64,
) -> Result<Option<Near>, NewtonError> {
    let Curve { corrector, detector, .. } = curve;
    let Some(index) = detector.branch_points() else { return Ok(None) };
    let start = &from.unknowns;
    let row = corrector.norm.covector(&from.tangent);
    let all = corrector.event_tolerances;
    corrector.event_tolerances.reach = REACH * length;
    let solved = solve(corrector, &detector.events[index], guess, (&row, start));
    corrector.event_tolerances = all;
    // If the defining system does not converge, the event locator handles the point.
    let Ok(Located { along, unknowns: point, .. }) = solved else { return Ok(None) };
    if !(0.0..=length).contains(&along) {
        return Ok(None);
    }
    let closing = Closing { row: &row, base: start, length: along };
    let (equations, mut miss) = (&mut corrector.equations, vec![0.0; point.len()]);
    equations.assemble(start)?;
    equations.factor(Some(&row))?;
    equations.residual(&point, Some(closing), &mut miss)?;
    equations.factors.solve(&mut miss);
    let gap = 2.0 * (corrector.norm.of(&miss) * along).sqrt();
    let crosses = gap <= CROSSING.max(corrector.mesh_error(start).sqrt());
    Ok(Some(Near { along, gap, crosses }))
}

/// Rejects a step that has crossed to another branch, which is the case if the step has passed a
/// branch point that does not lie on the curve.
pub(super) fn check_branch_jump(curve: &mut Curve, step: Interval) -> Result<(), NewtonError> {
    if !curve.recorder.solutions || !curve.detector.passes_branch_point(step) {
        return Ok(());
    }
    match branch_point_near(curve, step.from, step.chord(0.5), step.length)? {
        Some(near) if !near.crosses => Err(NewtonError::BranchJump(near.gap)),
        _ => Ok(()),
    }
}

/// Heuristic: a new point lies on the same smooth part of the curve as the previous point if its
/// prediction error is smaller than this fraction of the step.
const WELL_PREDICTED: f64 = 0.01;

/// Heuristic: the largest distance between the curve and the cubic Hermite interpolant of both ends
/// and their tangents, measured in the middle of the step and in units of the step. A prediction
/// error of `WELL_PREDICTED` corresponds to a distance from the interpolant that is one sixteenth
/// as large.
const MOST_BENT: f64 = 0.02;

/// Discretisation: a step shorter than this threshold may be no longer than the error of
/// interpolating a solution to a new mesh.
pub(super) const MESH: f64 = 1e-3;

/// The position of the checked point as a fraction of the step. The checked point is not exactly in
/// the middle of the step, because symmetric problems may be singular in the middle.
const MIDDLE: f64 = 0.517;

/// Rejects a step with a large prediction error if the branch deviates from a smooth curve in the
/// middle of the step. Examples are a narrow part of the branch with two folds, and a branch that
/// turns back at the tip of a pitchfork.
pub(super) fn check_middle(
    curve: &mut Curve,
    step: Interval,
    miss: f64,
) -> Result<(), NewtonError> {
    let Curve { corrector, recorder, .. } = curve;
    let length = step.length;
    let scale = length.max(MESH);
    if miss <= WELL_PREDICTED * scale || !recorder.solutions {
        return Ok(());
    }
    let row = corrector.norm.covector(&step.from.tangent);
    let guess = step.cubic(&row, MIDDLE * length);
    let mut middle = guess.clone();
    let closing = Closing { row: &row, base: &step.from.unknowns, length: MIDDLE * length };
    corrector.correct(&mut middle, closing).map_err(|failure| match failure {
        NewtonError::Stagnation { .. } | NewtonError::IterationLimit { .. } => {
            NewtonError::NoMiddle(length)
        }
        other => other,
    })?;
    let distance = corrector.norm.distance(&middle, &guess);
    // The assembled equations belong to the end of the step.
    corrector.equations.load(&step.to.unknowns);
    if distance > MOST_BENT * scale { Err(NewtonError::Far { distance, length }) } else { Ok(()) }
}
