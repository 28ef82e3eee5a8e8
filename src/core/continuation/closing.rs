//! Curves that come back to their start.

use super::hermite::hermite;
use super::located::Located;
use super::predictor::knots_of;
use super::stepper::{Place, Step, Stepper};
use crate::core::extended::Closing;
use crate::core::kind::Kind;
use crate::core::newton::scaled_norm;
use crate::core::solution::Solution;
use crate::core::vector::{difference, dot};

/// A place of a curve near its start that it passes again if it is closed.
pub(super) struct Reference {
    pub place: Place,
    /// The solution on its own mesh, where there is one.
    saved: Option<Solution>,
    /// Its estimated relative error.
    mesh_error: f64,
}

/// A corrected point this near to the reference, in units of the tolerance, is the reference.
const SAME: f64 = 1e3;

/// Solutions on different meshes may differ by this many times their estimated errors.
const MESHES: f64 = 5.0;

impl Stepper<'_> {
    /// Which of the events found is a branch point at which a branch of doubled orbits comes back
    /// to the orbits that they are doubles of: beyond it, it is the same branch, half a period
    /// later.
    pub fn returns_to_parent(&mut self, found: &[Located], from: &Place) -> Option<usize> {
        let is_crossing = |it: &Located| it.special.kind == Kind::BP && it.special.converged;
        let k = found.iter().position(is_crossing)?;
        let equations = &mut self.equations;
        let before = equations.load(&from.unknowns).to_vec();
        let n = equations.dimension();
        let there = [&found[k].special.state[..], &before[n..]].concat();
        let cycles = equations.system().cycles()?;
        (cycles.repeats(&there) && !cycles.repeats(&before)).then_some(k)
    }

    /// The solution at a place, on the present mesh.
    pub fn solution_at(&mut self, place: &Place) -> Solution {
        let n = self.equations.dimension();
        let x = self.equations.load(&place.unknowns);
        let [state, parameters] = [&x[..n], &x[n..]].map(<[f64]>::to_vec);
        let system = self.equations.system();
        let (itinerary, method, mesh) = (system.words(), system.method(), system.mesh());
        let (kind, tangent, switch) = (Kind::EP, None, None);
        Solution { kind, itinerary, method, mesh, state, parameters, tangent, switch }
    }

    /// A place that a curve passes again if it is closed.
    pub fn reference(&mut self, place: Place) -> Reference {
        let saved = self.solution_at(&place);
        let mesh_error = self.mesh_error(&place.unknowns);
        Reference { place, saved: Some(saved).filter(|saved| !saved.mesh.is_empty()), mesh_error }
    }

    /// How far along a step it passes through the reference, in its direction: a Newton correction
    /// at the reference's own distance along the step decides.
    pub fn closes(&mut self, reference: &Reference, from: &Place, step: &Step) -> Option<f64> {
        let row = self.covector(&from.tangent);
        let Some(saved) = &reference.saved else {
            let Place { unknowns, tangent, .. } = &reference.place;
            let forward = dot(&row, tangent) >= 0.0;
            return if forward { self.passes(unknowns, from, step, 0.0) } else { None };
        };
        if !self.may_pass(&reference.place, saved, from, step) {
            return None;
        }
        let error = MESHES * (reference.mesh_error + self.mesh_error(&from.unknowns));
        let x = self.equations.load(&from.unknowns).to_vec();
        let images = self.equations.system().discretised()?.images(saved, &x).ok()?;
        let n = self.equations.dimension();
        images.into_iter().find_map(|z| {
            let unknowns = [&z[..], &reference.place.unknowns[n..]].concat();
            self.passes(&unknowns, from, step, error)
        })
    }

    /// Whether a step comes near a place as far as can be seen without its phase: by the parameters
    /// and the scalar unknowns. Those of an itinerary depend on the leg and on the period of the
    /// forcing in which it begins.
    fn may_pass(&self, place: &Place, saved: &Solution, from: &Place, step: &Step) -> bool {
        let groups = &self.equations.names().unknowns;
        let scalars = match saved.itinerary.is_empty() {
            true => groups.iter().rev().take_while(|group| group.length == 1).count(),
            false => 0,
        };
        let first = self.equations.dimension() - scalars;
        let offset = difference(&place.unknowns[first..], &from.unknowns[first..]);
        scaled_norm(&offset, &self.weights[first..]) <= 1.5 * step.length
    }

    fn passes(&mut self, target: &[f64], from: &Place, step: &Step, error: f64) -> Option<f64> {
        let row = self.covector(&from.tangent);
        let offset = difference(target, &from.unknowns);
        let along = dot(&row, &offset);
        let distance = scaled_norm(&offset, &self.weights);
        let slack = error.min(0.01 * step.length);
        if !(-slack..=step.length + slack).contains(&along) || distance > 1.5 * step.length {
            return None;
        }
        let mut unknowns = hermite(&knots_of(from, (&step.place, step.length), &row), along);
        let closing = Closing { row: &row, base: &from.unknowns, length: along };
        self.correct(&mut unknowns, closing).ok()?;
        let miss = scaled_norm(&difference(&unknowns, target), &self.weights);
        let exact = SAME * self.settings.tolerance.max(1e-12);
        (miss < exact.max(error).min(0.1 * step.length)).then_some(along)
    }
}
