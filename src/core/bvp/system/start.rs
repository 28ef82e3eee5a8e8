//! Starts of branches: from a saved solution on its own mesh, from a Hopf point, from a period
//! doubling.

use super::discretisation::Discretisation;
use super::events::itineraries_of;
use super::layout::Segment;
use super::{BoundarySystem, Method};
use crate::core::bvp::{
    BoundaryError, Equations, Guess, IntoEquations, Itineraries, Mesh, Number, Trajectory,
};
use crate::core::chunk::{CHUNK, Chunk, seeded};
use crate::core::condition::Failure;
use crate::core::flow::Flow;
use crate::core::kind::Kind;
use crate::core::scalar_field::FieldIn;
use crate::core::solution::{Site, Solution, Start};
use crate::core::zero::System;
use std::f64::consts::TAU;
use std::sync::Arc;

/// A mesh is redistributed after this many accepted points.
const ADAPT_EVERY: usize = 3;

/// It is redistributed at once where its estimated error is larger.
const ADAPT_ABOVE: f64 = 1e-3;

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

impl BoundarySystem {
    /// A start from a saved solution. The finer of its mesh and this one is taken: no start loses
    /// accuracy. A solution of another method is carried over to this mesh.
    pub(super) fn take_over(&mut self, solution: &Solution) -> Result<Start, Failure> {
        let states = self.equations.layout.states;
        if solution.mesh.is_empty() && self.equations.layout.phase && solution.state.len() == states
        {
            return self.born_at_hopf(solution);
        }
        let words = &solution.itinerary;
        if !words.is_empty() && *words != (self as &mut dyn System).words() {
            self.change_to(itineraries_of(&**self.problem())?.with_words(words)?)?;
        }
        let mut solution = solution.clone();
        let (method, meshes) = self.discretisation_of(&solution)?;
        let doubled = solution.kind == Kind::PD && solution.switch.is_some();
        let itineraries = self.problem().itineraries().filter(|_| doubled);
        let twice = itineraries.and_then(Itineraries::doubled);
        match twice {
            Some(problem) => self.repeat(&mut solution, problem, (&method, &meshes))?,
            None if doubled => self.double(&mut solution),
            None => {}
        }
        let meshes = if doubled { meshes_of(&solution.mesh)? } else { meshes };
        let same_method = method.to_string() == self.equations.method.to_string();
        if doubled && !same_method {
            return Err(mismatch(
                "the period doubling was found by another method: restart the orbit with this one first, and \
                 find it again",
            ));
        }
        let finer =
            self.meshes().iter().zip(&meshes).any(|(own, m)| own.intervals() > m.intervals());
        if doubled || (same_method && !finer) {
            *self = self.on(meshes)?;
        } else {
            solution.state = self.resampled(&solution, method, meshes)?;
            solution.tangent = None;
        }
        let x = [&solution.state[..], &solution.parameters[..]].concat();
        self.set_reference(&x)?;
        let tangent = solution.tangent.as_ref().map(|(z, p)| [&z[..], &p[..]].concat());
        let site = if doubled { Site::BranchPoint } else { Site::Point };
        Ok(Start { site, one_sided: doubled, ..Start::point(solution.state, tangent) })
    }

    /// The number of intervals of the segment that has most.
    pub(super) fn most_intervals(&self) -> usize {
        self.meshes().iter().map(Mesh::intervals).max().unwrap_or(1)
    }

    /// Another problem, on as many intervals a segment as the segment with most has now.
    fn change_to(&mut self, problem: Arc<dyn Equations>) -> Result<(), Failure> {
        let intervals = self.most_intervals();
        let meshes = vec![Mesh::uniform(intervals); problem.segments().len()];
        *self = BoundarySystem::new(problem, self.equations.method.clone(), meshes)?;
        Ok(())
    }

    /// The solution twice, and its direction, as one of the problem in which everything happens
    /// twice.
    fn repeat(
        &mut self,
        solution: &mut Solution,
        problem: Arc<dyn Equations>,
        (method, meshes): (&Method, &[Mesh]),
    ) -> Result<(), Failure> {
        let values = self.values_on(meshes, method);
        // The legs of orbits have an unknown each, segments without motion have none.
        let once = self.equations.layout.extras.saturating_sub(meshes.len());
        in_unknowns(solution, |z| {
            let (values, extras) = z.split_at(values);
            [values, values, extras, &extras[once..]].concat()
        });
        solution.mesh.extend_from_within(..);
        self.change_to(problem)
    }

