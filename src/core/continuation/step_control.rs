//! Step control along a curve: prediction, correction on the hyperplane across the tangent, and
//! adaptation of the step length.

use super::arnoldi::Crossings;
use super::branch_jump::{MESH, branch_point_near, check_branch_jump, check_middle};
use super::corrector::Corrector;
use super::crossing::Departure;
use super::curve::Curve;
use super::curve_error::curve_error;
use super::curve_point::{CurvePoint, Interval};
use super::extended::Closing;
use super::newton::NewtonError;
use super::predictor::Predictor;
use super::settings::Settings;
use crate::core::bifurcation::At;
use crate::core::linalg::{advanced, dot};

/// Heuristic: the largest distance between the corrected and the predicted point, in units of the
/// step.
pub(super) const MOST_DISTANT: f64 = 0.25;

/// Heuristic: the largest angle between the tangents at both ends of a step, in radians. A step
/// with a larger angle may jump to another part of the curve, or pass two special points without
/// detecting them.
pub(super) const LARGEST_ANGLE: f64 = 0.4;
/// Heuristic: the target for the angle between the tangents at both ends of a step, in radians.
/// With this target, the angle between the tangents of the next step is less than `LARGEST_ANGLE`
/// even if the curvature doubles.
const AIMED_ANGLE: f64 = 0.2;
/// Heuristic: the target for the error of the cubic interpolant, in units of `curve_error`. A step
/// that is longer by a factor of 1.75 has ten times the error, and is rejected.
const AIMED_AT: f64 = 0.1;
/// Heuristic: the target for the contraction of the first Newton correction in a step.
const CONTRACTION: f64 = 0.1;

/// Heuristic: the lengths of steps across a branch point, or across an equilibrium to which cycles
/// shrink, in units of the distance to that point.
const BEYOND: [f64; 3] = [2.0, 1.6, 3.0];
/// Heuristic: the smallest distance to a branch point, in scaled arclength, that determines the
/// length of a step across the branch point. With at least this distance, the two branches are well
/// separated at both ends of a step across the branch point.
const CROSSED: f64 = 3e-3;
/// Heuristic: a failed step is near an equilibrium to which cycles shrink if the extrapolated
/// amplitude vanishes within this multiple of the step length.
const VANISHES_WITHIN: f64 = 2.0;
/// Rounding: a cycle counts as an equilibrium if its amplitude relative to the preceding cycle is
/// smaller than this threshold. Where amplitudes vanish at a Hopf point, steps across that point
/// end far beyond it, with a larger amplitude.
const SHRUNK: f64 = 1e-6;
/// Heuristic: the same threshold on curves of special cycles, whose defining systems become singular
/// as the cycles shrink.
const SHRUNK_ON_CURVES: f64 = 0.1;

/// An accepted step of the continuation, with its data.
pub(super) struct Step {
    pub place: CurvePoint,
    /// The length of the step.
    pub length: f64,
    /// The length proposed for the next step.
    pub next: f64,
    /// The branch points that the step has passed, if eigenvalues are not computed.
    pub crossings: Crossings,
    /// The distance between the corrected and the predicted point.
    pub miss: f64,
}

impl Step {
    /// Returns the interval of the curve covered by the step.
    pub fn since<'p>(&'p self, from: &'p CurvePoint) -> Interval<'p> {
        Interval { from, to: &self.place, length: self.length }
    }
}

/// Returns the amplitude of a cycle, relative to the amplitude of the last accepted cycle.
fn amplitude(corrector: &mut Corrector, unknowns: &[f64]) -> Option<f64> {
    corrector.equations.load(unknowns);
    let At { system, x, .. } = corrector.equations.at();
    system.traits(x).amplitude
}

/// Whether a cycle has shrunk to an equilibrium in one step.
fn is_shrunk(corrector: &mut Corrector, unknowns: &[f64]) -> bool {
    let least = if corrector.equations.conditions.is_empty() { SHRUNK } else { SHRUNK_ON_CURVES };
    // Cycles that emanate from an equilibrium have no amplitude for comparison.
    amplitude(corrector, unknowns).is_some_and(|it| it != 0.0 && it.abs() < least)
}

/// Heuristic: the distance from a branch point at the start at which the stability of the branch is
/// computed, as a fraction of the first step.
const BESIDE_START: f64 = 0.02;

