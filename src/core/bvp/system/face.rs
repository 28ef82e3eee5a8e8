//! A discretised boundary-value problem as a [`System`].

use super::local::{Arguments, Gradient, Weighted};
use super::profiles::profiles;
use super::work::gather_ends;
use super::{BoundarySystem, MOST_INTERVALS, MOST_REFINEMENTS};
use crate::core::bvp::{Ends, Mesh};
use crate::core::cancel::CancelToken;
use crate::core::failure::{Failure, finite_gradient};
use crate::core::linear::Factors;
use crate::core::solution::{Cycles, Solution, Start};
use crate::core::zero::{
    self, Border, Dynamics, Form, Names, OrbitEvents, Profile, Refinement, Spectrum, System,
};

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
        if self.equations.layout.phase && self.phase.reference.is_empty() {
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
        self.monitors.mesh_error.forget();
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
            self.monitors.residual(&mut self.equations, &self.phase, &mut self.plain)?;
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
        self.linearisation.drop_idle(self.equations.layout.own());
        self.plain.load(&self.equations.layout, |i| x[i]);
        let Self { equations, phase, monitors, plain, chunk, .. } = self;
        self.linearisation.assemble((equations, phase), monitors, x, plain, chunk)?;
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
        if let [d] = *directions
            && let Some(parameter) = self.parameter_of(d)
        {
            self.linearisation.ask_for(parameter);
            self.assemble(x)?;
            self.linearisation.column(&self.equations.layout, parameter, out);
            return Ok(());
        }
        self.derivatives.along((&self.equations, &self.phase), x, directions, out)
    }

    fn gradient(
        &mut self,
        x: &[f64],
        (w, v, order): (&[f64], &[f64], usize),
        released: &[usize],
        out: &mut [f64],
    ) -> Result<(), Failure> {
        self.refer(x)?;
        let Self { equations, numbers, derivatives, .. } = self;
        numbers.release(&equations.layout, released, out);
        let weighted = Weighted { at: Arguments { x, v }, w, numbers };
        equations
            .inexactly(|equations| derivatives.add_gradient(equations, &weighted, order, out))?;
        finite_gradient(out, self.equations.layout.dimension, released)
    }

    fn dynamics(&self) -> Dynamics {
        if self.is_periodic() { Dynamics::Periodic } else { Dynamics::Static }
    }

    fn spectrum(&mut self, _x: &[f64]) -> Result<Option<Spectrum>, Failure> {
        if !self.is_periodic() {
            return Ok(None);
        }
        self.deciding_multipliers().map(Some)
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
            *value = self.monitors.evaluate(&mut self.equations, monitor, &mut self.plain)?;
        }
        Ok(())
    }

    fn monitor(&mut self, monitor: usize, x: &[f64], _values: &mut [f64]) -> Result<f64, Failure> {
        self.plain.load(&self.equations.layout, |i| x[i]);
        self.monitors.evaluate(&mut self.equations, monitor, &mut self.plain)
    }

    fn monitor_gradient(
        &mut self,
        monitor: usize,
        x: &[f64],
        released: &[usize],
        out: &mut [f64],
    ) -> Result<(), Failure> {
        let Self { equations, monitors, plain, chunk, numbers, .. } = self;
        numbers.release(&equations.layout, released, out);
        plain.load(&equations.layout, |i| x[i]);
        // Where extremes are is known as well as can be.
        monitors.watch_for(equations, monitor, plain)?;
        equations.inexactly(|equations| {
            let gradient = &mut Gradient { x, numbers, passes: chunk, out };
            monitors.add_gradient(equations, monitor, plain, gradient)
        })?;
        finite_gradient(out, self.equations.layout.dimension, released)
    }

    fn profiles(&mut self, x: &[f64]) -> Vec<Profile> {
        self.plain.load(&self.equations.layout, |i| x[i]);
        profiles(&self.equations, &mut self.plain).unwrap_or_default()
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
        own.phase.clone_from(&self.phase);
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

    fn resume_from(&mut self, solution: &Solution) -> Result<Option<Start>, Failure> {
        self.take_over(solution).map(Some)
    }

    fn on_accepted(&mut self, x: &mut [f64], directions: &mut [&mut [f64]]) {
        self.follow_to(x, directions);
    }
}
