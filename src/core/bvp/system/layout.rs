//! The layout of the unknowns and equations of a boundary-value problem.

use crate::core::bvp::erased::Equations;
use crate::core::bvp::error::BoundaryError;
use crate::core::bvp::interval::Span;
use crate::core::bvp::mesh::Mesh;
use crate::core::bvp::method::Method;
use crate::core::bvp::terms::{Return, Shape, Unknown, Watched};
use crate::core::scalar::Scalar;

/// The positions of one segment's unknowns and equations.
#[derive(Clone, Debug)]
pub(super) struct Segment {
    /// The number `n` of states.
    pub states: usize,
    /// The number `N` of intervals.
    pub intervals: usize,
    /// The number `K = N·m + 1` of nodes.
    pub nodes: usize,
    /// The position of the segment's first value; values are ordered state by state in `z`, and
    /// node by node in `nodes`.
    pub values: usize,
    /// The position of the first of the segment's `N·m·n` equations, which are ordered interval by
    /// interval.
    pub equations: usize,
    /// The position of the segment's states among the states of all segments.
    pub ends: usize,
}

/// The positions of all unknowns and equations of a boundary-value problem.
///
/// The unknowns `z` are the values at the nodes, ordered by segment, state and node, followed by
/// the extra unknowns. The equations are the interval equations, segment by segment, then the
/// boundary conditions, the integral conditions, and the phase condition.
#[derive(Clone, Debug, Default)]
pub(super) struct UnknownLayout {
    /// The number `m` of nodes beyond the first in each interval.
    pub degree: usize,
    pub segments: Vec<Segment>,
    /// The total number of states of all segments.
    pub states: usize,
    pub parameters: usize,
    pub extras: usize,
    /// The numbers of boundary and integral conditions.
    pub boundary: usize,
    pub integrals: usize,
    pub phase: bool,
    /// For segments of a cycle, whether the start time of the cycle is an unknown; `None` for
    /// problems of another shape.
    pub cycle: Option<bool>,
    /// The return conditions, which connect each period to the next period.
    pub returns: Vec<Return>,
    /// The shape of solutions, which determines the meaning of each boundary condition.
    pub shape: Shape,
    /// The number of unknowns, which equals the number of equations.
    pub dimension: usize,
    /// The position in `z` of each value at a node, node by node.
    pub order: Vec<usize>,
    /// The positions in `z` of the states at the starts of all segments, then at the ends of all
    /// segments.
    pub ends: Vec<usize>,
}

impl UnknownLayout {
    pub fn new(
        problem: &dyn Equations,
        method: &Method,
        meshes: &[Mesh],
    ) -> Result<Self, BoundaryError> {
        let names = problem.segments();
        if names.is_empty() || names.len() != meshes.len() {
            return Err(BoundaryError::Meshes { segments: names.len(), meshes: meshes.len() });
        }
        let degree = method.places().len() - 1;
        let (mut segments, mut values, mut equations, mut ends) = (Vec::new(), 0, 0, 0);
        for (segment, (states, mesh)) in names.iter().zip(meshes).enumerate() {
            let (states, intervals) = (states.len(), mesh.intervals());
            if states == 0 {
                return Err(BoundaryError::NoStates(segment));
            }
            let nodes = intervals * degree + 1;
            segments.push(Segment { states, intervals, nodes, values, equations, ends });
            values += nodes * states;
            equations += intervals * degree * states;
            ends += states;
        }
        let (extras, integrals) = (problem.extras().len(), problem.integrals());
        let shape = problem.shape();
        let phase = shape.phase();
        let closing = integrals + usize::from(phase);
        let mut layout = UnknownLayout {
            degree,
            segments,
            states: ends,
            parameters: problem.parameters().len(),
            extras,
            boundary: (ends + extras)
                .checked_sub(closing)
                .ok_or(BoundaryError::Conditions { unknowns: ends + extras, closing })?,
            integrals,
            phase,
            cycle: shape.cycle(),
            returns: shape.returns(&names.iter().map(Vec::len).collect::<Vec<_>>()),
            shape,
            dimension: values + extras,
            order: Vec::new(),
            ends: Vec::new(),
        };
        layout.check(problem)?;
        layout.tabulate();
        Ok(layout)
    }

