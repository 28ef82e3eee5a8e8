//! A boundary-value problem, discretised, as a [`System`].

mod adaptation;
mod carry;
mod equations;
mod factorisation;
mod layout;
mod linearisation;
mod local;
mod mesh_error;
mod monitors;
mod periodic;
mod profiles;
mod start;

use super::chunk::Chunk;
use super::{BoundaryError, BoundaryProblem, Mesh, Method};
use crate::core::condition::EvaluationError;
use crate::core::motion::Oscillation;
use crate::core::solution::{Adopted, Solution};
use crate::core::zero::{
    Border, Dynamics, Group, LeftDomain, Names, Profile, Refinement, Singular, Slot, Spectrum,
    System,
};
use carry::Onto;
use equations::{Equations, Work};
use factorisation::{Factorisation, Form};
use layout::Layout;
use linearisation::Linearisation;
use local::{Passes, Weighted};
use num_dual::{Dual, Dual2, Dual64, HyperDual64, HyperHyperDual64};
use periodic::Rotating;

/// No segment is refined beyond this number of intervals: rounding would take over.
const MOST_INTERVALS: usize = 4096;

/// A boundary-value problem, discretised by a method on one mesh for each segment.
///
/// Unknowns `z`: for each segment and each state a group of values at the segment's nodes (`N·m + 1` of them
/// for `N` intervals with `m` nodes beyond the first), then one scalar group for each extra. Equations: those of
/// all intervals, boundary conditions, integral conditions, the phase condition. The Jacobian is never
/// formed: chains of intervals are condensed to their ends at a cost linear in the number of intervals.
pub struct BoundarySystem<P, M: Method> {
    equations: Equations<P, M>,
    names: Names,
    linearisation: Linearisation,
    factors: [Factorisation; 2],
    /// For the pencil, where neither of the others has it.
    condensed: Factorisation,
    /// For complex multipliers.
    rotating: Rotating,
    pencil: [Vec<f64>; 2],
    plain: Work<f64, M>,
    first: Work<Dual64, M>,
    second: Work<HyperDual64, M>,
    third: Work<HyperHyperDual64, M>,
    chunk: Passes<Chunk, M>,
    nested: Passes<Dual<Chunk>, M>,
    nested_twice: Passes<Dual2<Chunk>, M>,
    /// Components of `q` by which a gradient is taken.
    numbers: Vec<usize>,
    /// How many points of a branch were followed.
    followed: usize,
}

impl<P: BoundaryProblem, M: Method> BoundarySystem<P, M> {
    /// The system of a problem on one mesh for each segment.
    ///
    /// # Errors
    /// [`BoundaryError`] if numbers of segments, states, conditions and unknowns do not fit together.
    pub fn new(problem: P, method: M, meshes: Vec<Mesh>) -> Result<Self, BoundaryError> {
        let equations = Equations::new(problem, method, meshes)?;
        let Equations { problem, method, layout, .. } = &equations;
        let active = (layout.parameters..layout.numbers()).collect();
        let names = names_of(problem, method, layout);
        Ok(BoundarySystem {
            names,
            linearisation: Linearisation { active, ..Default::default() },
            factors: [Factorisation::new(layout), Factorisation::new(layout)],
            condensed: Factorisation::new(layout),
            rotating: Rotating::new(layout),
            pencil: Default::default(),
            plain: Work::new(layout),
            first: Work::new(layout),
            second: Work::new(layout),
            third: Work::new(layout),
            chunk: Passes::new(layout),
            nested: Passes::new(layout),
            nested_twice: Passes::new(layout),
            numbers: Vec::new(),
            followed: 0,
            equations,
        })
    }

    /// The problem itself.
    pub fn problem(&self) -> &P {
        &self.equations.problem
    }

    /// The mesh of each segment.
    pub fn meshes(&self) -> &[Mesh] {
        &self.equations.meshes
    }

