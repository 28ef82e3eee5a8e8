//! Curves that come back to their start.

use super::corrector::Corrector;
use super::curve_point::{CurvePoint, Interval};
use super::extended::{Closing, Extended};
use super::located::Located;
use super::newton::scaled_norm;
use crate::core::linalg::{difference, dot};
use crate::core::system::{Kind, Solution};

/// A point of a curve near its start that it passes again if it is closed.
pub(super) struct Reference {
    place: CurvePoint,
    /// The solution on its own mesh, where there is one.
    saved: Option<Solution>,
    /// Its estimated relative error.
    mesh_error: f64,
}

/// (R) A corrected point this near to the reference, in units of the tolerance, is the reference:
/// both points have the error of Newton's iteration, divided by the smallest singular value of the
/// matrix.
const SAME: f64 = 1e3;

/// (D) Solutions on different meshes may differ by this many times their estimated errors, which
/// are good to a factor of two or three.
const MESHES: f64 = 5.0;

impl Reference {
    pub fn new(corrector: &mut Corrector, place: CurvePoint) -> Self {
        let saved = corrector.solution_at(&place);
        let mesh_error = corrector.mesh_error(&place.unknowns);
        Reference { place, saved: Some(saved).filter(|saved| !saved.mesh.is_empty()), mesh_error }
    }

    /// How far along a step it passes through the reference, in its direction: a Newton correction
    /// at the reference's own distance along the step decides.
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

    /// Whether a step comes near the reference as far as can be seen without its phase: by the
    /// parameters and the scalar unknowns. Those of an itinerary depend on the segment and
    /// on the period of the forcing in which it begins.
    fn may_be_passed(&self, corrector: &Corrector, saved: &Solution, step: Interval) -> bool {
        let groups = &corrector.equations.names().unknowns;
        let scalars = match saved.itinerary.is_empty() {
            true => groups.iter().rev().take_while(|group| group.length == 1).count(),
            false => 0,
        };
        let first = corrector.equations.dimension() - scalars;
        let (own, place) = (&step.from.unknowns[first..], &self.place.unknowns);
        // On another mesh there may be another number of values before them.
        let offset = difference(&place[place.len() - own.len()..], own);
        scaled_norm(&offset, &corrector.norm.weights[first..]) <= 1.5 * step.length
    }
}

/// How far along a step it passes through a point that is known with this error.
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

/// Which of the events found is a branch point at which a branch of doubled orbits comes back to
/// the orbits that they are doubles of: beyond it, it is the same branch, half a period later.
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