    fn check(&self, problem: &dyn Equations) -> Result<(), BoundaryError> {
        self.check_shape()?;
        for (name, monitor) in problem.monitors() {
            for &Watched { segment, observable, .. } in monitor.watched() {
                let states = self.segments.get(segment).map_or(0, |s| s.states);
                let state = observable.state().unwrap_or(0);
                if state >= states {
                    return Err(BoundaryError::Monitor { name, segment, state });
                }
            }
        }
        Ok(())
    }

    /// Checks that the segments and conditions of a periodic problem match its shape.
    fn check_shape(&self) -> Result<(), BoundaryError> {
        let one = self.segments.len() == 1 && self.boundary == self.states && self.integrals == 0;
        let fits = match self.shape {
            Shape::BoundaryValues => true,
            Shape::Periodic { .. } => one,
            Shape::Cycle { .. } | Shape::MapCycle => self.closing() == 0,
        };
        if fits {
            return Ok(());
        }
        let (shape, segments, closing) = (self.shape, self.segments.len(), self.closing());
        Err(BoundaryError::Shape { shape, segments, boundary: self.boundary, closing })
    }

    /// Whether the problem consists of one segment with exactly the boundary conditions `x(0) −
    /// x(1) = 0`.
    pub fn closes(&self) -> bool {
        matches!(self.shape, Shape::Periodic { .. })
    }

    /// Whether solutions are periodic.
    pub fn is_periodic(&self) -> bool {
        !self.returns.is_empty()
    }

    /// Returns the position in `z` of an unknown.
    pub fn position(&self, unknown: Unknown) -> usize {
        match unknown {
            Unknown::Start(i) => self.ends[i],
            Unknown::Extra(e) => self.values() + e,
        }
    }

    /// Whether the segments form a cycle whose start time is unknown.
    pub fn forced(&self) -> bool {
        self.cycle == Some(true)
    }

    /// Returns the number of entries of a segment's vector `q` that are not parameters: start time
    /// and duration in a cycle, otherwise the extra unknowns.
    pub fn own(&self) -> usize {
        if self.cycle.is_some() { 2 } else { self.extras }
    }

    /// Returns the range of a segment's vector `q` in the list that [`spread`](Self::spread)
    /// writes.
    pub fn local(&self, segment: usize) -> std::ops::Range<usize> {
        let (width, k) = (self.parameters + self.own(), self.cycle.map_or(0, |_| segment));
        k * width..(k + 1) * width
    }

    /// Computes the vectors `q` of all segments from the vector `q = (p, e)` of the problem.
    pub fn spread<T: Scalar>(&self, q: &[T], out: &mut Vec<T>) {
        out.clear();
        let Some(forced) = self.cycle else { return out.extend_from_slice(q) };
        let (p, extras) = q.split_at(self.parameters);
        let (start, durations) = extras.split_at(usize::from(forced));
        let mut time = start.first().copied().unwrap_or_else(T::zero);
        for duration in durations {
            out.extend_from_slice(p);
            out.extend([time, *duration]);
            time += *duration;
        }
    }

    /// Appends the vector `q` of a segment, from `x = (z, p)`.
    pub fn numbers_of(&self, segment: usize, x: &[f64], out: &mut Vec<f64>) {
        let (q, p) = (|k: usize| x[self.number(k)], self.parameters);
        let Some(forced) = self.cycle else {
            return out.extend((0..self.numbers()).map(q));
        };
        let duration = p + usize::from(forced) + segment;
        out.extend((0..p).map(q).chain([(p..duration).map(q).sum(), q(duration)]));
    }

    /// Adds the derivative with respect to an entry of a segment's vector `q` to a gradient of the
    /// same length as `x`.
    pub fn scatter(&self, segment: usize, number: usize, slope: f64, out: &mut [f64]) {
        let Some((forced, own)) = self.cycle.zip(number.checked_sub(self.parameters)) else {
            out[self.number(number)] += slope;
            return;
        };
        let (extras, duration) = (&mut out[self.values()..], usize::from(forced) + segment);
        match own {
            0 => extras[..duration].iter_mut().for_each(|extra| *extra += slope),
            _ => extras[duration] += slope,
        }
    }

