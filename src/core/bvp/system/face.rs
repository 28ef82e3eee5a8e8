//! What the stepper sees of a discretised boundary-value problem.

use super::equations::{Discretised, Work, gather_ends};
use super::local::{Arguments, Gradient, Weighted};
use super::{BoundarySystem, MOST_INTERVALS, MOST_REFINEMENTS};
use crate::core::bvp::{Ends, Mesh, Number};
use crate::core::cancel::CancelToken;
use crate::core::failure::{Failure, finite_gradient, not_finite, unknown_order};
use crate::core::linear::Factors;
use crate::core::solution::{Adopted, Cycles, Solution};
use crate::core::vector::refill;
use crate::core::zero::{
    self, Border, Dynamics, Form, Names, OrbitEvents, Profile, Refinement, Spectrum, System,
};
use num_dual::{Dual64, HyperDual64, HyperHyperDual64};

/// Gradients of conditions may err by this much, relatively: they decide how fast Newton's
/// iteration converges, not where to.
const GRADIENT: f64 = 1e-8;

impl BoundarySystem {
    /// The assembled `F_z` as a dense matrix, one column after the other (`n × n`).
    pub fn jacobian(&self, out: &mut [f64]) {
        self.linearisation.dense(&self.equations.layout, out);
    }

    /// The first point at which the equations are evaluated is the reference of the problem, and of
    /// the phase condition, where none is given.
    fn refer(&mut self, x: &[f64]) -> Result<(), Failure> {
        if !self.referred {
            let layout = &self.equations.layout;
            self.plain.load(layout, |i| x[i]);
            gather_ends(layout, &self.plain.nodes, &mut self.plain.ends);
            let (start, end) = self.plain.ends.split_at(layout.states);
            self.referred = self.problem().refer(Ends { start, end }, &self.plain.q);
        }
        if self.equations.layout.phase && self.equations.phase.reference.is_empty() {
            self.set_reference(x)?;
        }
        Ok(())
    }

    /// Whether the equations are assembled at `x`, as accurately as is asked for.
    fn is_assembled(&self, x: &[f64]) -> bool {
        self.linearisation.at == x && (self.equations.rough || !self.linearisation.rough)
    }

    /// Whether solutions are periodic.
    pub(super) fn is_periodic(&self) -> bool {
        !self.equations.layout.returns.is_empty()
    }

    /// What was evaluated belongs to other equations.
    pub(super) fn forget(&mut self) {
        self.linearisation.at.clear();
        self.evaluated.clear();
        self.equations.estimated.at.clear();
    }