/// The step control: contains the limits of the step length, and makes steps.
pub(super) struct StepControl {
    curve_error: f64,
    min_step: f64,
    max_step: f64,
    /// The branch point at which the curve starts, if any.
    departure: Option<Departure>,
}

impl StepControl {
    pub fn new(settings: &Settings, departure: Option<Departure>) -> Self {
        let Settings { curve_error, min_step, max_step, .. } = *settings;
        StepControl { curve_error, min_step, max_step, departure }
    }

    /// Makes one step of at most the given length. If a step fails, shorter steps are tried down to
    /// `min_step`, and longer steps are tried across branch points and equilibria.
    ///
    /// # Errors
    /// The length of the shortest attempted step, and the reason why it failed.
    pub fn step(
        &self,
        curve: &mut Curve,
        predictor: &Predictor,
        from: &CurvePoint,
        mut length: f64,
    ) -> Result<Step, (f64, NewtonError)> {
        let row = curve.corrector.norm.covector(&from.tangent);
        loop {
            let checked = self.checked_step(curve, predictor, from, &row, length);
            if let Some(across) = self.across(curve, predictor, from, &row, (length, &checked)) {
                return Ok(across);
            }
            let failure = match checked {
                Ok(step) => return Ok(step),
                Err(failure) => failure,
            };
            if let Some(across) = self.across_equilibrium(curve, predictor, from, &row, length) {
                return Ok(across);
            }
            if length * 0.5 < self.min_step {
                return Err((length, failure));
            }
            length *= 0.5;
        }
    }

    /// Returns the number of unstable eigenvalues beside a start on a branch point, where one eigenvalue
    /// is zero; `None` if the number is unknown. The length of the first step is given.
    pub fn stability_beside(
        &self,
        curve: &mut Curve,
        start: &CurvePoint,
        length: f64,
    ) -> Option<usize> {
        let row = curve.corrector.norm.covector(&start.tangent);
        let none = Predictor::default();
        let step = self.try_step(curve, &none, start, &row, BESIDE_START * length).ok()?;
        step.place.point.unstable
    }

    /// Makes one step of the given length, and rejects a jump to another branch.
    fn checked_step(
        &self,
        curve: &mut Curve,
        predictor: &Predictor,
        from: &CurvePoint,
        row: &[f64],
        length: f64,
    ) -> Result<Step, NewtonError> {
        let step = self.try_step(curve, predictor, from, row, length)?;
        check_branch_jump(curve, step.since(from))?;
        check_middle(curve, step.since(from), step.miss)?;
        Ok(step)
    }

    /// Makes a step across an equilibrium to which cycles shrink, after a step of the given length
    /// has failed. The equations are singular at the equilibrium, and successively shorter steps
    /// would only approach it.
    fn across_equilibrium(
        &self,
        curve: &mut Curve,
        predictor: &Predictor,
        from: &CurvePoint,
        row: &[f64],
        length: f64,
    ) -> Option<Step> {
        // The relative amplitude is 1 at `from`, and linear in the unknowns. It is undefined for
        // cycles that emanate from an equilibrium.
        let ahead = advanced(&from.unknowns, length, &from.tangent);
        let left = amplitude(&mut curve.corrector, &ahead).filter(|left| *left != 0.0)?;
        let lost = 1.0 - left;
        let way = length / lost;
        if !lost.is_finite() || lost * VANISHES_WITHIN < 1.0 {
            return None;
        }
        let lengths = BEYOND.iter().map(|share| share * way);
        let mut lengths = lengths.filter(|length| *length <= self.max_step);
        lengths.find_map(|length| self.checked_step(curve, predictor, from, row, length).ok())
    }

