//! Discretised homoclinic orbits, from nearby cycles and from saved orbits.

use super::BoundarySystem;
use super::discretisation::{DiscretisedProblem, Known};
use super::start::{discretisation_of, in_words, most_intervals};
use crate::core::bvp::homoclinic::{self, Cycle};
use crate::core::failure::Failure;
use crate::core::system::{Emanating, Kind, Matrices, Solution};

/// Creates the system of homoclinic orbits together with a first orbit, from a saved cycle of this
/// problem near the homoclinic orbit, or from a saved homoclinic orbit of the curve to be continued.
///
/// # Errors
/// [`Failure`] if no homoclinic orbit is near the saved cycle, or if the saved solution does not
/// belong to this problem.
pub(super) fn homoclinic(
    present: &DiscretisedProblem,
    solution: &Solution,
    radius: f64,
) -> Result<Emanating, Failure> {
    let other = in_words(present, &solution.itinerary)?;
    let cycles = other.as_ref().unwrap_or(present);
    let p = &solution.parameters;
    if solution.condition == Some(Kind::HOM) {
        return saved(cycles, solution);
    }
    if solution.mesh.is_empty() {
        let reason = "a branch of homoclinic orbits starts from a nearby cycle, but the given start is an \
             equilibrium";
        return Err(Failure::Mismatch(reason.into()));
    }
    let (method, meshes) = discretisation_of(cycles, solution)?;
    let of_solution = DiscretisedProblem::new(cycles.problem.clone(), method, meshes)?;
    let Known { problem, trajectories, q } = of_solution.trajectories_of(&solution.state, p);
    let ([trajectory], Some(period)) = (&trajectories[..], q.last()) else {
        return Err(Failure::Unsupported("homoclinic orbits with events are not supported".into()));
    };
    let x = [&solution.state[..], p].concat();
    let cycle = Cycle {
        q: &q,
        times: trajectory.nodes().map(|(time, _)| time).collect(),
        states: &|time| of_solution.states(&x, 0, time / period * of_solution.meshes[0].end()),
    };
    let guess = homoclinic::from_cycle(problem, &cycle, radius)?;
    let intervals = most_intervals(&of_solution).max(most_intervals(cycles));
    // Only the matrices of periodic orbits can be sparse.
    let method = cycles.method.clone().with_matrices(Matrices::Dense);
    let (system, z) = guess.distributed(p, &method, intervals)?;
    Ok(Emanating { system: Box::new(system), z, along: None })
}

/// Returns a saved homoclinic orbit on its own mesh.
fn saved(cycles: &DiscretisedProblem, solution: &Solution) -> Result<Emanating, Failure> {
    let (meshes, method) = (super::start::meshes_of(&solution.mesh)?, solution.method.parse()?);
    let (n, p) = (cycles.layout.states, &solution.parameters);
    let on_mesh = DiscretisedProblem::new(cycles.problem.clone(), method, meshes)?;
    let values = on_mesh.layout.values();
    if solution.state.len() < values || on_mesh.layout.segments.len() != 1 {
        let (found, wanted) = (solution.state.len(), values);
        return Err(Failure::Mismatch(format!(
            "the saved homoclinic orbit has {found} unknowns, but its mesh needs {wanted} \
             unknowns: was the orbit saved with another model?"
        )));
    }
    let (states, extras) = solution.state.split_at(values);
    let count = values / n;
    let node = |k: usize| (0..n).map(|i| states[i * count + k]).collect();
    let nodes: Vec<Vec<f64>> = (0..count).map(node).collect();
    let guess = homoclinic::from_saved(cycles.problem.clone(), &nodes, extras, p)?;
    let DiscretisedProblem { method, meshes, .. } = on_mesh;
    let system = BoundarySystem::new(guess.problem, method, meshes)?;
    Ok(Emanating { system: Box::new(system), z: [states, &guess.extras].concat(), along: None })
}