    /// The unknowns `z` of trajectories that are given: `states` writes the states of a segment at a time in
    /// units of the segment's duration.
    pub fn sampled(
        &self,
        extras: &[f64],
        mut states: impl FnMut(usize, f64, &mut [f64]),
    ) -> Vec<f64> {
        let layout = &self.equations.layout;
        let mut z = vec![0.0; layout.dimension];
        let places = self.equations.method.places();
        for (s, j) in layout.intervals() {
            let (span, n) = (self.equations.span(s, j), layout.segments[s].states);
            let mut x = vec![0.0; n];
            for (place, node) in
                places.iter().zip(layout.order[layout.interval(s, j)].chunks_exact(n))
            {
                states(s, span.start + (span.end - span.start) * place, &mut x);
                node.iter().zip(&x).for_each(|(&z_k, x)| z[z_k] = *x);
            }
        }
        z[layout.values()..].iter_mut().zip(extras).for_each(|(z, extra)| *z = *extra);
        z
    }

    /// The states of a segment at a time in units of the segment's duration, as long as there are states.
    ///
    /// # Errors
    /// [`LeftDomain`] where the trajectory leaves the domain of the field.
    pub fn states(
        &mut self,
        x: &[f64],
        segment: usize,
        tau: f64,
        out: &mut [f64],
    ) -> Result<(), LeftDomain> {
        self.plain.load(&self.equations.layout, |i| x[i]);
        let (interval, place) = self.equations.meshes[segment].locate(tau);
        self.equations.value(&mut self.plain, (segment, interval), place, out)
    }

    /// Makes a solution the reference of the phase condition. Without one, it is the first point at which the
    /// equations are evaluated.
    ///
    /// # Errors
    /// [`LeftDomain`] where the field has no meaning at the nodes.
    pub fn set_reference(&mut self, x: &[f64]) -> Result<(), LeftDomain> {
        self.linearisation.at.clear();
        self.equations.set_reference(x, &mut self.plain)
    }

    /// The equations of the first segment, assembled last, condensed to its ends: `P δx(0) + Q δx(1) = 0` with `n × n`
    /// matrices `P` and `Q`, one row after the other. The multipliers of a periodic solution are those of
    /// this pencil.
    ///
    /// # Errors
    /// [`Singular`] if the equations of some interval do not determine what is inside it.
    pub fn reduced_pencil(&mut self) -> Result<(&[f64], &[f64]), Singular> {
        let (layout, assembled) = (&self.equations.layout, &self.linearisation);
        if assembled.at.is_empty() {
            return Err(Singular { pivot: 0.0, largest: 0.0 });
        }
        let pencil = &mut self.pencil;
        if !self.factors.iter().any(|factors| factors.pencil(layout, assembled, pencil)) {
            self.condensed.condense(layout, assembled, Form::Jacobian, Border::NONE)?;
            self.condensed.pencil(layout, assembled, pencil);
        }
        let [p, q] = &self.pencil;
        Ok((p, q))
    }

    fn refer(&mut self, x: &[f64]) -> Result<(), LeftDomain> {
        if self.equations.layout.phase && self.equations.phase.reference.is_empty() {
            self.set_reference(x)?;
        }
        Ok(())
    }

    /// Prepares a gradient by the unknowns and the released parameters.
    fn release(&mut self, released: &[usize], out: &mut [f64]) {
        let layout = &self.equations.layout;
        self.numbers.clear();
        self.numbers.extend(layout.parameters..layout.numbers());
        self.numbers.extend_from_slice(released);
        out[..layout.dimension].fill(0.0);
        released.iter().for_each(|p| out[layout.dimension + p] = 0.0);
    }

    /// The parameter along whose unit direction `d` is.
    fn parameter_of(&self, d: &[f64]) -> Option<usize> {
        let (z, p) = d.split_at(self.equations.layout.dimension);
        let k = p.iter().position(|p| *p != 0.0)?;
        let alone = p[k] == 1.0 && p[k + 1..].iter().chain(z).all(|d| *d == 0.0);
        alone.then_some(k)
    }
}

/// Writes derivatives, or that there are none.
fn write(outcome: Result<(), LeftDomain>, values: impl Iterator<Item = f64>, out: &mut [f64]) {
    out.iter_mut().zip(values).for_each(|(out, value)| *out = value);
    not_a_number(outcome, out);
}

/// Derivatives outside the domain are no numbers: whoever uses them refuses the point.
fn not_a_number(outcome: Result<(), LeftDomain>, out: &mut [f64]) {
    if outcome.is_err() {
        out.fill(f64::NAN);
    }
}