    /// The unknowns `z` of trajectories that flow from the states where segments begin.
    ///
    /// # Errors
    /// [`Failure`] where a trajectory leaves the domain of its field.
    pub fn flowed(&self, starts: &[f64], extras: &[f64], p: &[f64]) -> Result<Vec<f64>, Failure> {
        let start = |s: &Segment| Trajectory::from(starts[s.ends..s.ends + s.states].to_vec());
        let known: Vec<_> = self.equations.layout.segments.iter().map(start).collect();
        self.filled(&known, extras, p)
    }

    /// The unknowns `z` of trajectories that are known at nodes.
    pub(super) fn filled(
        &self,
        known: &[Trajectory],
        extras: &[f64],
        p: &[f64],
    ) -> Result<Vec<f64>, Failure> {
        let (problem, mut numbers) = (self.problem(), Vec::new());
        self.equations.layout.spread(&[p, extras].concat(), &mut numbers);
        let mut flow = Flow::<f64>::default();
        let mut at = (usize::MAX, 0.0, Vec::new());
        self.equations.sampled(extras, |segment, tau, out| {
            let (equations, q) =
                (f64::residual(&**problem), &numbers[self.equations.layout.local(segment)]);
            let field = equations.on_segment(segment, q);
            let duration = equations.duration_in(segment, q);
            let time = tau * duration;
            let (node, states) = known[segment].before(time);
            if at.0 != segment || node > at.1 {
                at = (segment, node, states.to_vec());
            }
            let (from, x) = (at.1, &mut at.2);
            if time != from {
                flow.advance(&field, from, time - from, x, q)?;
            }
            at.1 = time;
            out.copy_from_slice(&at.2);
            Ok(())
        })
    }

    /// How many values a method has on meshes.
    fn values_on(&self, meshes: &[Mesh], method: &Method) -> usize {
        let degree = method.places().len() - 1;
        let segments = self.equations.layout.segments.iter().zip(meshes);
        segments.map(|(s, mesh)| (mesh.intervals() * degree + 1) * s.states).sum()
    }

