//! The equations of a boundary-value problem on its meshes, in any scalar type.

use super::extremes::Extremes;
use super::layout::{Layout, span};
use crate::core::bvp::interval::placed;
use crate::core::bvp::method::MethodWork;
use crate::core::bvp::{
    BoundaryError, Ends, Equations, Interval, Legs, Mesh, Method, Monitor, Number, Span,
};
use crate::core::failure::{Failure, not_finite};
use crate::core::interpolation::{highest_derivative, node_weights};
use crate::core::scalar::Scalar;
use crate::core::scalar_field::FieldIn;
use std::sync::Arc;

/// A problem, how it is discretised, and the reference of its phase condition.
pub(super) struct Discretised {
    pub problem: Arc<dyn Equations>,
    pub method: Method,
    pub meshes: Vec<Mesh>,
    pub layout: Arc<Layout>,
    pub phase: Phase,
    pub monitors: Vec<Monitor>,
    pub extremes: Extremes,
    pub estimated: Estimated,
    /// Whether a solution is only approached, so that the equations may err.
    pub rough: bool,
    /// The weights of the values at the nodes in the `m`-th derivative.
    pub highest: Vec<f64>,
    /// Positions in `z`, kept so that nothing is allocated twice.
    pub positions: Vec<usize>,
}

/// The phase condition `Σ_k w_k ⟨ẋ_k, x_k − x̂_k⟩ = 0`, with a reference `x̂` and the quadrature
/// weights `w` of the nodes. Without a reference, it has none yet.
#[derive(Clone, Debug, Default)]
pub(super) struct Phase {
    /// The reference, as `x = (z, p)`; empty before it is set.
    pub reference: Vec<f64>,
    /// `w_k ẋ_k`, node by node.
    pub row: Vec<f64>,
}

/// Where the estimated error of a state, in units of the state's largest value, is largest.
#[derive(Clone, Copy)]
pub(super) struct LargestError {
    pub segment: usize,
    pub state: usize,
    pub interval: usize,
    pub error: f64,
}

/// The error estimated last, for those who ask again.
#[derive(Default)]
pub(super) struct Estimated {
    /// The values at the nodes and the numbers for which it was; empty if for none.
    pub at: Vec<f64>,
    pub largest: Option<LargestError>,
}

/// Arguments and residual in one scalar type, kept so that nothing is allocated twice.
pub(super) struct Work<T: Scalar> {
    /// Values at the nodes of all segments, node by node.
    pub nodes: Vec<T>,
    /// `q = (p, e)`.
    pub q: Vec<T>,
    /// The numbers of all segments.
    pub numbers: Vec<T>,
    pub r: Vec<T>,
    pub ends: Vec<T>,
    pub local: Local<T>,
}

/// Buffers for what happens in an interval.
pub(super) struct Local<T: Scalar> {
    pub method: MethodWork<T>,
    pub x: Vec<T>,
    g: Vec<T>,
}

impl<T: Scalar> Local<T> {
    pub fn new(layout: &Layout) -> Self {
        let most = layout.segments.iter().map(|s| s.states).max().unwrap_or(0);
        let (x, g) = (vec![T::zero(); most], vec![T::zero(); layout.integrals]);
        Local { method: Default::default(), x, g }
    }
}

impl<T: Scalar> Work<T> {
    pub fn new(layout: &Layout) -> Self {
        let zeros = |length: usize| vec![T::zero(); length];
        Work {
            nodes: zeros(layout.values()),
            q: zeros(layout.numbers()),
            numbers: Vec::new(),
            r: zeros(layout.dimension),
            ends: zeros(2 * layout.states),
            local: Local::new(layout),
        }
    }

    /// Takes arguments, given for each component of `x = (z, p)`.
    pub fn load(&mut self, layout: &Layout, argument: impl Fn(usize) -> T) {
        self.nodes.iter_mut().zip(&layout.order).for_each(|(node, &z)| *node = argument(z));
        for (k, q) in self.q.iter_mut().enumerate() {
            *q = argument(layout.number(k));
        }
        layout.spread(&self.q, &mut self.numbers);
    }
}

impl Discretised {
    pub fn new(
        problem: Arc<dyn Equations>,
        method: Method,
        meshes: Vec<Mesh>,
    ) -> Result<Self, BoundaryError> {
        let layout = Arc::new(Layout::new(&*problem, &method, &meshes)?);
        let monitors: Vec<Monitor> =
            problem.monitors().into_iter().map(|(_, monitor)| monitor).collect();
        Ok(Discretised {
            phase: Phase::default(),
            extremes: Extremes::of(&monitors, &layout),
            estimated: Estimated::default(),
            rough: false,
            monitors,
            highest: highest_derivative(method.places()),
            positions: Vec::new(),
            problem,
            method,
            meshes,
            layout,
        })
    }

    pub fn span(&self, segment: usize, interval: usize) -> Span {
        span(&self.meshes, segment, interval)
    }

