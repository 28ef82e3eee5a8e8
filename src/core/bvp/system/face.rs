//! The [`System`] implementation of a discretised boundary-value problem.

use super::BoundarySystem;
use super::discretisation::{DiscretisedProblem, GRADIENT};
use super::factors::factor;
use super::least_size::least_size;
use super::local::{Arguments, Gradient, Weighted};
use super::meshed::Meshed;
use super::solutions::Solutions;
use crate::core::bvp::itineraries::Itineraries;
use crate::core::bvp::method::Method;
use crate::core::failure::{Failure, finite_gradient};
use crate::core::linalg::{Border, Factors, Form, Spectrum, SpectrumRequest};
use crate::core::problem::{Dynamics, Names, Profile};
use crate::core::scalar::Space;
use crate::core::system::{
    Deviation, Discretised, Expansion, Functional, OrbitEvents, Representation, Solution, Start,
    System, Traits,
};

impl System for BoundarySystem {
    fn names(&self) -> &Names {
        &self.0.names
    }

    fn residual(&mut self, x: &[f64], r: &mut [f64]) -> Result<(), Failure> {
        self.0.solutions.refer(x)?;
        if self.0.is_assembled(x) {
            r.copy_from_slice(&self.0.assembly.residual);
            return Ok(());
        }
        self.0.solutions.residual(x, r)
    }

    fn assemble(&mut self, x: &[f64]) -> Result<(), Failure> {
        self.0.assemble(x)
    }

    fn factor(&mut self, form: Form, border: Border, into: &mut Factors) -> Result<(), Failure> {
        let Meshed { solutions, assembly, floquet, .. } = &mut self.0;
        factor((&solutions.equations, assembly), floquet, form, border, into)
    }

    /// If the direction is the unit vector of a parameter, the derivative is taken from the
    /// assembly at `x`, in which this parameter is active from now on.
    fn derivative(
        &mut self,
        x: &[f64],
        directions: &[&[f64]],
        out: &mut [f64],
    ) -> Result<(), Failure> {
        self.0.solutions.refer(x)?;
        if let [d] = *directions
            && let Some(parameter) = parameter_of(d, self.layout.dimension)
        {
            self.0.assembly.activate(parameter);
            self.0.assemble(x)?;
            let Meshed { solutions, assembly, .. } = &self.0;
            assembly.column(&solutions.equations.layout, parameter, out);
            return Ok(());
        }
        let Meshed { solutions, derivatives, .. } = &mut self.0;
        derivatives.along((&solutions.equations, &solutions.phase), x, directions, out)
    }

    fn gradient(
        &mut self,
        x: &[f64],
        of: Functional,
        released: &[usize],
        out: &mut [f64],
    ) -> Result<(), Failure> {
        let (w, v, twice) = match of {
            Functional::First(w, v) => (w, v, false),
            Functional::Second(w, v) => (w, v, true),
            Functional::Monitor(monitor) => {
                let Meshed { solutions, chunk, numbers, .. } = &mut self.0;
                let Solutions { equations, monitors, plain, .. } = solutions;
                numbers.release(&equations.layout, released, out);
                plain.load(&equations.layout, |i| x[i]);
                // The positions of extremes are as accurate as possible.
                monitors.watch_for(equations, monitor, plain)?;
                equations.allowing(GRADIENT, |equations| {
                    let gradient = &mut Gradient { x, numbers, passes: chunk, out };
                    monitors.add_gradient(equations, monitor, plain, gradient)
                })?;
                return finite_gradient(out, self.layout.dimension, released);
            }
        };
        self.0.solutions.refer(x)?;
        let Meshed { solutions, derivatives, numbers, .. } = &mut self.0;
        numbers.release(&solutions.equations.layout, released, out);
        let weighted = Weighted { at: Arguments { x, v }, w, numbers };
        solutions.equations.allowing(GRADIENT, |equations| {
            derivatives.add_gradient(equations, &weighted, twice, out)
        })?;
        finite_gradient(out, self.layout.dimension, released)
    }