    /// Prepares a gradient by the unknowns and the released parameters.
    fn release(&mut self, released: &[usize], out: &mut [f64]) {
        let layout = &self.equations.layout;
        let of_segments = layout.parameters..layout.parameters + layout.own();
        let own = [of_segments, layout.parameters..layout.numbers()];
        for (numbers, own) in [&mut self.numbers.local, &mut self.numbers.all].into_iter().zip(own)
        {
            refill(numbers, own);
            numbers.extend_from_slice(released);
        }
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

impl System for BoundarySystem {
    fn names(&self) -> &Names {
        &self.names
    }

    fn residual(&mut self, x: &[f64], r: &mut [f64]) -> Result<(), Failure> {
        self.refer(x)?;
        if self.is_assembled(x) {
            r.copy_from_slice(&self.linearisation.residual);
            return Ok(());
        }
        if self.evaluated != x {
            self.evaluated.clear();
            self.plain.load(&self.equations.layout, |i| x[i]);
            self.equations.residual_watching(&mut self.plain)?;
            self.equations.check(&self.plain.r, &self.plain.q)?;
            if !self.equations.rough {
                self.evaluated.extend_from_slice(x);
            }
        }
        r.copy_from_slice(&self.plain.r);
        Ok(())
    }

    fn assemble(&mut self, x: &[f64]) -> Result<(), Failure> {
        if self.is_assembled(x) {
            return Ok(());
        }
        self.refer(x)?;
        self.linearisation.at.clear();
        self.linearisation.rough = self.equations.rough;
        self.plain.load(&self.equations.layout, |i| x[i]);
        self.linearisation.assemble(&mut self.equations, x, &self.plain, &mut self.chunk)?;
        self.linearisation.at.extend_from_slice(x);
        Ok(())
    }

    fn factor(&mut self, form: Form, border: Border, into: &mut Factors) -> Result<(), Failure> {
        self.factor_form(form, border, into)
    }

    /// In the unit direction of a parameter, the derivative comes from assembling at `x`, which
    /// provides it from then on.
    fn derivative(
        &mut self,
        x: &[f64],
        directions: &[&[f64]],
        out: &mut [f64],
    ) -> Result<(), Failure> {
        self.refer(x)?;
        match *directions {
            [d] => {
                if let Some(parameter) = self.parameter_of(d) {
                    if !self.linearisation.active.contains(&parameter) {
                        self.linearisation.active.push(parameter);
                        self.linearisation.at.clear();
                    }
                    self.assemble(x)?;
                    self.linearisation.column(&self.equations.layout, parameter, out);
                    return Ok(());
                }
                let argument = |i: usize| Dual64::new(x[i], d[i]);
                self.equations.derivative(&mut self.first, argument, |r| r.eps, out)
            }
            [d, e] => {
                let argument = |i: usize| HyperDual64::new(x[i], d[i], e[i], 0.0);
                self.equations.derivative(&mut self.second, argument, |r| r.eps1eps2, out)
            }
            [d, e, f] => {
                let argument =
                    |i: usize| HyperHyperDual64::new(x[i], d[i], e[i], f[i], 0.0, 0.0, 0.0, 0.0);
                self.equations.derivative(&mut self.third, argument, |r| r.eps1eps2eps3, out)
            }
            _ => Err(unknown_order(directions.len())),
        }
    }

    fn gradient(
        &mut self,
        x: &[f64],
        (w, v, order): (&[f64], &[f64], usize),
        released: &[usize],
        out: &mut [f64],
    ) -> Result<(), Failure> {
        self.refer(x)?;
        self.release(released, out);
        let Self { equations, numbers, nested, nested_twice, .. } = self;
        let weighted = Weighted { at: Arguments { x, v }, w, numbers };
        equations.gradient(out, |equations, out| match order {
            1 => equations.add_gradient(&weighted, nested, out),
            2 => equations.add_gradient(&weighted, nested_twice, out),
            _ => Err(unknown_order(order)),
        })?;
        finite_gradient(out, self.equations.layout.dimension, released)
    }

    fn dynamics(&self) -> Dynamics {
        if self.is_periodic() { Dynamics::Periodic } else { Dynamics::Static }
    }

    fn spectrum(&mut self, _x: &[f64]) -> Result<Option<Spectrum>, Failure> {
        if !self.is_periodic() {
            return Ok(None);
        }
        match self.deciding_multipliers() {
            // As beside a homoclinic orbit.
            Err(Failure::Undetermined(_)) => Ok(None),
            found => found.map(Some),
        }
    }

    fn cycles(&mut self) -> Option<&mut dyn Cycles> {
        if self.is_periodic() { Some(self) } else { None }
    }

    fn unknown_scales(&self, p: &[f64]) -> Vec<f64> {
        let extras = vec![0.0; self.equations.layout.extras];
        self.equations.unknown_scales(&[p, &extras].concat())
    }

    fn orientation(&self) -> f64 {
        self.orientation
    }

    fn monitors(&mut self, x: &[f64], values: &mut [f64]) -> Result<(), Failure> {
        self.plain.load(&self.equations.layout, |i| x[i]);
        for (monitor, value) in values.iter_mut().enumerate() {
            *value = self.equations.evaluate_monitor(monitor, &mut self.plain)?;
        }
        Ok(())
    }

    fn monitor(&mut self, monitor: usize, x: &[f64], _values: &mut [f64]) -> Result<f64, Failure> {
        self.plain.load(&self.equations.layout, |i| x[i]);
        self.equations.evaluate_monitor(monitor, &mut self.plain)
    }

    fn monitor_gradient(
        &mut self,
        monitor: usize,
        x: &[f64],
        released: &[usize],
        out: &mut [f64],
    ) -> Result<(), Failure> {
        self.release(released, out);
        self.plain.load(&self.equations.layout, |i| x[i]);
        let Self { equations, plain, chunk, numbers, .. } = self;
        // Where extremes are is known as well as can be.
        equations.watch_for(monitor, plain)?;
        equations.gradient(out, |equations, out| {
            let gradient = &mut Gradient { x, numbers, passes: chunk, out };
            equations.add_monitor_gradient(monitor, plain, gradient)
        })?;
        finite_gradient(out, self.equations.layout.dimension, released)
    }

    fn profiles(&mut self, x: &[f64]) -> Vec<Profile> {
        self.plain.load(&self.equations.layout, |i| x[i]);
        self.equations.profiles(&mut self.plain).unwrap_or_default()
    }

    fn discretised(&mut self) -> Option<&mut dyn zero::Discretised> {
        Some(self)
    }

    fn events(&mut self) -> Option<&mut dyn OrbitEvents> {
        match self.problem().itineraries() {
            Some(_) => Some(self),
            None => None,
        }
    }
}

impl zero::Discretised for BoundarySystem {
    fn refined(&mut self, x: &[f64]) -> Option<Refinement> {
        let other = || self.equations.method.other().filter(|_| self.refinements == 0);
        let (method, parts) = self.equations.method.finer().or_else(other)?;
        let meshes: Vec<Mesh> = self.meshes().iter().map(|mesh| mesh.divided(parts)).collect();
        let too_fine = meshes.iter().any(|mesh| mesh.intervals() > MOST_INTERVALS);
        if too_fine || self.refinements >= MOST_REFINEMENTS {
            return None;
        }
        let mut system = BoundarySystem::new(self.problem().clone(), method, meshes).ok()?;
        system.refinements = self.refinements + 1;
        system.linearisation.active.clone_from(&self.linearisation.active);
        let x = self.equations.carried(&system.equations, x).ok()?;
        Some(Refinement { system: Box::new(system), x })
    }

    fn set_inexactness(&mut self, error: f64) {
        self.equations.rough = self.equations.method.allow(error);
    }

    fn set_cancel(&mut self, cancel: &CancelToken) {
        self.equations.method.cancel().clone_from(cancel);
        self.linearisation.cancel.clone_from(cancel);
    }

    fn growth(&self) -> f64 {
        self.growth_of_deviations()
    }

    fn duplicate(&self) -> Option<Box<dyn System>> {
        let mut own = self.on(self.meshes().to_vec()).ok()?;
        own.equations.phase.clone_from(&self.equations.phase);
        own.refinements = self.refinements;
        Some(Box::new(own))
    }

    fn method(&self) -> String {
        self.equations.method.to_string()
    }

    fn mesh(&self) -> Vec<f64> {
        self.meshes().iter().flat_map(|mesh| mesh.points().iter().copied()).collect()
    }

    fn mesh_error(&mut self, x: &[f64]) -> f64 {
        BoundarySystem::mesh_error(self, x)
    }

    fn images(&mut self, solution: &Solution, near: &[f64]) -> Result<Vec<Vec<f64>>, Failure> {
        self.images_of(solution, near)
    }

    fn resume_from(&mut self, solution: &Solution) -> Result<Option<Adopted>, Failure> {
        self.take_over(solution).map(Some)
    }

    fn on_accepted(&mut self, x: &mut [f64], directions: &mut [&mut [f64]]) {
        self.follow_to(x, directions);
    }
}

impl Discretised {
    /// A derivative of the residual, a part of it at arguments that carry directions.
    fn derivative<T: Number>(
        &self,
        work: &mut Work<T>,
        argument: impl Fn(usize) -> T,
        part: fn(&T) -> f64,
        out: &mut [f64],
    ) -> Result<(), Failure> {
        work.load(&self.layout, argument);
        self.residual(work)?;
        out.iter_mut().zip(&work.r).for_each(|(out, r)| *out = part(r));
        let Some(row) = not_finite(out) else { return Ok(()) };
        let q: Vec<f64> = work.q.iter().map(|q| q.real()).collect();
        Err(self.refusal(row, out[row], &q))
    }

    /// Computes a gradient, which may err by a little.
    fn gradient(
        &mut self,
        out: &mut [f64],
        add: impl FnOnce(&mut Self, &mut [f64]) -> Result<(), Failure>,
    ) -> Result<(), Failure> {
        self.method.allow(GRADIENT);
        let outcome = add(self, out);
        self.method.allow(0.0);
        outcome
    }
}
