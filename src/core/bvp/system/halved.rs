//! Orbits that go through everything twice, as orbits of half the period.

use super::discretisation::DiscretisedProblem;
use super::meshed::Meshed;
use super::start::{Resumed, mismatch, values_on};
use crate::core::bvp::itineraries::Itineraries;
use crate::core::bvp::mesh::Mesh;
use crate::core::failure::Failure;
use crate::core::system::{Site, Solution, Start};

/// The start at the orbit of half the period, where a branch of doubled orbits ends; `None` if the
/// solution does not go through everything twice.
pub(super) fn halved(
    equations: &DiscretisedProblem,
    solution: &Solution,
    meshes: &[Mesh],
) -> Result<Option<Resumed>, Failure> {
    let mut whole = Meshed::new(equations.on(meshes.to_vec())?);
    let x = [&solution.state[..], &solution.parameters[..]].concat();
    if !whole.solutions.repeats(&x) {
        return Ok(None);
    }
    let whole = &whole.solutions.equations;
    let (equations, z) = match meshes {
        [mesh] => first_period(whole, mesh, &x)?,
        _ => first_legs(whole, meshes, &solution.state)?,
    };
    let start = Start { site: Site::OtherBranch, ..Start::point(z, None) };
    Ok(Some(Resumed { equations: Some(equations), start, motion: None }))
}

/// The first half of the segments, with their extras and those before them.
fn first_legs(
    whole: &DiscretisedProblem,
    meshes: &[Mesh],
    z: &[f64],
) -> Result<(DiscretisedProblem, Vec<f64>), Failure> {
    let (layout, half) = (&whole.layout, meshes.len() / 2);
    let problem = whole.problem.itineraries().and_then(Itineraries::halved).ok_or_else(twice)?;
    let first = &meshes[..half];
    // Segments of a cycle have an unknown each, segments without motion have none.
    let once = layout.extras.saturating_sub(meshes.len());
    let extras = z.len() - layout.extras;
    let count = once + (layout.extras - once) / 2;
    let values = &z[..values_on(layout, first, &whole.method)];
    let z = [values, &z[extras..extras + count]].concat();
    Ok((DiscretisedProblem::new(problem, whole.method.clone(), first.to_vec())?, z))
}

/// The first half of the only segment: on half the mesh where that spans several periods, else with
/// half the period, or half as many periods of the forcing.
fn first_period(
    whole: &DiscretisedProblem,
    mesh: &Mesh,
    x: &[f64],
) -> Result<(DiscretisedProblem, Vec<f64>), Failure> {
    let (layout, end) = (&whole.layout, mesh.end());
    let fewer = whole.problem.itineraries().and_then(Itineraries::halved);
    let several = end >= 2.0;
    if !several && !layout.phase && fewer.is_none() {
        return Err(twice());
    }
    let scale = if several { 1.0 } else { 2.0 };
    let before = mesh.points().iter().copied().filter(|tau| *tau < 0.5 * end);
    let points = before.chain([0.5 * end]).map(|tau| scale * tau).collect();
    let mesh = Mesh::new(points).map_err(|cause| Failure::Mismatch(cause.to_string()))?;
    let problem = fewer.filter(|_| !several).unwrap_or_else(|| whole.problem.clone());
    let half = DiscretisedProblem::new(problem, whole.method.clone(), vec![mesh])?;
    let values = layout.dimension - layout.extras;
    let mut extras = x[values..layout.dimension].to_vec();
    if layout.phase && !several {
        extras.iter_mut().for_each(|period| *period *= 0.5);
    }
    let mut failure = None;
    let z =
        half.sampled(&extras, |segment, tau, out| match whole.states(x, segment, tau / scale) {
            Ok(states) => out.copy_from_slice(&states),
            Err(cause) => failure = Some(cause),
        });
    failure.map_or(Ok((half, z)), Err)
}

fn twice() -> Failure {
    mismatch("the orbit goes through everything twice: start at the orbit of half its period")
}
