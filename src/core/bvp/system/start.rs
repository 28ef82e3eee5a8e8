//! Starts of branches: from saved solutions on their own meshes, from equilibria with emanating
//! cycles, and from period doublings.

use super::discretisation::DiscretisedProblem;
use super::emanating::{Emanating, at_hopf, beside};
use super::halved::halved;
use super::layout::UnknownLayout;
use crate::core::bvp::erased::{Equations, ErasedProblem};
use crate::core::bvp::error::BoundaryError;
use crate::core::bvp::itineraries::Itineraries;
use crate::core::bvp::mesh::Mesh;
use crate::core::bvp::method::Method;
use crate::core::failure::{Failure, one_line};
use crate::core::system::{Kind, Site, Solution, Start};

fn mismatch(reason: impl Into<String>) -> Failure {
    Failure::Mismatch(reason.into())
}

impl From<BoundaryError> for Failure {
    fn from(error: BoundaryError) -> Self {
        match error {
            BoundaryError::Evaluation(cause) => cause,
            _ => mismatch(one_line(&error)),
        }
    }
}

/// The start of a branch: a saved solution, converted to a discretised problem.
pub(super) struct Resumed {
    /// The discretisation in which the start is given; `None` if it is the current discretisation.
    pub equations: Option<DiscretisedProblem>,
    pub start: Start,
    /// The reference motion of the phase condition (in the order of `z`); `None` if it is the
    /// motion of the solution itself.
    pub motion: Option<Vec<f64>>,
}

/// Computes the start of a branch from a saved solution, on the finer one of the saved and the
/// current mesh, so that the start does not lose accuracy. A saved solution of another method is
/// transferred to the current mesh.
pub(super) fn resumed(
    present: &DiscretisedProblem,
    solution: &Solution,
) -> Result<Resumed, Failure> {
    let mut other = in_words(present, &solution.itinerary)?;
    let born = other.as_ref().unwrap_or(present);
    if solution.mesh.is_empty() && born.layout.phase && solution.state.len() == born.layout.states {
        let Emanating { start, motion } = match solution.beside {
            Some(amplitude) => beside(born, solution, amplitude)?,
            None => at_hopf(born, solution)?,
        };
        return Ok(Resumed { equations: other, start, motion: Some(motion) });
    }
    let equations = other.as_ref().unwrap_or(present);
    let mut solution = solution.clone();
    let (method, mut meshes) = discretisation_of(equations, &solution)?;
    let beside_doubled = solution.beside.is_some();
    let doubled = beside_doubled || solution.kind == Kind::PD && solution.switch.is_some();
    let same_method = method.to_string() == equations.method.to_string();
    if doubled {
        if !same_method {
            return Err(mismatch(
                "the period doubling was computed by another discretisation method: restart the \
                 orbit with the present method, and locate the period doubling again",
            ));
        }
        if !beside_doubled && let Some((half, z)) = halved(equations, &solution, &meshes)? {
            let start = Start { site: Site::OtherBranch, ..Start::point(z, None) };
            return Ok(Resumed { equations: Some(half), start, motion: None });
        }
        match equations.problem.itineraries().and_then(Itineraries::doubled) {
            Some(problem) => {
                repeat(&equations.layout, &mut solution, (&method, &meshes));
                other = Some(changed(equations, problem)?);
            }
            None => double(&equations.layout, &mut solution),
        }
        meshes = meshes_of(&solution.mesh)?;
    }
    let equations = other.as_ref().unwrap_or(present);
    // The end of a branch of doubled orbits, at which that branch meets the original branch.
    let ending = solution.kind == Kind::PD
        && solution.switch.is_none()
        && same_method
        && halved(equations, &solution, &meshes)?.is_some();
    let finer =
        equations.meshes.iter().zip(&meshes).any(|(own, m)| own.intervals() > m.intervals());
    if doubled || ending || (same_method && !finer) {
        other = Some(equations.on(meshes)?);
    } else {
        solution.state = resampled(equations, &solution, method, meshes)?;
        solution.tangent = None;
    }
    let tangent = solution.tangent.as_ref().map(|(z, p)| [&z[..], &p[..]].concat());
    let one_sided = doubled || ending;
    let site = if one_sided { Site::BranchPoint } else { Site::Point };
    let start = Start { site, one_sided, ..Start::point(solution.state, tangent) };
    Ok(Resumed { equations: other, start, motion: None })
}

/// Returns the problem of a saved itinerary; `None` if the saved itinerary is the current one.
pub(super) fn in_words(
    present: &DiscretisedProblem,
    words: &str,
) -> Result<Option<DiscretisedProblem>, Failure> {
    let own = present.problem.itineraries().map_or_else(String::new, Itineraries::words);
    if words.is_empty() || words == own {
        return Ok(None);
    }
    changed(present, itineraries_of(&*present.problem)?.with_words(words)?).map(Some)
}

