//! Periodic solutions that consist of two equal halves, converted to orbits of half the period.

use super::discretisation::DiscretisedProblem;
use super::solutions::Solutions;
use crate::core::bvp::itineraries::Itineraries;
use crate::core::bvp::mesh::Mesh;
use crate::core::failure::{Failure, one_line};
use crate::core::linalg::largest;
use crate::core::system::Solution;

/// Heuristic: the number of phases at which the two halves of a solution are compared.
const PHASES: usize = 64;

/// Heuristic: the number of phases at which the difference between the halves is computed, where only its
/// size and direction matter.
const FEW: usize = 8;

/// Discretisation: the two halves of a solution count as equal if their difference, relative to the
/// solution's size, is smaller than this bound; both halves have errors of the same mesh.
const REPEATS: f64 = 1e-6;

/// Heuristic: the largest difference of a solution's halves that is attributed to the mesh, as a
/// multiple of the mesh error.
const MESH: f64 = 5.0;

/// A comparison of the two halves of a solution.
pub(super) struct Halves {
    /// The largest difference between the two halves.
    miss: f64,
    /// The largest absolute value of a state.
    pub size: f64,
    /// The difference between the halves that the mesh error can explain, as a fraction of the
    /// largest absolute value of a state.
    error: f64,
    /// Whether the halves span several periods or several segments: a constant solution can then
    /// belong to a branch of doubled solutions.
    several: bool,
}

impl Halves {
    /// Compares the halves of a solution; `None` if the solution cannot be divided into halves.
    pub fn of(solutions: &mut Solutions, x: &[f64]) -> Option<Self> {
        let (mut size, mut miss) = (0.0_f64, 0.0_f64);
        visit((solutions, x), PHASES, |_, a, b| {
            size = size.max(largest(a));
            miss = a.iter().zip(b).fold(miss, |miss, (a, b)| miss.max((a - b).abs()));
        })?;
        let (layout, end) = (&solutions.equations.layout, solutions.equations.meshes[0].end());
        let several = layout.segments.len() > 1 || end >= 2.0;
        Some(Halves { miss, size, error: MESH * solutions.mesh_error(x), several })
    }

    /// Whether the halves are equal, in which case the solution has half the period. For a constant
    /// solution, the difference is compared with the `reach` of its branch, which is the size of
    /// the states nearby.
    pub fn are_equal(&self, reach: f64) -> bool {
        let reach = if self.several { reach } else { 0.0 };
        self.miss <= REPEATS.max(self.error) * self.size.max(reach)
    }
}

/// Returns the difference between the halves of a solution, in units of the states' scales; `None` if the
/// solution cannot be divided into halves.
pub(super) fn difference(solutions: &mut Solutions, x: &[f64]) -> Option<Vec<f64>> {
    let layout = &solutions.equations.layout;
    let q: Vec<f64> = (0..layout.numbers()).map(|k| x[layout.number(k)]).collect();
    let problem = solutions.equations.problem.clone();
    let mut all = Vec::new();
    visit((solutions, x), FEW, |segment, a, b| {
        let mut units = problem.scales(segment, &q);
        units.resize(a.len(), 1.0);
        all.extend(a.iter().zip(b).zip(units).map(|((a, b), unit)| (a - b) / unit));
    })?;
    Some(all)
}

/// Visits the states of both halves of a solution, and their segment in the first half, at a number of
/// phases; `None` if the solution cannot be divided into halves.
fn visit(
    (solutions, x): (&mut Solutions, &[f64]),
    phases: usize,
    mut visitor: impl FnMut(usize, &[f64], &[f64]),
) -> Option<()> {
    let segments = solutions.equations.layout.segments.len();
    let single = segments == 1;
    let divided = segments.is_multiple_of(2) && rotates_by_half(&solutions.equations, x);
    if !(single || divided) {
        return None;
    }
    let end = solutions.equations.meshes[0].end();
    solutions.load(x);
    for k in 0..phases {
        let tau = k as f64 / phases as f64;
        let (first, second) = match single {
            true => ((0, 0.5 * tau * end), (0, 0.5 * (1.0 + tau) * end)),
            false => {
                let segment = k * (segments / 2) / phases;
                ((segment, tau), (segment + segments / 2, tau))
            }
        };
        let mut at = |(segment, tau): (usize, f64)| {
            let mut out = vec![0.0; solutions.equations.layout.segments[segment].states];
            solutions.equations.value(&mut solutions.plain, segment, tau, &mut out).ok()?;
            Some(out)
        };
        let halves = [at(first)?, at(second)?];
        visitor(first.0, &halves[0], &halves[1]);
    }
    Some(())
}

/// Whether a solution with an even number of segments can begin with the first segment of its
/// second half.
fn rotates_by_half(equations: &DiscretisedProblem, x: &[f64]) -> bool {
    let layout = &equations.layout;
    let extras = &x[layout.values()..layout.dimension];
    let q = [&x[layout.dimension..], extras].concat();
    let itineraries = equations.problem.itineraries();
    itineraries.is_some_and(|it| it.rotated(layout.segments.len() / 2, &q, extras).is_some())
}

/// The equations and the unknowns of the orbit of half the period; `None` if the solution does not
/// consist of equal halves.
type Half = Option<(DiscretisedProblem, Vec<f64>)>;

/// Returns the orbit of half the period at the end of a branch of doubled orbits; `None` if the two
/// halves of the solution differ.
pub(super) fn halved(
    equations: &DiscretisedProblem,
    solution: &Solution,
    meshes: &[Mesh],
) -> Result<Half, Failure> {
    let mut whole = Solutions::new(equations.on(meshes.to_vec())?);
    let x = [&solution.state[..], &solution.parameters[..]].concat();
    let values = equations.layout.values();
    let along = solution.tangent.as_ref().and_then(|(z, _)| z.get(..values));
    let reach = along.map_or(0.0, largest);
    if !Halves::of(&mut whole, &x).is_some_and(|it| it.are_equal(reach)) {
        return Ok(None);
    }
    match meshes {
        [mesh] => first_period(&whole.equations, mesh, &x),
        _ => first_segments(&whole.equations, meshes, &solution.state),
    }
}

/// Returns the first half of the segments, with the extra unknowns of these segments, preceded by
/// the extra unknowns that belong to no segment.
fn first_segments(whole: &DiscretisedProblem, meshes: &[Mesh], z: &[f64]) -> Result<Half, Failure> {
    let (layout, half) = (&whole.layout, meshes.len() / 2);
    let problem = whole.problem.itineraries().and_then(Itineraries::halved);
    let Some(problem) = problem else { return Ok(None) };
    let first = &meshes[..half];
    // Each segment of a cycle has one extra; segments of a map cycle have none.
    let once = layout.extras.saturating_sub(meshes.len());
    let extras = z.len() - layout.extras;
    let count = once + (layout.extras - once) / 2;
    let values = &z[..layout.segments[half].values];
    let z = [values, &z[extras..extras + count]].concat();
    Ok(Some((DiscretisedProblem::new(problem, whole.method.clone(), first.to_vec())?, z)))
}

/// Returns the first half of the only segment: on half the mesh if the mesh spans several periods;
/// otherwise with half the period, or with half as many periods of the forcing.
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
    let mesh = Mesh::new(points).map_err(|cause| Failure::Mismatch(one_line(&cause)))?;
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