    /// The method and the meshes of a saved solution.
    ///
    /// # Errors
    /// [`Failure::Mismatch`] if it is no solution of this problem.
    pub(super) fn discretisation_of(
        &self,
        solution: &Solution,
    ) -> Result<(Method, Vec<Mesh>), Failure> {
        let (layout, meshes) = (&self.equations.layout, meshes_of(&solution.mesh)?);
        let length = solution.state.len();
        if meshes.len() == layout.segments.len() {
            let method: Method = solution.method.parse()?;
            if self.values_on(&meshes, &method) + layout.extras == length {
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

    /// A solution saved on other meshes, by another method, on these meshes.
    fn resampled(
        &self,
        solution: &Solution,
        method: Method,
        meshes: Vec<Mesh>,
    ) -> Result<Vec<f64>, Failure> {
        let from = Discretisation::new(self.problem().clone(), method, meshes)?;
        let x = [&solution.state[..], &solution.parameters[..]].concat();
        let mut z = from.carried(&self.equations, &x)?;
        z.truncate(self.equations.layout.dimension);
        Ok(z)
    }

    /// The orbit twice, and its direction, on twice the intervals: a solution of period two.
    fn double(&self, solution: &mut Solution) {
        let layout = &self.equations.layout;
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
    fn born_at_hopf(&mut self, solution: &Solution) -> Result<Start, Failure> {
        let problem = self.problem().clone();
        let n = self.equations.layout.states;
        let mut q = solution.parameters.clone();
        q.resize(self.equations.layout.numbers(), 1.0);
        let (omega, v) = oscillating_pair(&jacobian(&*problem, &solution.state, &q)?, n)?;
        let extras = vec![TAU / omega; self.equations.layout.extras];
        let z = self.sampled(&extras, |_, _, x| x.copy_from_slice(&solution.state));
        let wave = |shift: f64| {
            move |_: usize, tau: f64, x: &mut [f64]| {
                let (sine, cosine) = (TAU * (tau + shift)).sin_cos();
                x.iter_mut().zip(&v).for_each(|(x, v)| *x = v[0] * cosine - v[1] * sine);
            }
        };
        let zero = vec![0.0; extras.len()];
        let mut direction = self.sampled(&zero, wave.clone()(0.0));
        // A quarter of a period on, the wave is its own derivative.
        let motion = self.sampled(&zero, wave(0.25));
        // A branch begins towards growth of its direction's largest component.
        let largest = direction.iter().max_by(|a, b| a.abs().total_cmp(&b.abs()));
        if largest.is_some_and(|largest| *largest < 0.0) {
            direction.iter_mut().for_each(|value| *value = -*value);
        }
        let x = [&z[..], &solution.parameters[..]].concat();
        self.forget();
        self.phase.refer_to_motion(&self.equations, &x, &motion);
        direction.resize(x.len(), 0.0);
        let (site, one_sided) = (Site::Singular, true);
        Ok(Start { site, one_sided, ..Start::point(z, Some(direction)) })
    }

    /// Lets mesh and phase condition follow a branch.
    pub(super) fn follow_to(&mut self, x: &mut [f64], directions: &mut [&mut [f64]]) {
        self.followed += 1;
        // Where an orbit leaves the domain, the next correction says so.
        let late = self.followed.is_multiple_of(ADAPT_EVERY);
        if late || self.mesh_error(x) > ADAPT_ABOVE {
            let _ = self.adapt(x, directions);
        }
        if self.equations.layout.phase {
            let _ = self.set_reference(x);
        }
    }
}

impl<P: IntoEquations> Guess<P> {
    /// The system of the problem, with a number of intervals for each segment, and its unknowns `z`
    /// at parameters `p`, integrated from one node of the known trajectories to the next.
    ///
    /// # Errors
    /// [`Failure`] if there is no interval, or where a trajectory leaves the domain of its field.
    pub fn discretised(
        self,
        p: &[f64],
        method: impl Into<Method>,
        intervals: usize,
    ) -> Result<(BoundarySystem, Vec<f64>), Failure> {
        let Guess { problem, trajectories, extras, .. } = self.erased();
        let meshes = vec![Mesh::uniform(intervals); problem.segments().len()];
        let system = BoundarySystem::new(problem, method, meshes)?;
        let z = system.filled(&trajectories, &extras, p)?;
        Ok((system, z))
    }
}

/// Replaces the unknowns of a solution, and those of its direction.
fn in_unknowns(solution: &mut Solution, new: impl Fn(&[f64]) -> Vec<f64>) {
    solution.state = new(&solution.state);
    if let Some((z, _)) = &mut solution.tangent {
        *z = new(z);
    }
}

/// The meshes of all segments, each of which begins with 0.
fn meshes_of(points: &[f64]) -> Result<Vec<Mesh>, Failure> {
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

/// The Jacobian of the first segment's field by its states, one column after the other.
fn jacobian(problem: &dyn Equations, x: &[f64], q: &[f64]) -> Result<Vec<f64>, Failure> {
    let (n, zero) = (x.len(), Chunk::from(0.0));
    let real = f64::residual(problem).on_segment(0, q);
    real.domain(x, q)?;
    let q: Vec<Chunk> = q.iter().map(|q| Chunk::from(*q)).collect();
    let field = Chunk::residual(problem).on_segment(0, &q);
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

/// Eigenvalues with a smaller real part, in units of the imaginary one, are those of a Hopf point.
const NEAR_THE_AXIS: f64 = 1e-4;

/// The eigenvalue `iω` nearest to the imaginary axis, and its eigenvector as (real, imaginary)
/// parts.
fn oscillating_pair(jacobian: &[f64], n: usize) -> Result<(f64, Vec<[f64; 2]>), Failure> {
    let matrix = faer::MatRef::from_column_major_slice(jacobian, n, n);
    let decomposition =
        matrix.eigen().map_err(|_| Failure::Eigenvalues("eigenvalues at the Hopf point"))?;
    let values = decomposition.S().column_vector();
    let pair = (0..n)
        .filter(|&k| values[k].im > 0.0)
        .min_by(|&a, &b| values[a].re.abs().total_cmp(&values[b].re.abs()))
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
    let vector = (0..n).map(|i| decomposition.U()[(i, pair)]).map(|v| [v.re, v.im]).collect();
    Ok((values[pair].im, vector))
}
