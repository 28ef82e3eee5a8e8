//! Detection of closed curves, which return to their starting point.

use super::corrector::Corrector;
use super::curve_point::{CurvePoint, Interval};
use super::extended::{Closing, Extended};
use super::located::Located;
use super::newton::scaled_norm;
use crate::core::linalg::{difference, dot};
use crate::core::problem::Dynamics;
use crate::core::system::{Kind, Solution};

/// A reference point near the start of a curve, which a closed curve passes again.
pub(super) struct Reference {
    place: CurvePoint,
    /// The solution at the reference point, stored with its mesh; `None` if solutions have no mesh.
    saved: Option<Solution>,
    /// The estimated relative discretisation error of the solution at the reference point.
    mesh_error: f64,
}

/// Rounding: a corrected point is identified with the reference point if their distance is smaller
/// than this threshold, in units of the tolerance of Newton's method. The error of the corrected
/// point, like the error of the reference point, is the tolerance divided by the smallest singular
/// value of the Jacobian.
const SAME: f64 = 1e3;

/// Discretisation: two solutions on different meshes count as the same solution if their difference
/// is at most this factor times the sum of their estimated errors; the estimates are accurate to a
/// factor of two or three.
const MESHES: f64 = 5.0;

impl Reference {
    pub fn new(corrector: &mut Corrector, place: CurvePoint) -> Self {
        let saved = corrector.solution_at(&place);
        let mesh_error = corrector.mesh_error(&place.unknowns);
        Reference { place, saved: Some(saved).filter(|saved| !saved.mesh.is_empty()), mesh_error }
    }

    /// Returns the distance along a step at which the curve passes through the reference point in
    /// the same direction as at the start; `None` if the curve does not pass through it. The
    /// passage is verified by a Newton correction.
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

    /// Whether a step passes near the reference point, judged only by the quantities that do not
    /// depend on the phase: the parameters and the scalar unknowns. For orbits with an itinerary,
    /// only the parameters are compared, because scalar unknowns depend on the choice of the first
    /// segment and on the forcing period.
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

/// Returns the distance along a step at which the curve passes through the point `target`, which is
/// known up to the error `error`; `None` if the curve does not pass through the point.
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

/// Returns the index in `found` of the branch point at which a branch of period-doubled orbits
/// returns to its parent branch. Beyond this branch point, the period-doubled branch consists of
/// the same orbits again, shifted by half a period. Returns `None` unless the solutions are orbits.
pub(super) fn returns_to_parent(
    equations: &mut Extended,
    found: &[Located],
    from: &CurvePoint,
) -> Option<usize> {
    if equations.system().dynamics() != Dynamics::Periodic {
        return None;
    }
    let is_crossing = |it: &Located| it.special.kind == Kind::BP && it.special.converged;
    let k = found.iter().position(is_crossing)?;
    let before = equations.load(&from.unknowns).to_vec();
    let there = [&found[k].special.state[..], &found[k].special.parameters].concat();
    let solutions = equations.system().discretised()?;
    solutions.repeats(&there, &before).then_some(k)
}
