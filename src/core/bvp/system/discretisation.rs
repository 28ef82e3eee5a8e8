//! Boundary-value problems on their meshes, in any scalar type.

use super::layout::{Segment, UnknownLayout, span};
use super::work::{Local, Work};
use crate::core::bvp::erased::{ErasedProblem, Number};
use crate::core::bvp::error::BoundaryError;
use crate::core::bvp::interval::{Interval, Span, placed};
use crate::core::bvp::mesh::Mesh;
use crate::core::bvp::method::Method;
use crate::core::bvp::terms::Ends;
use crate::core::bvp::trajectory::Trajectory;
use crate::core::failure::{Failure, not_finite, one_line};
use crate::core::ode::{Flow, Settings};
use std::convert::Infallible;
use std::sync::Arc;

/// Heuristic: the relative error allowed in gradients of conditions: gradients affect the
/// convergence rate of Newton's iteration, but not its limit.
pub(super) const GRADIENT: f64 = 1e-8;

/// A discretised boundary-value problem: the problem, a method, and a mesh for each segment.
///
/// The unknowns `z` are, for each segment and each state, a group of values at the segment's nodes
/// (`N·m + 1` values for `N` intervals with `m` nodes beyond the first), then one scalar group for
/// each extra unknown.
pub struct DiscretisedProblem {
    pub(super) problem: ErasedProblem,
    pub(super) method: Method,
    pub(super) meshes: Vec<Mesh>,
    pub(super) layout: Arc<UnknownLayout>,
    /// Whether a Newton iteration is in progress, during which larger errors are allowed.
    pub(super) rough: bool,
    /// Whether gradients of conditions are computed as accurately as residuals.
    pub(super) exact_gradients: bool,
}

/// A solution that is given by its trajectories.
pub(in crate::core) struct Known {
    /// The problem that the solution solves.
    pub problem: ErasedProblem,
    pub q: Vec<f64>,
    /// The trajectory of each segment.
    pub trajectories: Vec<Trajectory>,
}

impl DiscretisedProblem {
    pub(super) fn new(
        problem: ErasedProblem,
        method: Method,
        meshes: Vec<Mesh>,
    ) -> Result<Self, BoundaryError> {
        let layout = Arc::new(UnknownLayout::new(&*problem, &method, &meshes)?);
        let (rough, exact_gradients) = (false, false);
        Ok(DiscretisedProblem { problem, method, meshes, layout, rough, exact_gradients })
    }

    /// Creates the discretisation of the same problem by the same method on other meshes.
    pub(super) fn on(&self, meshes: Vec<Mesh>) -> Result<Self, BoundaryError> {
        DiscretisedProblem::new(self.problem.clone(), self.method.clone(), meshes)
    }

    /// The problem itself.
    pub fn problem(&self) -> &ErasedProblem {
        &self.problem
    }

    /// The mesh of each segment.
    pub fn meshes(&self) -> &[Mesh] {
        &self.meshes
    }