    /// Makes a step across a branch point, after a step has turned to the other branch. Steps turn
    /// to the other branch if a mesh without the symmetry of the problem separates the branches
    /// that cross at the branch point.
    fn across(
        &self,
        curve: &mut Curve,
        predictor: &Predictor,
        from: &CurvePoint,
        row: &[f64],
        (length, tried): (f64, &Result<Step, NewtonError>),
    ) -> Option<Step> {
        // Slopes that may be errors of the mesh do not indicate a reversal.
        let slope = |place: &CurvePoint| {
            let slope = curve.corrector.slope(&place.tangent);
            if slope.abs() > place.vertical { slope } else { 0.0 }
        };
        let turned = match tried {
            Ok(Step { place, .. }) => {
                let flips =
                    curve.detector.passes_branch_point(Interval { from, to: place, length });
                slope(from) * slope(place) < 0.0 && !flips
            }
            Err(
                NewtonError::Far { .. } | NewtonError::Turned { .. } | NewtonError::Bent { .. },
            ) => slope(from) != 0.0,
            Err(_) => false,
        };
        // Only the error of a mesh separates branches that cross.
        let reached = tried.as_ref().map_or(&from.unknowns, |step| &step.place.unknowns);
        let turned = turned && curve.recorder.solutions;
        if !turned || curve.corrector.mesh_error(reached) == 0.0 {
            return None;
        }
        let guess = advanced(&from.unknowns, 0.5 * length, &from.tangent);
        let near = branch_point_near(curve, from, guess, length).ok()??;
        if !near.crosses {
            return None;
        }
        BEYOND.iter().find_map(|share| {
            let length = share * near.along.max(CROSSED);
            let step = self.try_step(curve, predictor, from, row, length).ok()?;
            curve.detector.passes_branch_point(step.since(from)).then_some(step)
        })
    }

    /// Makes one step of the given length.
    pub fn try_step(
        &self,
        curve: &mut Curve,
        predictor: &Predictor,
        from: &CurvePoint,
        row: &[f64],
        length: f64,
    ) -> Result<Step, NewtonError> {
        let (norm, names) = (&curve.corrector.norm, curve.corrector.equations.names());
        let (predicted, order) = predictor.predict(norm, names, from, row, length);
        let mut unknowns = predicted.clone();
        let closing = Closing { row, base: &from.unknowns, length };
        let report = curve.corrector.correct(&mut unknowns, closing)?;
        let distance = curve.corrector.norm.distance(&unknowns, &predicted);
        if distance > MOST_DISTANT * length.max(MESH) {
            return Err(NewtonError::Far { distance, length });
        }
        if is_shrunk(&mut curve.corrector, &unknowns) {
            return Err(NewtonError::Shrunk(length));
        }
        if let (None, Some(departure)) = (predictor.last(), &self.departure) {
            departure.check(&curve.corrector.norm, &unknowns, length)?;
        }
        let stability = curve.recorder.wants_stability();
        let tangent = curve.tangent(&unknowns, row, report.matrix_error, stability)?;
        let angle = dot(row, &tangent).clamp(-1.0, 1.0).acos();
        if angle > LARGEST_ANGLE && length > 2.0 * self.min_step {
            return Err(NewtonError::Turned { angle, largest: LARGEST_ANGLE });
        }
        let mut place = curve.point(unknowns, tangent, stability)?;
        let crossings = curve.crossings(from, row, length, &mut place);
        // The derivatives were evaluated at another point.
        curve.corrector.equations.load(&place.unknowns);
        let before = predictor.last().map(|earlier| &earlier.place);
        let error = curve_error(&curve.corrector.norm, before, from, &place);
        if error > self.curve_error {
            return Err(NewtonError::Bent { error, largest: self.curve_error });
        }
        let next = self.next_length(length, (report.contraction, order), angle, error);
        Ok(Step { place, length, next, crossings, miss: distance })
    }

    /// Computes the length of the next step from the targets for the contraction, the angle and the
    /// error of the cubic interpolant. The contraction is proportional to the step length to the
    /// power `order` of the predictor, the angle to the step length, and the error of the cubic
    /// interpolant to its fourth power.
    fn next_length(
        &self,
        length: f64,
        (contraction, order): (f64, i32),
        angle: f64,
        error: f64,
    ) -> f64 {
        let by_angle = AIMED_ANGLE / angle.max(1e-9);
        let by_contraction = (CONTRACTION / contraction.max(1e-9)).powf(f64::from(order).recip());
        let by_error = (AIMED_AT * self.curve_error / error.max(1e-15)).powf(0.25);
        let factor = by_angle.min(by_contraction).min(by_error).clamp(0.5, 2.0);
        (length * factor).clamp(self.min_step, self.max_step)
    }
}
