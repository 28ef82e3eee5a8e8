//! Starts of branches: from a saved solution on its own mesh, from a Hopf point, from a period
//! doubling.

use super::discretisation::DiscretisedProblem;
use super::halved::halved;
use super::layout::UnknownLayout;
use crate::core::bvp::erased::{Equations, ErasedProblem, Number};
use crate::core::bvp::error::BoundaryError;
use crate::core::bvp::itineraries::Itineraries;
use crate::core::bvp::mesh::Mesh;
use crate::core::bvp::method::Method;
use crate::core::failure::Failure;
use crate::core::linalg::balance;
use crate::core::problem::FieldIn;
use crate::core::scalar::{CHUNK, Chunk, seeded};
use crate::core::system::{Kind, Site, Solution, Start};
use std::f64::consts::TAU;

fn mismatch(reason: impl Into<String>) -> Failure {
    Failure::Mismatch(reason.into())
}

impl From<BoundaryError> for Failure {
    fn from(error: BoundaryError) -> Self {
        match error {
            BoundaryError::Evaluation(cause) => cause,
            _ => mismatch(error.to_string()),
        }
    }
}

/// A saved solution as one of a discretised problem, from which a branch starts.
pub(super) struct Resumed {
    /// The discretisation, if the solution belongs to another one than the present.
    pub equations: Option<DiscretisedProblem>,
    pub start: Start,
    /// The motion that the phase condition refers to (ordered as `z`), if it is not the solution's
    /// own.
    pub motion: Option<Vec<f64>>,
}

/// A start from a saved solution. The finer of its mesh and the present one is taken: no start
/// loses accuracy. A solution of another method is carried over to the present mesh.
pub(super) fn resumed(
    present: &DiscretisedProblem,
    solution: &Solution,
) -> Result<Resumed, Failure> {
    let mut other = in_words(present, &solution.itinerary)?;
    let born = other.as_ref().unwrap_or(present);
    if solution.mesh.is_empty() && born.layout.phase && solution.state.len() == born.layout.states {
        let resumed = born_at_hopf(born, solution)?;
        return Ok(Resumed { equations: other, ..resumed });
    }
    let equations = other.as_ref().unwrap_or(present);
    let mut solution = solution.clone();
    let (method, mut meshes) = discretisation_of(equations, &solution)?;
    let doubled = solution.kind == Kind::PD && solution.switch.is_some();
    let same_method = method.to_string() == equations.method.to_string();
    if doubled {
        if !same_method {
            return Err(mismatch(
                "the period doubling was found by another method: restart the orbit with this one first, and \
                 find it again",
            ));
        }
        if let Some((half, z)) = halved(equations, &solution, &meshes)? {
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
    // The end of a branch of doubled orbits, where that branch crosses the one that it doubles.
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

/// The problem of a saved itinerary; `None` if it is the present one.
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

/// What is known of a problem's itineraries.
///
/// # Errors
/// [`Failure::Unsupported`] if all solutions go through the same.
pub(super) fn itineraries_of(
    problem: &dyn Equations,
) -> Result<&dyn Itineraries<ErasedProblem>, Failure> {
    let reason = "all solutions of this problem go through the same: it has no itineraries";
    problem.itineraries().ok_or_else(|| Failure::Unsupported(reason.into()))
}

/// The number of intervals of the segment that has most.
pub(super) fn most_intervals(equations: &DiscretisedProblem) -> usize {
    equations.meshes.iter().map(Mesh::intervals).max().unwrap_or(1)
}

/// Another problem by the same method, on as many intervals a segment as the segment with most has
/// now.
fn changed(
    present: &DiscretisedProblem,
    problem: ErasedProblem,
) -> Result<DiscretisedProblem, Failure> {
    let meshes = vec![Mesh::uniform(most_intervals(present)); problem.segments().len()];
    Ok(DiscretisedProblem::new(problem, present.method.clone(), meshes)?)
}

/// Makes of a solution, and its direction, one of the problem in which everything happens twice.
fn repeat(layout: &UnknownLayout, solution: &mut Solution, (method, meshes): (&Method, &[Mesh])) {
    let values = values_on(layout, meshes, method);
    // Segments of a cycle have an unknown each, segments without motion have none.
    let once = layout.extras.saturating_sub(meshes.len());
    in_unknowns(solution, |z| {
        let (values, extras) = z.split_at(values);
        [values, values, extras, &extras[once..]].concat()
    });
    solution.mesh.extend_from_within(..);
}

/// How many values a method has on meshes.
fn values_on(layout: &UnknownLayout, meshes: &[Mesh], method: &Method) -> usize {
    let degree = method.places().len() - 1;
    let segments = layout.segments.iter().zip(meshes);
    segments.map(|(s, mesh)| (mesh.intervals() * degree + 1) * s.states).sum()
}

/// The method and the meshes of a saved solution.
///
/// # Errors
/// [`Failure::Mismatch`] if it is no solution of this problem.
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
        "the start has {length} unknowns on {} segments, the problem {} segments of {} states: was it made \
         with another problem?",
        meshes.len(),
        layout.segments.len(),
        layout.states
    )))
}

/// A solution saved on other meshes, perhaps by another method, on other meshes.
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

/// The orbit twice, and its direction, on twice the intervals: a solution of period two.
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