    /// Computes the unknowns `z` of given trajectories; the function `states` writes the states of
    /// a segment at a time in units of the segment's duration.
    ///
    /// ```
    /// # use tangency::core::bvp::*;
    /// # use tangency::core::system::System;
    /// # use tangency::problems::classic::Decay;
    /// // x' = −rate·x, x(0) = 1.
    /// let mut system = BoundarySystem::new(Decay, Collocation::new(3)?, vec![Mesh::uniform(4)])?;
    /// let z = system.sampled(&[], |_, tau, x| x[0] = tau * tau);
    /// // Four intervals of three nodes, and the final node.
    /// assert_eq!((z.len(), z[0], z[12]), (13, 0.0, 1.0));
    /// let x = [&z[..], &[1.0]].concat();
    /// assert!((system.states(&x, 0, 0.3)?[0] - 0.09).abs() < 1e-15);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn sampled(
        &self,
        extras: &[f64],
        mut states: impl FnMut(usize, f64, &mut [f64]),
    ) -> Vec<f64> {
        let Ok(mut z) = self.at_nodes(extras, |segment, tau, x| {
            states(segment, tau, x);
            Ok::<(), Infallible>(())
        });
        z.resize(self.layout.dimension, 0.0);
        z
    }

    /// Computes the states of a segment at a time in units of the segment's duration.
    ///
    /// # Errors
    /// [`Failure::OutOfDomain`] if the trajectory leaves the domain of the field, or if the segment
    /// does not exist.
    pub fn states(&self, x: &[f64], segment: usize, tau: f64) -> Result<Vec<f64>, Failure> {
        let layout = &self.layout;
        let Some(s) = layout.segments.get(segment) else {
            let count = layout.segments.len();
            return Err(Failure::Mismatch(format!(
                "segment {segment} does not exist: the problem has {count} segments, numbered from \
                 0"
            )));
        };
        // Only the interval that contains the time is loaded.
        let (interval, place) = self.meshes[segment].locate(tau);
        let nodes = layout.order[layout.interval(segment, interval)].iter().map(|&k| x[k]);
        let q: Vec<f64> = (0..layout.numbers()).map(|k| x[layout.number(k)]).collect();
        let (nodes, mut numbers) = (nodes.collect::<Vec<f64>>(), Vec::new());
        layout.spread(&q, &mut numbers);
        let interval = self.alone((segment, interval), &nodes, &numbers[layout.local(segment)]);
        let mut out = vec![0.0; s.states];
        self.method.value(interval, place, &mut Default::default(), &mut out)?;
        Ok(out)
    }

    /// Computes the unknowns `z` of trajectories that flow from the initial states of the segments.
    ///
    /// # Errors
    /// [`Failure`] if a trajectory leaves the domain of its vector field.
    pub fn flowed(&self, starts: &[f64], extras: &[f64], p: &[f64]) -> Result<Vec<f64>, Failure> {
        let start = |s: &Segment| Trajectory::from(starts[s.ends..s.ends + s.states].to_vec());
        let known: Vec<_> = self.layout.segments.iter().map(start).collect();
        self.filled(&known, extras, p)
    }

    /// Computes the unknowns `z` of trajectories that are known only at nodes; stiff vector fields
    /// are integrated by the implicit method.
    pub(super) fn filled(
        &self,
        known: &[Trajectory],
        extras: &[f64],
        p: &[f64],
    ) -> Result<Vec<f64>, Failure> {
        match self.filled_by(Flow::default(), known, extras, p) {
            Err(Failure::Flow(cause)) if cause.is_stiff() => {
                let flow = Flow::new(Settings::implicit());
                let flow = flow.map_err(|cause| Failure::Unsupported(one_line(&cause)))?;
                self.filled_by(flow, known, extras, p)
            }
            outcome => outcome,
        }
    }

    fn filled_by(
        &self,
        mut flow: Flow<f64>,
        known: &[Trajectory],
        extras: &[f64],
        p: &[f64],
    ) -> Result<Vec<f64>, Failure> {
        let (problem, mut numbers) = (&self.problem, Vec::new());
        self.layout.spread(&[p, extras].concat(), &mut numbers);
        let mut at = (usize::MAX, 0.0, Vec::new());
        self.at_nodes(extras, |segment, tau, out| {
            let (equations, q) = (f64::residual(&**problem), &numbers[self.layout.local(segment)]);
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

    pub(super) fn span(&self, segment: usize, interval: usize) -> Span {
        span(&self.meshes, segment, interval)
    }

    /// Writes typical sizes of the states of all segments, then of the extra unknowns, into
    /// `scales`; `scales` is empty if all sizes are 1.
    pub(super) fn unknown_scales(&self, q: &[f64], scales: &mut Vec<f64>) {
        let UnknownLayout { segments, extras, parameters, states, .. } = &*self.layout;
        scales.clear();
        let mut usual = true;
        for (s, segment) in segments.iter().enumerate() {
            let own = self.problem.scales(s, q);
            usual &= own.is_empty();
            scales.extend(own);
            scales.resize(segment.ends + segment.states, 1.0);
        }
        scales.extend(self.problem.extra_scales(&q[..*parameters]));
        scales.resize(states + extras, 1.0);
        if usual && scales[*states..].iter().all(|scale| *scale == 1.0) {
            scales.clear();
        }
    }

    /// Returns an interval of a segment, given the values at all nodes and the vectors `q` of all
    /// segments.
    pub(super) fn interval<'a, T>(
        &'a self,
        (segment, interval): (usize, usize),
        nodes: &'a [T],
        numbers: &'a [T],
    ) -> Interval<'a, T> {
        let nodes = &nodes[self.layout.interval(segment, interval)];
        self.alone((segment, interval), nodes, &numbers[self.layout.local(segment)])
    }

    /// Returns an interval of a segment, given the values at its nodes and the segment's vector
    /// `q`.
    pub(super) fn alone<'a, T>(
        &'a self,
        (segment, interval): (usize, usize),
        nodes: &'a [T],
        q: &'a [T],
    ) -> Interval<'a, T> {
        Interval { problem: &*self.problem, span: self.span(segment, interval), nodes, q }
    }

    /// Computes the left-hand sides of the boundary conditions; `ends` contains the states at the
    /// starts of all segments, then the states at the ends of all segments.
    pub(super) fn boundary<T: Number>(&self, ends: &[T], q: &[T], b: &mut [T]) {
        let (layout, problem) = (&self.layout, T::residual(&*self.problem));
        let (start, end) = ends.split_at(layout.states);
        let Some(forced) = layout.cycle else {
            return problem.boundary_in(Ends { start, end }, q, b);
        };
        let (p, extras) = q.split_at(layout.parameters);
        let (begin, durations) = extras.split_at(usize::from(forced));
        let mut time = begin.first().copied().unwrap_or_else(T::zero);
        for (s, (segment, duration)) in layout.segments.iter().zip(durations).enumerate() {
            let (next, x) = (layout.after(s), &end[segment.ends..segment.ends + segment.states]);
            let next = next.ends..next.ends + next.states;
            let times = (time, *duration);
            b[layout.states + s] = problem.segment_end_in(s, times, x, p, &mut b[next.clone()]);
            time += *duration;
            let starts = b[next.clone()].iter_mut().zip(&start[next]);
            starts.for_each(|(b, start)| *b = *start - *b);
        }
        if let (true, Some(last)) = (forced, b.last_mut()) {
            *last = durations.iter().fold(problem.cycle_in(p), |rest, l| rest - *l);
        }
    }

    /// Adds the contribution of an interval to the integral conditions.
    pub(super) fn integrals<T: Number>(
        &self,
        interval: Interval<T>,
        local: &mut Local<T>,
        sums: &mut [T],
    ) -> Result<(), Failure> {
        if sums.is_empty() {
            return Ok(());
        }
        let (segment, problem) = (interval.span.segment, T::residual(interval.problem));
        let Local { method, g, .. } = local;
        self.method.quadrature(interval, method, &mut |weight, t, x| {
            g.fill(T::zero());
            problem.integrand_in(segment, t, x, interval.q, g);
            sums.iter_mut().zip(&*g).for_each(|(sum, g)| *sum += weight * *g);
        })
    }

    /// Returns the duration of a segment for a vector `q` of parameters and extra unknowns.
    pub(super) fn duration_of<T: Number>(&self, segment: usize, q: &[T]) -> T {
        T::residual(&*self.problem).duration_in(segment, q)
    }

    /// Returns the total duration of the selected segments, from the vectors `q` of all segments.
    pub(super) fn duration<T: Number>(&self, numbers: &[T], counts: impl Fn(usize) -> bool) -> T {
        let all = self.meshes.iter().enumerate().filter(|(s, _)| counts(*s));
        let of = |(s, mesh): (usize, &Mesh)| {
            self.duration_of(s, &numbers[self.layout.local(s)]) * mesh.end()
        };
        all.map(of).fold(T::zero(), |sum, duration| sum + duration)
    }

    /// Computes the states of a segment of the solution loaded in `work`, at a time in units of the
    /// segment's duration.
    pub(super) fn value(
        &self,
        work: &mut Work<f64>,
        segment: usize,
        tau: f64,
        out: &mut [f64],
    ) -> Result<(), Failure> {
        let (interval, place) = self.meshes[segment].locate(tau);
        let interval = self.interval((segment, interval), &work.nodes, &work.numbers);
        self.method.value(interval, place, &mut work.local.method, out)
    }

    /// Collects the states at all nodes, and appends further values; the function `states` computes
    /// the states from the number of a segment and the time in units of the segment's duration.
    pub(super) fn at_nodes<E>(
        &self,
        others: &[f64],
        mut states: impl FnMut(usize, f64, &mut [f64]) -> Result<(), E>,
    ) -> Result<Vec<f64>, E> {
        let mut z = vec![0.0; self.layout.values()];
        for (s, j) in self.layout.intervals() {
            let (span, mut x) = (self.span(s, j), vec![0.0; self.layout.segments[s].states]);
            let nodes = self.layout.order[self.layout.interval(s, j)].chunks_exact(x.len());
            for (place, node) in self.method.places().iter().zip(nodes) {
                states(s, span.at(*place), &mut x)?;
                node.iter().zip(&x).for_each(|(&k, x)| z[k] = *x);
            }
        }
        z.extend_from_slice(others);
        Ok(z)
    }

    /// Transfers a solution `x = (z, p)` to the nodes of another discretisation.
    pub(super) fn carried(
        &self,
        onto: &DiscretisedProblem,
        x: &[f64],
    ) -> Result<Vec<f64>, Failure> {
        let mut work: Work<f64> = Work::new(&self.layout);
        work.load(&self.layout, |i| x[i]);
        let others = &x[self.layout.values()..];
        onto.at_nodes(others, |segment, tau, out| self.value(&mut work, segment, tau, out))
    }

    /// Returns the parts of a solution: the problem that the solution solves on meshes from 0 to 1,
    /// the trajectories (with the states at the starts of intervals), and the vector `q` of
    /// parameters and extra unknowns.
    pub(in crate::core) fn trajectories_of(&self, z: &[f64], p: &[f64]) -> Known {
        let (layout, mut numbers) = (&self.layout, Vec::new());
        let q = [p, &z[layout.values()..]].concat();
        layout.spread(&q, &mut numbers);
        let residual = f64::residual(&*self.problem);
        let trajectory = |(segment, s): (usize, &Segment)| {
            let states = |interval: usize| -> Vec<f64> {
                let node = &layout.order[layout.interval(segment, interval)][..s.states];
                node.iter().map(|&k| z[k]).collect()
            };
            let duration = residual.duration_in(segment, &numbers[layout.local(segment)]);
            let mut known = Trajectory::from(states(0));
            for interval in 1..s.intervals {
                let start = self.span(segment, interval).start;
                known.push(start * duration, &states(interval));
            }
            known
        };
        let trajectories = layout.segments.iter().enumerate().map(trajectory).collect();
        let end = self.meshes[0].end();
        let itineraries = self.problem.itineraries().filter(|_| end != 1.0);
        let spanning = itineraries.and_then(|itineraries| itineraries.spanning(end, &q));
        let (problem, q) = spanning.unwrap_or_else(|| (self.problem.clone(), q));
        Known { problem, trajectories, q }
    }

    /// Computes a derivative with an allowed relative error, or exactly if exact gradients are required.
    pub(super) fn allowing<R>(&mut self, allowed: f64, compute: impl FnOnce(&mut Self) -> R) -> R {
        self.method.allow(if self.exact_gradients { 0.0 } else { allowed });
        let outcome = compute(self);
        self.method.allow(0.0);
        outcome
    }

    /// Returns an error if an entry of the residual is not finite.
    pub(super) fn check(&self, residual: &[f64], q: &[f64]) -> Result<(), Failure> {
        match not_finite(residual) {
            Some(row) => Err(self.refusal(row, residual[row], q)),
            None => Ok(()),
        }
    }

    /// Creates the error for an equation whose value or derivative is not finite.
    pub(super) fn refusal(&self, row: usize, value: f64, q: &[f64]) -> Failure {
        let layout = &self.layout;
        if let Some(condition) = row.checked_sub(layout.conditions()) {
            let (what, k) = match condition.checked_sub(layout.boundary) {
                None => ("boundary condition", condition),
                Some(k) if k < layout.integrals => ("integral condition", k),
                Some(k) => ("phase condition", k - layout.integrals),
            };
            let remedy = "the conditions of the boundary-value problem and their derivatives must \
                          be finite";
            return Failure::not_finite(format!("{what} {k}, counted from 0,"), value, remedy);
        }
        let s = layout.segments.iter().rposition(|s| s.equations <= row).unwrap_or(0);
        let segment = &layout.segments[s];
        let inside = row - segment.equations;
        let span = self.span(s, inside / (layout.degree * segment.states));
        let mut numbers = Vec::new();
        layout.spread(q, &mut numbers);
        let t = span.start * self.duration_of(s, &numbers[layout.local(s)]);
        placed(self.not_finite(s, inside % segment.states, value), s, t)
    }

    /// Creates the error for the equation of one state on a segment.
    pub(super) fn not_finite(&self, segment: usize, state: usize, value: f64) -> Failure {
        let names = self.problem.segments().swap_remove(segment);
        let name = names.get(state).map_or("", String::as_str);
        Failure::not_finite(
            format!("the equation of {name}"),
            value,
            "the vector field must be finite and differentiable; end the branch before the field \
             becomes undefined",
        )
    }
}