    fn dynamics(&self) -> Dynamics {
        if self.layout.is_periodic() { Dynamics::Periodic } else { Dynamics::None }
    }

    fn spectrum(
        &mut self,
        _: &[f64],
        request: SpectrumRequest,
    ) -> Result<Option<Spectrum>, Failure> {
        if !self.layout.is_periodic() {
            return Ok(None);
        }
        let (floquet, mut orbit) = self.0.multipliers();
        floquet.deciding(&mut orbit, request.count).map(Some)
    }

    fn expand(
        &mut self,
        x: &[f64],
        space: &'static Space,
        terms: &[Vec<f64>],
    ) -> Result<Vec<Vec<f64>>, Failure> {
        self.0.solutions.refer(x)?;
        let Meshed { solutions, derivatives, .. } = &mut self.0;
        let expansion = Expansion::new(x, space, terms)?;
        derivatives.expand((&solutions.equations, &solutions.phase), &expansion)
    }

    fn deviation(&mut self, x: &[f64], d: &[f64]) -> Result<Deviation, Failure> {
        let Meshed { solutions, derivatives, .. } = &mut self.0;
        derivatives.deviation(&solutions.equations, x, d)
    }

    fn unknown_scales(&self, p: &[f64]) -> Vec<f64> {
        let (extras, mut scales) = (vec![0.0; self.layout.extras], Vec::new());
        DiscretisedProblem::unknown_scales(self, &[p, &extras].concat(), &mut scales);
        self.names().sizes_of_groups(&scales)
    }

    fn monitors(&mut self, x: &[f64], first: usize, values: &mut [f64]) -> Result<(), Failure> {
        let solutions = &mut self.0.solutions;
        solutions.load(x);
        for (monitor, value) in (first..).zip(values) {
            *value = solutions.monitor(monitor)?;
        }
        Ok(())
    }

    fn profiles(&mut self, x: &[f64]) -> Vec<Profile> {
        self.0.solutions.profiles(x)
    }

    fn representation(&self) -> Representation {
        let DiscretisedProblem { problem, method, meshes, .. } = &**self;
        Representation {
            itinerary: problem.itineraries().map_or_else(String::new, Itineraries::words),
            method: method.written(self.0.assembly.structure.sparse().is_some()),
            mesh: meshes.iter().flat_map(|mesh| mesh.points().iter().copied()).collect(),
            interpolated: matches!(method, Method::Collocation(_)),
        }
    }

    fn traits(&mut self, x: &[f64]) -> Traits {
        let Meshed { solutions, assembly, .. } = &mut self.0;
        let layout = &solutions.equations.layout;
        let multipliers = layout.closes().then(|| layout.states - usize::from(layout.phase));
        Traits {
            mesh_error: solutions.mesh_error(x),
            growth: assembly.growth(&solutions.equations),
            amplitude: solutions.amplitude(x),
            free_period: solutions.free_period(x),
            smooth_multipliers: multipliers,
            least_size: least_size(solutions, x),
        }
    }

    fn resume_from(&mut self, solution: &Solution) -> Result<Start, Failure> {
        self.0.resume_from(solution)
    }

    fn discretised(&mut self) -> Option<&mut dyn Discretised> {
        Some(&mut self.0)
    }

    fn events(&mut self) -> Option<&mut dyn OrbitEvents> {
        match self.problem.itineraries() {
            Some(_) => Some(&mut self.0.solutions),
            None => None,
        }
    }
}

/// Returns the parameter whose unit vector is `d`; `None` if `d` is another direction.
fn parameter_of(d: &[f64], dimension: usize) -> Option<usize> {
    let (z, p) = d.split_at(dimension);
    let k = p.iter().position(|p| *p != 0.0)?;
    let alone = p[k] == 1.0 && p[k + 1..].iter().chain(z).all(|d| *d == 0.0);
    alone.then_some(k)
}