    /// Typical sizes of the states of all segments, then of the extras; empty if all are 1.
    pub fn unknown_scales(&self, q: &[f64]) -> Vec<f64> {
        let Layout { segments, extras, parameters, .. } = &*self.layout;
        let (extra, mut scales) = (self.problem.extra_scale(&q[..*parameters]), Vec::new());
        let of_segment = |s: usize| self.problem.scales_of(s, q);
        if extra == 1.0 && (0..segments.len()).all(|s| of_segment(s).is_empty()) {
            return scales;
        }
        for (s, segment) in segments.iter().enumerate() {
            scales.extend(of_segment(s));
            scales.resize(segment.ends + segment.states, 1.0);
        }
        scales.resize(scales.len() + extras, extra);
        scales
    }

    /// An interval of a segment, from the values at all nodes and the numbers of all segments.
    pub fn interval<'a, T>(
        &'a self,
        (segment, interval): (usize, usize),
        nodes: &'a [T],
        numbers: &'a [T],
    ) -> Interval<'a, T> {
        let nodes = &nodes[self.layout.interval(segment, interval)];
        self.alone((segment, interval), nodes, &numbers[self.layout.local(segment)])
    }

    /// An interval of a segment with values at its nodes, and the segment's numbers.
    pub fn alone<'a, T>(
        &'a self,
        (segment, interval): (usize, usize),
        nodes: &'a [T],
        q: &'a [T],
    ) -> Interval<'a, T> {
        Interval { problem: &*self.problem, span: self.span(segment, interval), nodes, q }
    }

    /// All left sides at the arguments of `work`, into its `r`.
    pub fn residual<T: Number>(&self, work: &mut Work<T>) -> Result<(), Failure> {
        self.residual_inside(work)?;
        self.residual_beside(work)
    }

    /// The same in real numbers, with the extremes that monitors will ask for where they come with
    /// it.
    pub fn residual_watching(&mut self, work: &mut Work<f64>) -> Result<(), Failure> {
        if self.method.watches_with_residual() {
            self.find_extremes(&work.nodes, (&work.q, &work.numbers), Some(&mut work.r))?;
        } else {
            self.residual_inside(work)?;
        }
        self.residual_beside(work)
    }

    /// Left sides of the equations of all intervals.
    fn residual_inside<T: Number>(&self, work: &mut Work<T>) -> Result<(), Failure> {
        let Work { nodes, numbers, r, local, .. } = work;
        for (s, j) in self.layout.intervals() {
            let interval = self.interval((s, j), nodes, numbers);
            let r = &mut r[self.layout.equations(s, j)];
            self.method.residual(interval, &mut local.method, r)?;
        }
        Ok(())
    }

    /// Left sides of boundary, integral and phase conditions.
    fn residual_beside<T: Number>(&self, work: &mut Work<T>) -> Result<(), Failure> {
        let layout = &self.layout;
        let conditions = &mut work.r[layout.conditions()..];
        let (boundary, closing) = conditions.split_at_mut(layout.boundary);
        gather_ends(layout, &work.nodes, &mut work.ends);
        self.boundary(&work.ends, &work.q, boundary);
        closing.fill(T::zero());
        for (s, j) in layout.intervals() {
            let interval = self.interval((s, j), &work.nodes, &work.numbers);
            self.integrals(interval, &mut work.local, &mut closing[..layout.integrals])?;
        }
        if layout.phase {
            closing[layout.integrals] = self.phase(&work.nodes);
        }
        Ok(())
    }

    /// The left sides of the boundary conditions; `ends` holds the states where all segments begin,
    /// then those where they end.
    pub fn boundary<T: Number>(&self, ends: &[T], q: &[T], b: &mut [T]) {
        let (layout, problem) = (&self.layout, T::residual(&*self.problem));
        let (start, end) = ends.split_at(layout.states);
        let Some(Legs { forced }) = layout.legs else {
            return problem.boundary_in(Ends { start, end }, q, b);
        };
        let (p, extras) = q.split_at(layout.parameters);
        let (begin, durations) = extras.split_at(usize::from(forced));
        let mut time = begin.first().copied().unwrap_or_else(T::zero);
        for (s, (leg, duration)) in layout.segments.iter().zip(durations).enumerate() {
            let (next, x) = (layout.after(s), &end[leg.ends..leg.ends + leg.states]);
            let next = next.ends..next.ends + next.states;
            let times = (time, *duration);
            b[layout.states + s] = problem.leg_end_in(s, times, x, p, &mut b[next.clone()]);
            time += *duration;
            let starts = b[next.clone()].iter_mut().zip(&start[next]);
            starts.for_each(|(b, start)| *b = *start - *b);
        }
        if let (true, Some(last)) = (forced, b.last_mut()) {
            *last = durations.iter().fold(problem.cycle_in(p), |rest, l| rest - *l);
        }
    }

    /// Adds an interval's share of the integral conditions.
    pub fn integrals<T: Number>(
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

    /// The duration of a segment with the numbers `q`.
    pub fn duration_of(&self, segment: usize, q: &[f64]) -> f64 {
        f64::residual(&*self.problem).duration_in(segment, q)
    }

    /// The left side of the phase condition.
    pub fn phase<T: Scalar>(&self, nodes: &[T]) -> T {
        let mut sum = T::zero();
        for ((row, x), &z) in self.phase.row.iter().zip(nodes).zip(&self.layout.order) {
            sum += (*x - self.phase.reference[z]) * *row;
        }
        sum
    }

    /// Makes `x = (z, p)` the reference of the phase condition.
    pub fn set_reference(&mut self, x: &[f64], work: &mut Work<f64>) -> Result<(), Failure> {
        if !self.layout.phase {
            return Ok(());
        }
        work.load(&self.layout, |i| x[i]);
        let motion = self.motion(work)?;
        self.set_reference_with_motion(x, &motion);
        Ok(())
    }

    /// `dx/dτ` at all nodes, ordered as `z`, at the arguments of `work`.
    fn motion(&self, work: &mut Work<f64>) -> Result<Vec<f64>, Failure> {
        let (layout, places) = (&self.layout, self.method.places());
        let mut motion = vec![0.0; layout.values()];
        for (s, j) in layout.intervals() {
            let (span, n) = (self.span(s, j), layout.segments[s].states);
            let q = &work.numbers[layout.local(s)];
            let duration = self.duration_of(s, q);
            let field = f64::residual(&*self.problem).on_segment(s, q);
            let f = &mut work.local.x[..n];
            let nodes = layout.interval(s, j);
            let values = work.nodes[nodes.clone()].chunks_exact(n);
            for ((place, x), order) in
                places.iter().zip(values).zip(layout.order[nodes].chunks_exact(n))
            {
                let t = duration * span.at(*place);
                field.domain(x, q).map_err(|cause| placed(cause, s, t))?;
                field.slope(t, x, q, f);
                if let Some(i) = not_finite(f) {
                    return Err(placed(self.not_finite(s, i, f[i]), s, t));
                }
                order.iter().zip(f.iter()).for_each(|(&z, f)| motion[z] = duration * f);
            }
        }
        Ok(motion)
    }

    /// Makes `x = (z, p)` the reference of the phase condition, with a motion (ordered as `z`) that
    /// may be another than its own.
    pub fn set_reference_with_motion(&mut self, x: &[f64], motion: &[f64]) {
        let layout = &self.layout;
        let weights = node_weights(self.method.places());
        let mut row = vec![0.0; layout.values()];
        for (s, j) in layout.intervals() {
            let (span, n) = (self.span(s, j), layout.segments[s].states);
            let (h, nodes) = (span.end - span.start, layout.interval(s, j));
            let rows = row[nodes.clone()].chunks_exact_mut(n);
            for ((row, order), weight) in
                rows.zip(layout.order[nodes].chunks_exact(n)).zip(&weights)
            {
                row.iter_mut().zip(order).for_each(|(r, &z)| *r += h * weight * motion[z]);
            }
        }
        // The condition may be multiplied by −1. Its sign is kept, for that of the determinant
        // tells branch points.
        let along: f64 = row.iter().zip(&self.phase.row).map(|(new, old)| new * old).sum();
        if along < 0.0 {
            row.iter_mut().for_each(|r| *r = -*r);
        }
        self.phase.row = row;
        x.clone_into(&mut self.phase.reference);
    }

    /// Refuses a residual that is not finite.
    pub fn check(&self, residual: &[f64], q: &[f64]) -> Result<(), Failure> {
        match not_finite(residual) {
            Some(row) => Err(self.refusal(row, residual[row], q)),
            None => Ok(()),
        }
    }

    /// The refusal of an equation that is not finite, or has a derivative that is not.
    pub fn refusal(&self, row: usize, value: f64, q: &[f64]) -> Failure {
        let layout = &self.layout;
        if let Some(condition) = row.checked_sub(layout.conditions()) {
            let (what, k) = match condition.checked_sub(layout.boundary) {
                None => ("boundary condition", condition),
                Some(k) if k < layout.integrals => ("integral condition", k),
                Some(k) => ("phase condition", k - layout.integrals),
            };
            let remedy = "conditions and their derivatives must be finite";
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

    fn not_finite(&self, segment: usize, state: usize, value: f64) -> Failure {
        let names = self.problem.segments().swap_remove(segment);
        let name = names.get(state).map_or("", String::as_str);
        Failure::not_finite(
            format!("the equation of {name}"),
            value,
            "the field must be finite and differentiable; bound the branch before it loses its meaning",
        )
    }
}

/// States where all segments begin, then those where they end.
pub(super) fn gather_ends<T: Scalar>(layout: &Layout, nodes: &[T], ends: &mut [T]) {
    let (start, end) = ends.split_at_mut(layout.states);
    for s in &layout.segments {
        let place = s.ends..s.ends + s.states;
        let last = s.values + (s.nodes - 1) * s.states;
        start[place.clone()].copy_from_slice(&nodes[s.values..s.values + s.states]);
        end[place].copy_from_slice(&nodes[last..last + s.states]);
    }
}
