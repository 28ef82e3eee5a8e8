//! Steps that cross to a neighbouring branch, where two come near each other without crossing.

use super::curve::Curve;
use super::curve_point::Interval;
use super::defining_system::solve;
use super::extended::Closing;
use super::located::Located;
use super::newton::NewtonError;

/// (D) Branches nearer than this, in scaled arclength, cross: discretised equations with a symmetry
/// that their meshes do not have miss a branch point by the square root of their error, 1e-7 on
/// usual meshes.
const CROSSING: f64 = 3e-4;

/// Refuses a step that has passed a branch point which is not on the curve.
///
/// The defining system of branch points unfolds the problem, `F + β b = 0`. Where `β ≠ 0` at its
/// solution, branches turn away from each other instead of crossing. With a point of the curve at a
/// distance `s`, of which the linearised equations have the solution at a distance `d`, they are
/// `2 √(d s)` apart, as `u v = d s` is at the bend.
pub(super) fn check_branch_jump(curve: &mut Curve, step: Interval) -> Result<(), NewtonError> {
    let Curve { corrector, detector, recorder, .. } = curve;
    let passed = recorder.solutions && detector.passes_branch_point(step);
    let Some(index) = detector.branch_points().filter(|_| passed) else { return Ok(()) };
    let start = &step.from.unknowns;
    let row = corrector.norm.covector(&step.from.tangent);
    let solved = solve(corrector, &detector.events[index], step.chord(0.5), (&row, start));
    // What is no branch point at all is left to the events.
    let Ok(Located { along: length, unknowns: point, .. }) = solved else { return Ok(()) };
    if !(0.0..=step.length).contains(&length) {
        return Ok(());
    }
    let closing = Closing { row: &row, base: start, length };
    let (equations, mut miss) = (&mut corrector.equations, vec![0.0; point.len()]);
    equations.assemble(start)?;
    equations.factor(Some(&row))?;
    equations.residual(&point, Some(closing), &mut miss)?;
    equations.factors.solve(&mut miss);
    let gap = 2.0 * (corrector.norm.of(&miss) * length).sqrt();
    if gap > CROSSING { Err(NewtonError::BranchJump(gap)) } else { Ok(()) }
}