/// Names of unknowns, parameters and monitors. States of several segments that share a name are told
/// apart by the segment's number.
fn names_of<P: BoundaryProblem, M: Method>(problem: &P, method: &M, layout: &Layout) -> Names {
    let segments = problem.segments();
    let mut unknowns = Vec::new();
    for (s, states) in segments.iter().enumerate() {
        for state in states {
            let shared = segments.iter().flatten().filter(|other| *other == state).count() > 1;
            let name = if shared { format!("{state}[{s}]") } else { state.clone() };
            unknowns.push(Group { name, length: layout.segments[s].nodes });
        }
    }
    unknowns.extend(problem.extras().into_iter().map(|name| Group { name, length: 1 }));
    let monitors = problem.monitors().into_iter().map(|(name, _)| name);
    let mesh_error = method.error_constant().map(|_| monitors::MESH_ERROR.to_string());
    Names::new(unknowns, problem.parameters()).with_monitors(monitors.chain(mesh_error))
}

impl<P, M> System for BoundarySystem<P, M>
where
    P: BoundaryProblem + Clone + 'static,
    M: Method + Clone + 'static,
{
    fn names(&self) -> &Names {
        &self.names
    }

    fn residual(&mut self, x: &[f64], r: &mut [f64]) -> Result<(), LeftDomain> {
        self.refer(x)?;
        if self.linearisation.at == x {
            r.copy_from_slice(&self.linearisation.residual);
            return Ok(());
        }
        self.plain.load(&self.equations.layout, |i| x[i]);
        self.equations.residual(&mut self.plain)?;
        r.copy_from_slice(&self.plain.r);
        self.equations.check(r, &self.plain.q)
    }

    fn assemble(&mut self, x: &[f64]) -> Result<(), LeftDomain> {
        if self.linearisation.at == x {
            return Ok(());
        }
        self.refer(x)?;
        self.linearisation.at.clear();
        self.plain.load(&self.equations.layout, |i| x[i]);
        self.linearisation.assemble(&mut self.equations, x, &self.plain, &mut self.chunk)?;
        self.linearisation.at.extend_from_slice(x);
        Ok(())
    }

    fn factor(&mut self, slot: Slot, border: Border) -> Result<(), Singular> {
        let (layout, assembled) = (&self.equations.layout, &self.linearisation);
        let (boundary, form) = (&assembled.boundary, Form::Jacobian);
        self.factors[slot as usize].factor(layout, assembled, boundary, form, border)
    }

    fn factor_antiperiodic(&mut self, slot: Slot, border: Border) -> Result<(), Singular> {
        self.factor_flipped(slot, border)
    }

    fn oscillation(&mut self) -> Option<&mut dyn Oscillation> {
        match self.equations.problem.periodic() {
            true => Some(self),
            false => None,
        }
    }

    fn solve(&mut self, slot: Slot, right: &mut [f64]) {
        self.factors[slot as usize].solve(&self.equations.layout, right);
    }

    fn solve_transposed(&mut self, slot: Slot, right: &mut [f64]) {
        self.factors[slot as usize].solve_transposed(&self.equations.layout, right);
    }

    fn jacobian(&mut self, out: &mut [f64]) {
        self.linearisation.dense(&self.equations.layout, out);
    }

    fn determinant_sign(&self, slot: Slot) -> f64 {
        self.factors[slot as usize].determinant_sign()
    }

    /// In the unit direction of a parameter, the derivative comes from assembling at `x`, which provides it
    /// from then on.
    fn derivative(&mut self, x: &[f64], d: &[f64], out: &mut [f64]) {
        if let Some(parameter) = self.parameter_of(d) {
            if !self.linearisation.active.contains(&parameter) {
                self.linearisation.active.push(parameter);
                self.linearisation.at.clear();
            }
            if self.assemble(x).is_ok() {
                return self.linearisation.column(&self.equations.layout, parameter, out);
            }
        }
        self.first.load(&self.equations.layout, |i| Dual64::new(x[i], d[i]));
        let outcome = self.equations.residual(&mut self.first);
        write(outcome, self.first.r.iter().map(|r| r.eps), out);
    }

    fn second_derivative(&mut self, x: &[f64], d: &[f64], e: &[f64], out: &mut [f64]) {
        let argument = |i: usize| HyperDual64::new(x[i], d[i], e[i], 0.0);
        self.second.load(&self.equations.layout, argument);
        let outcome = self.equations.residual(&mut self.second);
        write(outcome, self.second.r.iter().map(|r| r.eps1eps2), out);
    }

    fn third_derivative(&mut self, x: &[f64], d: &[f64], e: &[f64], f: &[f64], out: &mut [f64]) {
        let argument = |i: usize| HyperHyperDual64::new(x[i], d[i], e[i], f[i], 0.0, 0.0, 0.0, 0.0);
        self.third.load(&self.equations.layout, argument);
        let outcome = self.equations.residual(&mut self.third);
        write(outcome, self.third.r.iter().map(|r| r.eps1eps2eps3), out);
    }

    fn gradient(&mut self, x: &[f64], w: &[f64], v: &[f64], released: &[usize], out: &mut [f64]) {
        self.release(released, out);
        let make = |i: usize, seeded: Chunk| Dual::new(seeded, Chunk::from(v[i]));
        let weighted = Weighted { x, w, numbers: &self.numbers, make: &make, take: |r| r.eps };
        let outcome = self.equations.add_gradient(&weighted, &mut self.nested, out);
        not_a_number(outcome, out);
    }

    fn second_gradient(
        &mut self,
        x: &[f64],
        w: &[f64],
        v: &[f64],
        released: &[usize],
        out: &mut [f64],
    ) {
        self.release(released, out);
        let make =
            |i: usize, seeded: Chunk| Dual2::new(seeded, Chunk::from(v[i]), Chunk::from(0.0));
        let weighted = Weighted { x, w, numbers: &self.numbers, make: &make, take: |r| r.v2 };
        let outcome = self.equations.add_gradient(&weighted, &mut self.nested_twice, out);
        not_a_number(outcome, out);
    }

    fn dynamics(&self) -> Dynamics {
        if self.equations.problem.periodic() { Dynamics::Periodic } else { Dynamics::Static }
    }

    fn spectrum(&mut self, _x: &[f64]) -> Option<Spectrum> {
        self.equations.problem.periodic().then(|| self.deciding_multipliers()).flatten()
    }

    fn monitors(&mut self, x: &[f64], values: &mut [f64]) -> Result<(), LeftDomain> {
        self.plain.load(&self.equations.layout, |i| x[i]);
        self.equations.evaluate_monitors(&mut self.plain, values)
    }

    fn monitor_gradient(&mut self, monitor: usize, x: &[f64], out: &mut [f64]) {
        out.fill(0.0);
        self.plain.load(&self.equations.layout, |i| x[i]);
        let Self { equations, plain, chunk, .. } = self;
        let outcome = equations.add_monitor_gradient(monitor, x, plain, chunk, out);
        not_a_number(outcome, out);
    }

    fn profiles(&mut self, x: &[f64]) -> Vec<Profile> {
        self.plain.load(&self.equations.layout, |i| x[i]);
        self.equations.profiles(&self.names.unknowns, &mut self.plain).unwrap_or_default()
    }

    fn exact(&self) -> bool {
        false
    }

    fn mesh(&self) -> Vec<f64> {
        self.meshes().iter().flat_map(|mesh| mesh.points().iter().copied()).collect()
    }

    fn adopt(&mut self, solution: &Solution) -> Result<Adopted, EvaluationError> {
        self.take_over(solution)
    }

    fn follow(&mut self, x: &mut [f64], directions: &mut [&mut [f64]]) {
        self.follow_to(x, directions);
    }

    fn refined(&self, x: &[f64]) -> Option<Refinement> {
        let (method, parts) = self.equations.method.finer()?;
        let meshes: Vec<Mesh> = self.meshes().iter().map(|mesh| mesh.divided(parts)).collect();
        if meshes.iter().any(|mesh| mesh.intervals() > MOST_INTERVALS) {
            return None;
        }
        let system = BoundarySystem::new(self.problem().clone(), method, meshes).ok()?;
        let Equations { method, meshes, layout, .. } = &system.equations;
        let x =
            self.equations.carried(&Onto { meshes, layout, places: method.places() }, x).ok()?;
        Some(Refinement { system: Box::new(system), x })
    }
}