    /// Returns the index of the condition for one initial state of the segment after `segment`; the
    /// index that follows the last initial state belongs to the event condition.
    pub fn joint(&self, segment: usize, i: usize) -> usize {
        let next = self.after(segment);
        self.conditions() + if i < next.states { next.ends + i } else { self.states + segment }
    }

    /// Returns the index of the segment after `segment`.
    pub fn after(&self, segment: usize) -> &Segment {
        &self.segments[(segment + 1) % self.segments.len()]
    }

    /// The unknowns and equations that remain after the interior of each segment is eliminated.
    pub fn rest(&self) -> Rest {
        if self.cycle.is_some() {
            let most = self.segments.iter().map(|s| s.states).max().unwrap_or(0);
            return Rest { states: most + 1, boundary: most + 1, extras: 0 };
        }
        Rest { states: self.states, boundary: self.boundary, extras: self.extras }
    }

    /// Returns the row and the column of a return condition in the dense matrix.
    pub fn place(&self, of: &Return) -> (usize, usize) {
        let Rest { states, .. } = self.rest();
        match (of.unknown, self.cycle) {
            (Unknown::Start(i), None) => (states + of.condition, i),
            (Unknown::Extra(e), None) => (states + of.condition, 2 * states + e),
            (Unknown::Start(i), Some(_)) => (states + i, i),
            (Unknown::Extra(_), Some(_)) => (2 * states - 1, states - 1),
        }
    }

    fn tabulate(&mut self) {
        for s in &self.segments {
            let at = |k: usize, i: usize| s.values + i * s.nodes + k;
            self.order.extend((0..s.nodes).flat_map(|k| (0..s.states).map(move |i| at(k, i))));
        }
        for last in [false, true] {
            for s in &self.segments {
                let node = if last { s.nodes - 1 } else { 0 };
                self.ends.extend((0..s.states).map(|i| s.values + i * s.nodes + node));
            }
        }
    }

    /// Returns the number of values at nodes, which precede the extra unknowns in `z`.
    pub fn values(&self) -> usize {
        self.dimension - self.extras
    }

    /// Returns the length of `q = (p, e)`.
    pub fn numbers(&self) -> usize {
        self.parameters + self.extras
    }

    /// Returns the position in `x` of a component of `q = (p, e)`.
    pub fn number(&self, k: usize) -> usize {
        if k < self.parameters { self.dimension + k } else { self.values() + k - self.parameters }
    }

    /// Returns the position of the first boundary condition among the equations.
    pub fn conditions(&self) -> usize {
        self.dimension - self.boundary - self.closing()
    }

    /// Returns the number of integral and phase conditions.
    pub fn closing(&self) -> usize {
        self.integrals + usize::from(self.phase)
    }

    /// Returns the range of an interval's values among the values at all nodes.
    pub fn interval(&self, segment: usize, interval: usize) -> std::ops::Range<usize> {
        let s = &self.segments[segment];
        let start = s.values + interval * self.degree * s.states;
        start..start + (self.degree + 1) * s.states
    }

    /// Returns the range of an interval's equations among all equations.
    pub fn equations(&self, segment: usize, interval: usize) -> std::ops::Range<usize> {
        let s = &self.segments[segment];
        let count = self.degree * s.states;
        let start = s.equations + interval * count;
        start..start + count
    }

    /// Returns all intervals; each is given by its segment and by its number in this segment.
    pub fn intervals(&self) -> impl Iterator<Item = (usize, usize)> + '_ {
        let segments = self.segments.iter().enumerate();
        segments.flat_map(|(s, segment)| (0..segment.intervals).map(move |j| (s, j)))
    }
}

/// Returns the size of the dense matrix that remains: its unknowns are the states at both ends of
/// segments, and its equations are the conditions.
#[derive(Clone, Copy)]
pub(super) struct Rest {
    pub states: usize,
    pub boundary: usize,
    pub extras: usize,
}

/// An interval of a segment's mesh, given by its indices.
pub(super) fn span(meshes: &[Mesh], segment: usize, interval: usize) -> Span {
    let points = meshes[segment].points();
    Span { segment, start: points[interval], end: points[interval + 1] }
}