/// The orbit of vanishing amplitude at a Hopf point, `x* + ε Re(v e^{2πiτ})`, and its direction
/// in `ε`: `v` is the eigenvector of the field's Jacobian with the eigenvalue `iω`, and the
/// period `2π/ω`.
fn born_at_hopf(on: &DiscretisedProblem, solution: &Solution) -> Result<Resumed, Failure> {
    let n = on.layout.states;
    let mut q = solution.parameters.clone();
    q.resize(on.layout.numbers(), 1.0);
    let matrix = jacobian(&*on.problem, 0, &solution.state, &q)?;
    let (omega, v) = oscillating_pair(&matrix, n, solution.frequency)?;
    let extras = vec![TAU / omega; on.layout.extras];
    let z = on.sampled(&extras, |_, _, x| x.copy_from_slice(&solution.state));
    let wave = |shift: f64| {
        move |_: usize, tau: f64, x: &mut [f64]| {
            let (sine, cosine) = (TAU * (tau + shift)).sin_cos();
            x.iter_mut().zip(&v).for_each(|(x, v)| *x = v[0] * cosine - v[1] * sine);
        }
    };
    let zero = vec![0.0; extras.len()];
    let mut direction = on.sampled(&zero, wave.clone()(0.0));
    // A quarter of a period on, the wave is its own derivative.
    let motion = on.sampled(&zero, wave(0.25));
    // A branch begins towards growth of its direction's largest component.
    let largest = direction.iter().max_by(|a, b| a.abs().total_cmp(&b.abs()));
    if largest.is_some_and(|largest| *largest < 0.0) {
        direction.iter_mut().for_each(|value| *value = -*value);
    }
    direction.resize(z.len() + solution.parameters.len(), 0.0);
    let (site, one_sided) = (Site::Singular, true);
    let start = Start { site, one_sided, ..Start::point(z, Some(direction)) };
    Ok(Resumed { equations: None, start, motion: Some(motion) })
}

/// Replaces the unknowns of a solution, and those of its direction.
fn in_unknowns(solution: &mut Solution, new: impl Fn(&[f64]) -> Vec<f64>) {
    solution.state = new(&solution.state);
    if let Some((z, _)) = &mut solution.tangent {
        *z = new(z);
    }
}

/// The meshes of all segments, each of which begins with 0.
pub(super) fn meshes_of(points: &[f64]) -> Result<Vec<Mesh>, Failure> {
    let mut meshes: Vec<Vec<f64>> = Vec::new();
    for &point in points {
        match meshes.last_mut() {
            Some(mesh) if point != 0.0 => mesh.push(point),
            _ => meshes.push(vec![point]),
        }
    }
    let mesh = |points| Mesh::new(points).map_err(|error| mismatch(error.to_string()));
    meshes.into_iter().map(mesh).collect()
}

/// The Jacobian of a segment's field by its states, one column after the other.
pub(super) fn jacobian(
    problem: &dyn Equations,
    segment: usize,
    x: &[f64],
    q: &[f64],
) -> Result<Vec<f64>, Failure> {
    let (n, zero) = (x.len(), Chunk::from(0.0));
    let real = f64::residual(problem).on_segment(segment, q);
    real.domain(x, q)?;
    let q: Vec<Chunk> = q.iter().map(|q| Chunk::from(*q)).collect();
    let field = Chunk::residual(problem).on_segment(segment, &q);
    let (mut columns, mut f) = (vec![0.0; n * n], vec![zero; n]);
    for first in (0..n).step_by(CHUNK) {
        let x: Vec<Chunk> = x.iter().enumerate().map(|(i, x)| seeded(*x, i, first)).collect();
        field.slope(zero, &x, &q, &mut f);
        for (i, f) in f.iter().enumerate() {
            (first..n).zip(f.eps).for_each(|(j, part)| columns[j * n + i] = part);
        }
    }
    Ok(columns)
}

/// The largest real part of an eigenvalue of a Hopf point, in units of the imaginary part (H).
const NEAR_THE_AXIS: f64 = 1e-4;

/// The eigenvalue `iω` nearest to the imaginary axis, or to a frequency that is known, and its
/// eigenvector as (real, imaginary) parts.
fn oscillating_pair(
    jacobian: &[f64],
    n: usize,
    known: Option<f64>,
) -> Result<(f64, Vec<[f64; 2]>), Failure> {
    let mut balanced = jacobian.to_vec();
    let units = balance(&mut balanced, n);
    let matrix = faer::MatRef::from_column_major_slice(&balanced, n, n);
    let decomposition =
        matrix.eigen().map_err(|_| Failure::Eigenvalues("eigenvalues at the Hopf point"))?;
    let values = decomposition.S().column_vector();
    let distance = |k: usize| match known {
        Some(omega) => values[k].re.hypot(values[k].im - omega),
        None => values[k].re.abs(),
    };
    let pair = (0..n)
        .filter(|&k| values[k].im > 0.0)
        .min_by(|&a, &b| distance(a).total_cmp(&distance(b)))
        .ok_or_else(|| {
            mismatch(
                "no complex pair of eigenvalues: a branch of periodic orbits starts at a Hopf point (HB)",
            )
        })?;
    let (re, im) = (values[pair].re, values[pair].im);
    if re.abs() > NEAR_THE_AXIS * im {
        return Err(mismatch(format!(
            "the eigenvalue {re:.3e} + {im:.3e}i is not on the imaginary axis: a branch of periodic orbits \
             starts at a Hopf point (HB)"
        )));
    }
    let entry = |i: usize| [decomposition.U()[(i, pair)].re, decomposition.U()[(i, pair)].im];
    let vector = (0..n).map(|i| entry(i).map(|part| part * units[i])).collect();
    Ok((values[pair].im, vector))
}
