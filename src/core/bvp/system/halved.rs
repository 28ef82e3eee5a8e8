//! Orbits that go through everything twice, as orbits of half the period.

use super::discretisation::DiscretisedProblem;
use super::solutions::Solutions;
use crate::core::bvp::itineraries::Itineraries;
use crate::core::bvp::mesh::Mesh;
use crate::core::failure::Failure;
use crate::core::system::Solution;

/// The equations and the unknowns of the orbit of half the period, if there is one.
type Half = Option<(DiscretisedProblem, Vec<f64>)>;

/// The orbit of half the period, where a branch of doubled orbits ends; `None` if the two halves of
/// the solution differ.
pub(super) fn halved(
    equations: &DiscretisedProblem,
    solution: &Solution,
    meshes: &[Mesh],
) -> Result<Half, Failure> {
    let mut whole = Solutions::new(equations.on(meshes.to_vec())?);
    let x = [&solution.state[..], &solution.parameters[..]].concat();
    if !whole.repeats(&x) {
        return Ok(None);
    }
    match meshes {
        [mesh] => first_period(&whole.equations, mesh, &x),
        _ => first_segments(&whole.equations, meshes, &solution.state),
    }
}

/// The first half of the segments, with their extras and those before them.
fn first_segments(whole: &DiscretisedProblem, meshes: &[Mesh], z: &[f64]) -> Result<Half, Failure> {
    let (layout, half) = (&whole.layout, meshes.len() / 2);
    let problem = whole.problem.itineraries().and_then(Itineraries::halved);
    let Some(problem) = problem else { return Ok(None) };
    let first = &meshes[..half];
    // Segments of a cycle have an unknown each, segments without motion have none.
    let once = layout.extras.saturating_sub(meshes.len());
    let extras = z.len() - layout.extras;
    let count = once + (layout.extras - once) / 2;
    let values = &z[..layout.segments[half].values];
    let z = [values, &z[extras..extras + count]].concat();
    Ok(Some((DiscretisedProblem::new(problem, whole.method.clone(), first.to_vec())?, z)))
}

/// The first half of the only segment: on half the mesh where that spans several periods, else with
/// half the period, or half as many periods of the forcing.
fn first_period(whole: &DiscretisedProblem, mesh: &Mesh, x: &[f64]) -> Result<Half, Failure> {
    let (layout, end) = (&whole.layout, mesh.end());
    let fewer = whole.problem.itineraries().and_then(Itineraries::halved);
    let several = end >= 2.0;
    if !several && !layout.phase && fewer.is_none() {
        // On segments without motion both halves are always equal.
        return Ok(None);
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
    failure.map_or(Ok(Some((half, z))), Err)
}
