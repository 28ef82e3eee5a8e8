//! Branch-jump detection: rejects a step that crosses to a neighbouring branch, or that skips part
//! of its own branch.

use super::curve::Curve;
use super::curve_point::{CurvePoint, Interval};
use super::defining_system::solve;
use super::extended::Closing;
use super::located::Located;
use super::newton::NewtonError;

/// (D) Branches closer than this, in scaled arclength, are considered to cross. Discretised
/// equations with a symmetry that their mesh lacks miss a branch point by the square root of their
/// error: 1e-7 on usual meshes, and more on coarse ones.
const CROSSING: f64 = 3e-4;

/// A branch point near a step of a curve.
pub(super) struct Near {
    /// The distance of the branch point from the first point of the step.
    pub along: f64,
    /// The distance between the two branches where they turn away from each other instead of
    /// crossing.
    pub gap: f64,
    /// Whether the branches cross, up to the error of a mesh.
    pub crosses: bool,
}

/// Finds a branch point near a guess, within a step of this length; `None` if no branch point is
/// found.
///
/// The defining system of branch points unfolds the problem, `F + β b = 0`. If `β ≠ 0` at its
/// solution, the branches turn away from each other instead of crossing. Let `s` be the distance of
/// the solution from a point of the curve along the tangent of this point, and `d` the size of
/// Newton's correction of the solution with the equations linearised at this point. Near the
/// solution the branches are close to the hyperbola `u v = d s`, where `u` and `v` are the
/// coordinates along its asymptotes, so their separation is `2 √(d s)`.
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
    let solved = solve(corrector, &detector.events[index], guess, (&row, start));
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

/// Rejects a step that has passed a branch point which is not on the curve.
pub(super) fn check_branch_jump(curve: &mut Curve, step: Interval) -> Result<(), NewtonError> {
    if !curve.recorder.solutions || !curve.detector.passes_branch_point(step) {
        return Ok(());
    }
    match branch_point_near(curve, step.from, step.chord(0.5), step.length)? {
        Some(near) if !near.crosses => Err(NewtonError::BranchJump(near.gap)),
        _ => Ok(()),
    }
}

/// (H) If the prediction error of a point is less than this fraction of the step, the point is on
/// the same smooth piece of the curve.
const WELL_PREDICTED: f64 = 0.01;

/// (H) The largest distance, in units of the step, between the curve and the cubic with the
/// tangents of both ends in the middle of a step: a prediction error of `WELL_PREDICTED`
/// corresponds to one sixteenth of that from the cubic.
const MOST_BENT: f64 = 0.02;

/// (D) Steps shorter than this may be as short as the error of interpolating a solution to a new
/// mesh.
pub(super) const MESH: f64 = 1e-3;

/// The checked point is not exactly in the middle, where symmetric problems may be singular.
const MIDDLE: f64 = 0.517;

/// Rejects a step with a large prediction error if the middle of the curve deviates from a smooth
/// curve, as at a narrow piece with two folds, or a branch that turns back at the tip of a
/// pitchfork.
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