/// Returns the itineraries of a problem.
///
/// # Errors
/// [`Failure::Unsupported`] if all solutions of the problem have the same itinerary.
pub(super) fn itineraries_of(
    problem: &dyn Equations,
) -> Result<&dyn Itineraries<ErasedProblem>, Failure> {
    let reason = "the itinerary cannot be chosen, because all solutions of this problem have the \
                  same itinerary";
    problem.itineraries().ok_or_else(|| Failure::Unsupported(reason.into()))
}

/// Returns the number of intervals of the segment with the most intervals.
pub(super) fn most_intervals(equations: &DiscretisedProblem) -> usize {
    equations.meshes.iter().map(Mesh::intervals).max().unwrap_or(1)
}

/// Discretises another problem by the same method; every segment has as many intervals as the
/// current segment with the most intervals.
fn changed(
    present: &DiscretisedProblem,
    problem: ErasedProblem,
) -> Result<DiscretisedProblem, Failure> {
    let meshes = vec![Mesh::uniform(most_intervals(present)); problem.segments().len()];
    Ok(DiscretisedProblem::new(problem, present.method.clone(), meshes)?)
}

/// Converts a solution, and the direction of its branch, to the problem of the doubled itinerary.
fn repeat(layout: &UnknownLayout, solution: &mut Solution, (method, meshes): (&Method, &[Mesh])) {
    let values = values_on(layout, meshes, method);
    // Each segment of a cycle has one extra; segments of a map cycle have none.
    let once = layout.extras.saturating_sub(meshes.len());
    in_unknowns(solution, |z| {
        let (values, extras) = z.split_at(values);
        [values, values, extras, &extras[once..]].concat()
    });
    solution.mesh.extend_from_within(..);
}

/// Returns the number of values at nodes for a method and given meshes.
fn values_on(layout: &UnknownLayout, meshes: &[Mesh], method: &Method) -> usize {
    let degree = method.places().len() - 1;
    let segments = layout.segments.iter().zip(meshes);
    segments.map(|(s, mesh)| (mesh.intervals() * degree + 1) * s.states).sum()
}

/// Returns the method and the meshes of a saved solution.
///
/// # Errors
/// [`Failure::Mismatch`] if the solution does not belong to this problem.
pub(super) fn discretisation_of(
    equations: &DiscretisedProblem,
    solution: &Solution,
) -> Result<(Method, Vec<Mesh>), Failure> {
    let (layout, meshes) = (&equations.layout, meshes_of(&solution.mesh)?);
    let length = solution.state.len();
    if meshes.len() == layout.segments.len() {
        let method: Method = solution.method.parse()?;
        if values_on(layout, &meshes, &method) + layout.extras == length {
            return Ok((method, meshes));
        }
    }
    Err(mismatch(format!(
        "the start has {length} unknowns on {} segments, but the problem has {} segments with {} \
         states in total: was the start computed with another problem?",
        meshes.len(),
        layout.segments.len(),
        layout.states
    )))
}

/// Transfers a saved solution to other meshes; the solution may have been computed by another
/// method.
fn resampled(
    onto: &DiscretisedProblem,
    solution: &Solution,
    method: Method,
    meshes: Vec<Mesh>,
) -> Result<Vec<f64>, Failure> {
    let from = DiscretisedProblem::new(onto.problem.clone(), method, meshes)?;
    let x = [&solution.state[..], &solution.parameters[..]].concat();
    let mut z = from.carried(onto, &x)?;
    z.truncate(onto.layout.dimension);
    Ok(z)
}

/// Repeats an orbit, and the direction of its branch, on a mesh with twice as many intervals, which
/// gives a solution that spans two periods.
fn double(layout: &UnknownLayout, solution: &mut Solution) {
    let nodes = (solution.state.len() - layout.extras) / layout.states;
    in_unknowns(solution, |z| {
        let (values, extras) = z.split_at(nodes * layout.states);
        let groups = values.chunks_exact(nodes).flat_map(|v| v.iter().chain(&v[1..]));
        groups.chain(extras).copied().collect()
    });
    let end = solution.mesh.last().copied().unwrap_or_default();
    let second: Vec<f64> = solution.mesh.iter().skip(1).map(|tau| end + tau).collect();
    solution.mesh.extend(second);
}

/// Replaces the unknowns `z` of a solution, and the corresponding components of the direction of
/// its branch.
fn in_unknowns(solution: &mut Solution, new: impl Fn(&[f64]) -> Vec<f64>) {
    solution.state = new(&solution.state);
    if let Some((z, _)) = &mut solution.tangent {
        *z = new(z);
    }
}

/// Splits a list of breakpoints into the meshes of all segments. Each mesh begins with the
/// breakpoint 0.
pub(super) fn meshes_of(points: &[f64]) -> Result<Vec<Mesh>, Failure> {
    let mut meshes: Vec<Vec<f64>> = Vec::new();
    for &point in points {
        match meshes.last_mut() {
            Some(mesh) if point != 0.0 => mesh.push(point),
            _ => meshes.push(vec![point]),
        }
    }
    let mesh = |points| Mesh::new(points).map_err(|error| mismatch(one_line(&error)));
    meshes.into_iter().map(mesh).collect()
}
