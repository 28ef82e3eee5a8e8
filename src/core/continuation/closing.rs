//! Detection of closed curves, which return to their start.

use super::corrector::Corrector;
use super::curve_point::{CurvePoint, Interval};
use super::extended::{Closing, Extended};
use super::located::Located;
use super::newton::scaled_norm;
use crate::core::linalg::{difference, dot};
use crate::core::system::{Kind, Solution};

/// A point near the start of a curve, which a closed curve passes again.
pub(super) struct Reference {
    place: CurvePoint,
    /// The solution on its own mesh, if any.
    saved: Option<Solution>,
    /// The estimated relative error of the solution.
    mesh_error: f64,
}

/// (R) A corrected point closer to the reference than this, in units of the tolerance, is the
/// reference: both points have the error of Newton's method, divided by the smallest singular value
/// of the matrix.
const SAME: f64 = 1e3;

/// (D) The largest ratio between the difference of solutions on different meshes and their
/// estimated errors, which are accurate to a factor of two or three.
const MESHES: f64 = 5.0;

impl Reference {
    pub fn new(corrector: &mut Corrector, place: CurvePoint) -> Self {
        let saved = corrector.solution_at(&place);
        let mesh_error = corrector.mesh_error(&place.unknowns);
        Reference { place, saved: Some(saved).filter(|saved| !saved.mesh.is_empty()), mesh_error }
    }

    /// Returns the distance along a step at which it passes through the reference in the
    /// reference's direction, if it does, as verified by a Newton correction there.
    pub fn passed(&self, corrector: &mut Corrector, step: Interval) -> Option<f64> {
        let CurvePoint { unknowns, tangent, .. } = &self.place;
        let row = corrector.norm.covector(&step.from.tangent);
        let Some(saved) = &self.saved else {
            let forward = dot(&row, tangent) >= 0.0;
            return if forward { passes(corrector, unknowns, step, 0.0) } else { None };
        };
        if !self.may_be_passed(corrector, saved, step) {
            return None;
        }
        let own = unknowns.len() - (step.from.unknowns.len() - corrector.equations.dimension());
        let error = MESHES * (self.mesh_error + corrector.mesh_error(&step.from.unknowns));
        let x = corrector.equations.load(&step.from.unknowns).to_vec();
        let images = corrector.equations.system().discretised()?.images(saved, &x).ok()?;
        images.into_iter().find_map(|z| {
            let unknowns = [&z[..], &unknowns[own..]].concat();
            passes(corrector, &unknowns, step, error)
        })
    }

    /// Whether a step comes near the reference, judged by quantities that do not depend on the
    /// phase: the parameters and the scalar unknowns. With an itinerary, scalar unknowns depend on
    /// the first segment and on the forcing period, and are ignored.
    fn may_be_passed(&self, corrector: &Corrector, saved: &Solution, step: Interval) -> bool {
        let groups = &corrector.equations.names().unknowns;
        let scalars = match saved.itinerary.is_empty() {
            true => groups.iter().rev().take_while(|group| group.length == 1).count(),
            false => 0,
        };
        let first = corrector.equations.dimension() - scalars;
        let (own, place) = (&step.from.unknowns[first..], &self.place.unknowns);
        // On another mesh, a different number of values may precede the scalars.
        let offset = difference(&place[place.len() - own.len()..], own);
        scaled_norm(&offset, &corrector.norm.weights[first..]) <= 1.5 * step.length
    }
}

/// Returns the distance along a step at which it passes through a point with this error, if it
/// does.
fn passes(corrector: &mut Corrector, target: &[f64], step: Interval, error: f64) -> Option<f64> {
    let start = &step.from.unknowns;
    let row = corrector.norm.covector(&step.from.tangent);
    let along = dot(&row, &difference(target, start));
    let slack = error.min(0.01 * step.length);
    if !(-slack..=step.length + slack).contains(&along)
        || corrector.norm.distance(target, start) > 1.5 * step.length
    {
        return None;
    }
    let mut unknowns = step.cubic(&row, along);
    corrector.correct(&mut unknowns, Closing { row: &row, base: start, length: along }).ok()?;
    let miss = corrector.norm.distance(&unknowns, target);
    let exact = SAME * corrector.tolerances.tolerance.max(1e-12);
    (miss < exact.max(error).min(0.1 * step.length)).then_some(along)
}

/// Returns the branch point, among the events found, at which a branch of doubled orbits returns to
/// its parent branch. Beyond this point the branch repeats itself, half a period later.
pub(super) fn returns_to_parent(
    equations: &mut Extended,
    found: &[Located],
    from: &CurvePoint,
) -> Option<usize> {
    let is_crossing = |it: &Located| it.special.kind == Kind::BP && it.special.converged;
    let k = found.iter().position(is_crossing)?;
    let before = equations.load(&from.unknowns).to_vec();
    let there = [&found[k].special.state[..], &found[k].special.parameters].concat();
    let solutions = equations.system().discretised()?;
    solutions.repeats(&there, &before).then_some(k)
}
