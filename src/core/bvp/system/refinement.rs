//! Refinement and redistribution of meshes along a branch.

use super::BoundarySystem;
use super::discretisation::DiscretisedProblem;
use super::duration_bound::DurationBound;
use super::fitting::fitting_meshes;
use super::halved::{Halves, difference};
use super::homoclinic::homoclinic;
use super::local::{Arguments, Slope};
use super::meshed::{MOST_INTERVALS, Meshed};
use super::phase_response::response_of;
use super::solutions::Solutions;
use super::start::meshes_of;
use super::takens;
use crate::core::bvp::mesh::Mesh;
use crate::core::failure::Failure;
use crate::core::problem::Profile;
use crate::core::system::{Approach, Discretised, Effort, Emanating, Refinement, Solution, System};

/// Heuristic: the largest number of refinements. Each refinement of a method of high order gives
/// many digits; digits that still change after five refinements are rounding errors.
const MOST_REFINEMENTS: usize = 5;

/// Heuristic: the number of accepted points after which a mesh is redistributed.
const ADAPT_EVERY: usize = 3;

/// Heuristic: the estimated error above which a mesh is redistributed immediately.
const ADAPT_ABOVE: f64 = 1e-3;

/// Heuristic: the relative error allowed in derivatives of monitors along a branch, which determine the
/// curve between two points.
const SLOPE: f64 = 1e-6;

impl Discretised for Meshed {
    fn refined(&mut self, x: &[f64]) -> Option<Refinement> {
        let equations = &self.solutions.equations;
        let other = || equations.method.other().filter(|_| self.refinements == 0);
        let (method, parts) = equations.method.finer().or_else(other)?;
        let meshes: Vec<Mesh> = equations.meshes.iter().map(|mesh| mesh.divided(parts)).collect();
        let too_fine = meshes.iter().any(|mesh| mesh.intervals() > MOST_INTERVALS);
        if too_fine || self.refinements >= MOST_REFINEMENTS {
            return None;
        }
        let finer = DiscretisedProblem::new(equations.problem.clone(), method, meshes).ok()?;
        let x = equations.carried(&finer, x).ok()?;
        let mut finer = Meshed::new(finer);
        finer.refinements = self.refinements + 1;
        finer.assembly.active.clone_from(&self.assembly.active);
        Some(Refinement { system: Box::new(BoundarySystem(finer)), x })
    }

    fn slopes(
        &mut self,
        x: &[f64],
        first: usize,
        direction: &[f64],
        out: &mut [f64],
    ) -> Vec<usize> {
        let Meshed { solutions, assembly, along, .. } = self;
        let Solutions { equations, monitors, plain, .. } = solutions;
        plain.load(&equations.layout, |i| x[i]);
        // Errors of the flow grow like deviations.
        let allowed = SLOPE / assembly.growth(equations).max(1.0);
        let slope = Slope { at: Arguments { x, v: direction }, passes: along, value: 0.0 };
        monitors.slopes((equations, allowed), first, plain, slope, out)
    }

    fn set_effort(&mut self, Effort { error, exact_gradients, cancel }: Effort) {
        let equations = &mut self.solutions.equations;
        equations.exact_gradients = exact_gradients;
        equations.rough = equations.method.allow(error);
        equations.method.cancel().clone_from(cancel);
        self.assembly.cancel.clone_from(cancel);
    }

    fn duplicate(&self) -> Option<Box<dyn System>> {
        let equations = &self.solutions.equations;
        let mut own = Meshed::new(equations.on(equations.meshes.clone()).ok()?);
        own.solutions.phase.clone_from(&self.solutions.phase);
        own.refinements = self.refinements;
        Some(Box::new(BoundarySystem(own)))
    }

    fn repeats(&mut self, x: &[f64], beside: &[f64]) -> bool {
        let [here, there] = [x, beside].map(|x| Halves::of(&mut self.solutions, x));
        here.zip(there)
            .is_some_and(|(here, there)| here.are_equal(there.size) && !there.are_equal(0.0))
    }

    fn difference_of_halves(&mut self, x: &[f64]) -> Option<Vec<f64>> {
        difference(&mut self.solutions, x)
    }

    fn images(&mut self, solution: &Solution, near: &[f64]) -> Result<Vec<Vec<f64>>, Failure> {
        self.solutions.images(solution, near)
    }

    fn phase_response(&mut self, x: &[f64]) -> Result<Vec<Profile>, Failure> {
        response_of(self, x)
    }

    fn approach(&mut self, x: &[f64]) -> Option<Approach> {
        self.solutions.approach(x)
    }

    fn homoclinic(&self, solution: &Solution, radius: f64) -> Result<Emanating, Failure> {
        homoclinic(&self.solutions.equations, solution, radius)
    }

    fn beside_takens(
        &self,
        point: &Solution,
        size: (&[usize], [f64; 2]),
    ) -> Result<Solution, Failure> {
        takens::beside(&self.solutions.equations, point, size)
    }

    fn return_to(&mut self, solution: &Solution) -> Result<(), Failure> {
        // The minimum number of intervals of the branch stays the same.
        let (least, followed) = (self.least.clone(), self.followed);
        let intervals: Vec<usize> =
            meshes_of(&solution.mesh)?.iter().map(Mesh::intervals).collect();
        if intervals.len() == least.len() {
            self.least = intervals;
        }
        let returned = self.resume_from(solution).map(drop);
        if self.least.len() == least.len() {
            self.least = least;
        }
        self.followed = followed;
        returned
    }

    fn needs_fit(&mut self, x: &[f64], target: f64) -> bool {
        fitting_meshes(self, x, target).is_some()
    }

    fn fit(&mut self, x: &mut Vec<f64>, directions: &mut [&mut Vec<f64>], target: f64) -> bool {
        self.fit_mesh(x, directions, target)
    }

    fn on_accepted(&mut self, x: &mut [f64], directions: &mut [&mut [f64]]) {
        self.followed += 1;
        // If an orbit leaves the domain, the next correction reports it.
        let late = self.followed.is_multiple_of(ADAPT_EVERY);
        if late || self.solutions.mesh_error(x) > ADAPT_ABOVE {
            let _ = self.adapt(x, directions);
        }
        if self.solutions.equations.layout.phase {
            let _ = self.set_reference(x);
        }
        self.solutions.load(x);
        let Solutions { equations, monitors, plain, .. } = &mut self.solutions;
        monitors.longest = DurationBound::behind(equations, &plain.numbers);
    }
}
