//! Discretised problems whose meshes follow a branch.

use super::assembly::AssembledJacobian;
use super::carry::remesh;
use super::derivatives::Derivatives;
use super::discretisation::DiscretisedProblem;
use super::duration_bound::DurationBound;
use super::floquet::Floquet;
use super::layout::UnknownLayout;
use super::liouville::Orbit;
use super::local::{Numbers, Passes};
use super::monitors::MESH_ERROR;
use super::solutions::Solutions;
use super::start::{Resumed, resumed};
use crate::core::bvp::erased::Equations;
use crate::core::bvp::error::BoundaryError;
use crate::core::bvp::mesh::Mesh;
use crate::core::bvp::method::Method;
use crate::core::failure::Failure;
use crate::core::problem::{Group, Names};
use crate::core::scalar::Chunk;
use crate::core::system::{Solution, Start};
use num_dual::Dual64;

/// Heuristic: the largest number of intervals of a refined segment: on finer meshes, rounding
/// errors dominate.
pub(super) const MOST_INTERVALS: usize = 4096;

/// A discretised problem with an adaptive mesh: the evaluation of solutions and their
/// linearisation.
pub(super) struct Meshed {
    pub names: Names,
    pub solutions: Solutions,
    pub assembly: AssembledJacobian,
    pub derivatives: Derivatives,
    pub floquet: Floquet,
    /// Scratch space for derivatives of parts of the equations, and the selection of the entries of
    /// `q` for gradients.
    pub chunk: Passes<Chunk>,
    /// Scratch space for derivatives along a direction.
    pub along: Passes<Dual64>,
    pub numbers: Numbers,
    /// The number of accepted points of the branch so far.
    pub followed: usize,
    /// The number of mesh refinements that led to this system.
    pub refinements: usize,
    /// The initial numbers of intervals of the segments.
    pub least: Vec<usize>,
}

impl Meshed {
    pub fn new(mut equations: DiscretisedProblem) -> Self {
        let cancel = equations.method.cancel().clone();
        let DiscretisedProblem { problem, method, layout, .. } = &equations;
        let active = (layout.parameters..layout.parameters + layout.own()).collect();
        Meshed {
            names: names_of(&**problem, method, layout),
            assembly: AssembledJacobian { active, cancel, ..Default::default() },
            derivatives: Derivatives::new(layout),
            floquet: Floquet::new(layout),
            chunk: Passes::new(layout),
            along: Passes::new(layout),
            numbers: Numbers::default(),
            followed: 0,
            refinements: 0,
            least: equations.meshes.iter().map(Mesh::intervals).collect(),
            solutions: Solutions::new(equations),
        }
    }

    /// Whether the equations are assembled at `x` with the required accuracy.
    pub fn is_assembled(&self, x: &[f64]) -> bool {
        self.assembly.at == x && (self.solutions.equations.rough || !self.assembly.rough)
    }

    /// Assembles the linearisation at `x`.
    pub fn assemble(&mut self, x: &[f64]) -> Result<(), Failure> {
        if self.is_assembled(x) {
            return Ok(());
        }
        self.solutions.refer(x)?;
        let Meshed { solutions, assembly, chunk, .. } = self;
        assembly.at.clear();
        assembly.rough = solutions.equations.rough;
        assembly.drop_idle(solutions.equations.layout.own());
        solutions.load(x);
        let Solutions { equations, phase, monitors, plain, .. } = solutions;
        monitors.longest.check(equations, &plain.numbers)?;
        assembly.assemble((equations, phase), monitors, x, plain, chunk)?;
        assembly.at.extend_from_slice(x);
        Ok(())
    }

    /// Returns the storage for Floquet multipliers, and the solution that was assembled last, from
    /// which the multipliers are computed.
    pub fn multipliers(&mut self) -> (&mut Floquet, Orbit<'_>) {
        let Meshed { solutions, assembly: assembled, floquet, .. } = self;
        let Solutions { equations, phase, monitors, plain, .. } = solutions;
        let errors = &mut monitors.mesh_error;
        (floquet, Orbit { equations, phase, assembled, errors, plain })
    }

    /// Discards the cached assembly and evaluations, which belong to the equations before a change.
    fn forget(&mut self) {
        self.assembly.at.clear();
        self.solutions.forget();
    }

    /// Makes a solution the reference of the phase condition.
    pub fn set_reference(&mut self, x: &[f64]) -> Result<(), Failure> {
        self.forget();
        self.solutions.set_reference(x)
    }

