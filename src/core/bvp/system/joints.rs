//! The transitions between the segments of a cycle: conditions that depend only on the end of a
//! segment.
//!
//! The derivatives of a segment's conditions are taken with respect to the states at its end and to
//! its vector `q`: one row for each initial state of the next segment (the negative derivative of
//! the event map), then the row of the event condition. The rows of all segments follow one
//! another; the last row contains the derivatives, with respect to `q`, of the condition on the
//! cycle's duration.

use super::assembly::AssembledJacobian;
use super::discretisation::DiscretisedProblem;
use super::layout::UnknownLayout;
use super::local::{Arguments, Dependence, Passes, Weighted};
use super::work::{Work, gather_ends};
use crate::core::bvp::erased::Number;
use crate::core::bvp::interval::weighted as summed;
use crate::core::failure::Failure;
use crate::core::scalar::{CHUNK, Chunk, Directional};

/// The arguments of the conditions at the end of a segment: the states there, and the entries of
/// `q` on which the conditions depend.
fn dependence<'a>(
    layout: &'a UnknownLayout,
    segment: usize,
    numbers: &'a [usize],
) -> Dependence<'a> {
    let s = &layout.segments[segment];
    let unknowns = &layout.ends[layout.states + s.ends..][..s.states];
    Dependence { unknowns, segment: Some(segment), numbers }
}

/// Computes the next segment's initial state and the function that vanishes at the event, at the
/// arguments given by [`dependence`].
fn joint<'a, T: Number>(
    equations: &DiscretisedProblem,
    segment: usize,
    Passes { unknowns, q, r, .. }: &'a mut Passes<T>,
) -> &'a [T] {
    let (p, own) = q.split_at(equations.layout.parameters);
    let (problem, next) =
        (T::residual(&*equations.problem), equations.layout.after(segment).states);
    let (after, rest) = r.split_at_mut(next);
    rest[0] = problem.segment_end_in(segment, (own[0], own[1]), unknowns, p, after);
    &r[..=next]
}

/// Adds the contribution of all transition conditions to a gradient.
pub(super) fn add_gradient_of_joints<T: Directional + Number>(
    equations: &DiscretisedProblem,
    &Weighted { at, w, numbers }: &Weighted,
    passes: &mut Passes<T>,
    out: &mut [f64],
) -> Result<(), Failure> {
    let layout = &equations.layout;
    for segment in 0..layout.segments.len() {
        let dependence = dependence(layout, segment, &numbers.local);
        passes.add_gradient(layout, dependence, at, out, |passes| {
            let values = joint(equations, segment, passes);
            let (event, after) = (values.len() - 1, layout.joint(segment, 0));
            let sum = values[event] * w[layout.joint(segment, event)];
            Ok(*(sum - summed(&values[..event], &w[after..])).derivative())
        })?;
    }
    if !layout.forced() {
        return Ok(());
    }
    let cycle = Dependence { unknowns: &[], segment: Some(0), numbers: &numbers.local };
    passes.add_gradient(layout, cycle, at, out, |passes| {
        let p = &passes.q[..layout.parameters];
        Ok(*(T::residual(&*equations.problem).cycle_in(p) * w[layout.dimension - 1]).derivative())
    })
}

impl AssembledJacobian {
    /// Returns the position of the first derivative that belongs to a segment's conditions.
    fn joint_rows(&self, layout: &UnknownLayout, segment: usize) -> usize {
        let length = |s: usize| self.joint_width(layout, s) * (layout.after(s).states + 1);
        (0..segment).map(length).sum()
    }

    /// Returns the length of a row: the number of arguments of a segment's conditions.
    pub fn joint_width(&self, layout: &UnknownLayout, segment: usize) -> usize {
        layout.segments[segment].states + self.active.len()
    }

    /// Returns the rows of each segment.
    pub fn joints<'a>(
        &'a self,
        layout: &'a UnknownLayout,
    ) -> impl Iterator<Item = (usize, &'a [f64])> {
        let mut rest = &self.boundary[..];
        (0..layout.segments.len()).map(move |segment| {
            let length = self.joint_width(layout, segment) * (layout.after(segment).states + 1);
            let (rows, after) = rest.split_at(length);
            rest = after;
            (segment, rows)
        })
    }

    /// Computes the residual and the derivatives of all transition conditions.
    pub fn assemble_joints(
        &mut self,
        equations: &DiscretisedProblem,
        x: &[f64],
        work: &Work<f64>,
        passes: &mut Passes<Chunk>,
    ) {
        let (layout, active) = (&equations.layout, self.active.len());
        let segments = layout.segments.len();
        let length = self.joint_rows(layout, segments);
        self.boundary.resize(length + active, 0.0);
        self.ends.resize(2 * layout.states, 0.0);
        gather_ends(layout, &work.nodes, &mut self.ends);
        equations.boundary(&self.ends, &work.q, &mut self.residual[layout.conditions()..]);
        let mut first = 0;
        for segment in 0..segments {
            let dependence = dependence(layout, segment, &self.active);
            let width = dependence.len();
            for start in (0..width).step_by(CHUNK) {
                passes.load(layout, dependence, start, Arguments::plain(x));
                let values = joint(equations, segment, passes);
                for (i, value) in values.iter().enumerate() {
                    let sign = if i + 1 < values.len() { -1.0 } else { 1.0 };
                    let row = &mut self.boundary[first + i * width..][..width];
                    let entries = row[start..].iter_mut().zip(value.eps);
                    entries.for_each(|(entry, slope)| *entry = sign * slope);
                }
            }
            first += width * (layout.after(segment).states + 1);
        }
        for start in (0..active).step_by(CHUNK) {
            let cycle = Dependence { unknowns: &[], segment: Some(0), numbers: &self.active };
            passes.load(layout, cycle, start, Arguments::plain(x));
            let value =
                Chunk::residual(&*equations.problem).cycle_in(&passes.q[..layout.parameters]);
            let entries = self.boundary[first + start..].iter_mut().zip(value.eps);
            entries.for_each(|(entry, slope)| *entry = slope);
        }
    }

    /// Writes the derivative of all conditions with respect to an active parameter, which is the
    /// `k`-th active entry of `q`.
    pub fn joint_column(&self, layout: &UnknownLayout, k: usize, out: &mut [f64]) {
        for (segment, rows) in self.joints(layout) {
            let n = layout.segments[segment].states;
            for (i, row) in rows.chunks_exact(self.joint_width(layout, segment)).enumerate() {
                out[layout.joint(segment, i)] = row[n + k];
            }
        }
        if layout.forced() {
            out[layout.dimension - 1] = self.boundary[self.boundary.len() - self.active.len() + k];
        }
    }
}
