//! Steps that cross to a neighbouring branch, where two come near each other without crossing, or
//! past a piece of their own.

use super::curve::Curve;
use super::curve_point::{CurvePoint, Interval};
use super::defining_system::solve;
use super::extended::Closing;
use super::located::Located;
use super::newton::NewtonError;

/// (D) Branches nearer than this, in scaled arclength, cross: discretised equations with a symmetry
/// that their meshes do not have miss a branch point by the square root of their error, 1e-7 on
/// usual meshes, and more on coarse ones.
const CROSSING: f64 = 3e-4;

/// A branch point near a step of a curve.
pub(super) struct Near {
    /// How far behind the first point of the step it lies.
    pub along: f64,
    /// How far from each other the branches turn away there, instead of crossing.
    pub gap: f64,
    /// Whether they cross, but for the error of a mesh.
    pub crosses: bool,
}

/// The branch point near a guess, within a step of this length; `None` if there is none.
///
/// The defining system of branch points unfolds the problem, `F + β b = 0`. Where `β ≠ 0` at its
/// solution, branches turn away from each other instead of crossing. With a point of the curve at a
/// distance `s`, of which the linearised equations have the solution at a distance `d`, they are
/// `2 √(d s)` apart, as `u v = d s` is at the bend.
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
    // What is no branch point at all is left to the events.
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

/// Refuses a step that has passed a branch point which is not on the curve.
pub(super) fn check_branch_jump(curve: &mut Curve, step: Interval) -> Result<(), NewtonError> {
    if !curve.recorder.solutions || !curve.detector.passes_branch_point(step) {
        return Ok(());
    }
    match branch_point_near(curve, step.from, step.chord(0.5), step.length)? {
        Some(near) if !near.crosses => Err(NewtonError::BranchJump(near.gap)),
        _ => Ok(()),
    }
}

/// (H) A point that misses its prediction by less than this part of the step belongs to the same
/// smooth piece of the curve.
const WELL_PREDICTED: f64 = 0.01;

/// (H) In the middle of a step the curve is not farther than this, in units of the step, from the
/// cubic with the tangents of both ends: predictions that miss by `WELL_PREDICTED` leave the cubic
/// by a sixteenth of that.
const MOST_BENT: f64 = 0.02;

/// (D) Shorter steps than this may be as long as the error with which a solution is carried over to
/// a new mesh.
pub(super) const MESH: f64 = 1e-3;

/// Not quite in the middle, where symmetric problems may be singular.
const MIDDLE: f64 = 0.517;

/// Refuses a step whose end was predicted badly if the curve does something else in between, as a
/// narrow piece with two folds does, or a branch that turns back at the tip of a pitchfork.
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
    // What is assembled belongs to the end of the step.
    corrector.equations.load(&step.to.unknowns);
    if distance > MOST_BENT * scale { Err(NewtonError::Far { distance, length }) } else { Ok(()) }
}