    /// Redistributes the mesh.
    pub fn adapt(&mut self, x: &mut [f64], directions: &mut [&mut [f64]]) -> Result<(), Failure> {
        let Solutions { equations, phase, monitors, plain, .. } = &mut self.solutions;
        if equations.method.error_constant().is_none() {
            return Ok(());
        }
        plain.load(&equations.layout, |i| x[i]);
        let mesh_of = |(segment, mesh): (usize, &Mesh)| {
            let density = monitors.mesh_error.density(equations, segment, plain);
            mesh.equidistributed(&density, mesh.intervals())
        };
        let meshes: Vec<Mesh> = equations.meshes.iter().enumerate().map(mesh_of).collect();
        let given = std::iter::once(&*x).chain(directions.iter().map(|d| &**d));
        let mut vectors: Vec<Vec<f64>> = given.map(<[f64]>::to_vec).collect();
        let refers = !phase.reference.is_empty();
        vectors.extend(refers.then(|| phase.reference.clone()));
        remesh(equations, &meshes, &mut vectors);
        let before = std::mem::replace(&mut equations.meshes, meshes);
        if refers
            && let Some(reference) = vectors.pop()
            && let Err(cause) = self.set_reference(&reference)
        {
            self.solutions.equations.meshes = before;
            self.forget();
            return Err(cause);
        }
        self.forget();
        let given = std::iter::once(x).chain(directions.iter_mut().map(|d| &mut **d));
        given.zip(&vectors).for_each(|(vector, new)| vector.copy_from_slice(new));
        Ok(())
    }

    /// Creates the system on a mesh with an estimated error below a tolerance, and transfers a
    /// solution to it.
    pub fn with_error(self, x: &[f64], tolerance: f64) -> Result<(Self, Vec<f64>), BoundaryError> {
        if self.solutions.equations.method.error_constant().is_none() {
            return Ok((self, x.to_vec()));
        }
        let mut solutions = self.solutions;
        let meshes = solutions.meshes_for(x, tolerance, 2)?;
        let Solutions { equations, phase, .. } = solutions;
        let mut finer = Meshed::new(equations.on(meshes)?);
        let carried = equations.carried(&finer.solutions.equations, x)?;
        if !phase.reference.is_empty() {
            let reference = equations.carried(&finer.solutions.equations, &phase.reference)?;
            finer.set_reference(&reference)?;
        }
        Ok((finer, carried))
    }

    /// Prepares the start of a branch from a saved solution.
    pub fn resume_from(&mut self, solution: &Solution) -> Result<Start, Failure> {
        if let Some(anew) = begun_anew(self)? {
            *self = anew;
        }
        self.solutions.monitors.longest = DurationBound::default();
        let Resumed { equations, start, motion } = resumed(&self.solutions.equations, solution)?;
        if let Some(equations) = equations {
            *self = Meshed::new(equations);
        }
        let x = [&start.z[..], &solution.parameters[..]].concat();
        match motion {
            Some(motion) => {
                self.forget();
                let Solutions { equations, phase, .. } = &mut self.solutions;
                phase.refer_to_motion(equations, &x, &motion);
            }
            None => self.set_reference(&x)?,
        }
        Ok(start)
    }
}

/// Creates a system with the initial numbers of intervals, unless the mesh already has these numbers:
/// the start of a branch does not depend on earlier meshes.
fn begun_anew(meshed: &Meshed) -> Result<Option<Meshed>, Failure> {
    let equations = &meshed.solutions.equations;
    let mut all = equations.meshes.iter().zip(&meshed.least);
    if all.all(|(mesh, least)| mesh.intervals() == *least) {
        return Ok(None);
    }
    let uniform =
        |(mesh, least): (&Mesh, &usize)| mesh.equidistributed(&vec![1.0; mesh.intervals()], *least);
    let meshes = equations.meshes.iter().zip(&meshed.least).map(uniform).collect();
    Ok(Some(Meshed::new(equations.on(meshes)?)))
}

/// Returns the names of unknowns, parameters and monitors. If several segments have a state of the
/// same name, the segment's number is appended to the name.
fn names_of(problem: &dyn Equations, method: &Method, layout: &UnknownLayout) -> Names {
    let segments = problem.segments();
    let mut unknowns = Vec::new();
    for (s, states) in segments.iter().enumerate() {
        for group in Group::of_states(states) {
            let first = group.elements().next();
            let shared =
                segments.iter().filter(|other| other.iter().any(|it| Some(it) == first.as_ref()));
            let name = match shared.count() > 1 {
                true => format!("{}[{s}]", group.name),
                false => group.name.clone(),
            };
            unknowns.push(Group { name, ..group.on_mesh(layout.segments[s].nodes) });
        }
    }
    unknowns.extend(problem.extras().into_iter().map(|name| Group::new(name, 1)));
    let monitors = problem.monitors().into_iter().map(|(name, _)| name);
    let mesh_error = method.error_constant().map(|_| MESH_ERROR.to_string());
    Names::new(unknowns, problem.parameters())
        .with_monitors(monitors.chain(mesh_error))
        .with_defaults(problem.defaults())
}
