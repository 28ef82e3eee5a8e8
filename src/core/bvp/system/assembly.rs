//! The assembled Jacobian in parts: interval equations, boundary conditions, and rows of integral
//! and phase conditions.

use super::discretisation::DiscretisedProblem;
use super::layout::{UnknownLayout, span};
use super::local::{Arguments, Dependence, Passes};
use super::monitors::Monitors;
use super::phase::Phase;
use super::sparse_orbit::Structure;
use super::work::Work;
use crate::core::bvp::interval::{Block, Interval, MonitoredFunctions};
use crate::core::cancel::CancelToken;
use crate::core::failure::{Failure, not_finite};
use crate::core::linalg::Border;
use crate::core::scalar::{CHUNK, Chunk};

/// The Jacobian and the residual at the point that was assembled last.
#[derive(Clone, Default)]
pub(super) struct AssembledJacobian {
    /// The residual, in the order of the equations.
    pub residual: Vec<f64>,
    /// The derivatives of the interval equations with respect to the values at nodes: for each
    /// interval of a segment, `m·n` rows of `(m + 1)·n` entries; empty for sparse equations.
    pub blocks: Vec<Vec<f64>>,
    /// How the derivatives with respect to the values at nodes are stored: in `blocks`, or as sparse
    /// matrices.
    pub structure: Structure,
    /// The derivatives of the interval equations with respect to the active entries of `q`: for
    /// each segment, one row for each equation of its intervals.
    pub numbers: Vec<Vec<f64>>,
    /// The derivatives of the boundary conditions, one row for each condition: first with respect
    /// to the states at the starts of all segments, then to the states at the ends, then to the
    /// active entries of `q`. The derivatives of the conditions that connect the segments of cycles
    /// are in [`joints`](super::joints).
    pub boundary: Vec<f64>,
    /// The derivatives of the integral conditions and the phase condition with respect to all
    /// values at nodes, node by node.
    pub closing: Vec<f64>,
    /// The derivatives of the integral conditions and the phase condition with respect to the
    /// active entries of `q`.
    pub closing_numbers: Vec<f64>,
    /// The active entries of a segment's vector `q`, with respect to which derivatives are
    /// computed: first all entries that are not parameters, then the parameters in the order of
    /// their use.
    pub active: Vec<usize>,
    /// For each active parameter, the number of points assembled since the derivative with respect
    /// to this parameter was last used.
    pub idle: Vec<usize>,
    /// Typical sizes of the states at the starts of all segments, of the states at the ends, and of
    /// the extra unknowns; empty if all sizes are 1.
    pub units: Vec<f64>,
    /// Scratch space for the states at the ends of segments.
    pub ends: Vec<f64>,
    /// The point that was assembled last; empty after a failure.
    pub at: Vec<f64>,
    /// Whether the assembled equations may have a larger error than is allowed for an accepted
    /// solution.
    pub rough: bool,
    /// The number of assemblies so far.
    pub count: usize,
    /// The token that cancels assembly and factorisation.
    pub cancel: CancelToken,
}

/// The form of the linearisation that is factored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Form {
    /// The Jacobian.
    Jacobian,
    /// The Jacobian in which the equations "extra unknown = 0" replace the integral and phase
    /// conditions. With twisted boundary conditions, `x(1) = μ x(0)`, this matrix is the
    /// linearisation about a periodic orbit with fixed extra unknowns.
    Twisted,
}

/// The assembled linearisation of a system in one form, extended by a border.
#[derive(Clone, Copy)]
pub(super) struct Bordered<'a> {
    pub layout: &'a UnknownLayout,
    pub assembled: &'a AssembledJacobian,
    pub form: Form,
    pub border: Border<'a>,
}

/// Heuristic: a parameter becomes inactive after this number of points at which the derivative with
/// respect to it was not used. Newton's method uses the derivative with respect to an active
/// parameter at every point, except in iterations with an old matrix.
const MOST_IDLE: usize = 16;

impl AssembledJacobian {
    /// Makes a parameter active: from now on, the derivative with respect to this parameter is
    /// assembled.
    pub fn activate(&mut self, parameter: usize) {
        let k = self.active.iter().position(|active| *active == parameter).unwrap_or_else(|| {
            self.active.push(parameter);
            self.at.clear();
            self.active.len() - 1
        });
        self.idle.resize(self.active.len(), 0);
        self.idle[k] = 0;
    }

    /// Prepares the assembly at another point `x`. Parameters, which follow the first `own` active
    /// entries of `q`, become inactive if they were not used recently.
    pub fn drop_idle(&mut self, own: usize) {
        self.idle.resize(self.active.len(), 0);
        for k in (own..self.active.len()).rev() {
            self.idle[k] += 1;
            if self.idle[k] > MOST_IDLE {
                self.active.remove(k);
                self.idle.remove(k);
            }
        }
    }

    /// Resizes the buffers for a layout and its active entries of `q`.
    pub fn resize(&mut self, equations: &DiscretisedProblem) {
        let (layout, active) = (&equations.layout, self.active.len());
        self.residual.resize(layout.dimension, 0.0);
        self.blocks.resize(layout.segments.len(), Vec::new());
        self.numbers.resize(layout.segments.len(), Vec::new());
        for ((blocks, numbers), s) in
            self.blocks.iter_mut().zip(&mut self.numbers).zip(&layout.segments)
        {
            let rows = s.intervals * layout.degree * s.states;
            match self.structure {
                Structure::Sparse(_) => blocks.clear(),
                _ => blocks.resize(rows * (layout.degree + 1) * s.states, 0.0),
            }
            numbers.resize(rows * active, 0.0);
        }
        if layout.cycle.is_none() {
            self.boundary.resize(layout.boundary * (2 * layout.states + active), 0.0);
        }
        self.closing.resize(layout.closing() * layout.values(), 0.0);
        self.closing_numbers.resize(layout.closing() * active, 0.0);
    }

    /// Assembles residual and Jacobian at `x`, which must be loaded in `work`.
    pub fn assemble(
        &mut self,
        (equations, phase): (&mut DiscretisedProblem, &Phase),
        monitors: &mut Monitors,
        x: &[f64],
        work: &Work<f64>,
        passes: &mut Passes<Chunk>,
    ) -> Result<(), Failure> {
        self.count += 1;
        self.structure.choose(equations, work)?;
        self.resize(equations);
        equations.unknown_scales(&work.q, &mut self.units);
        self.arrange_units(&equations.layout);
        if !self.sparse_intervals(equations, work)? {
            self.intervals(equations, monitors, work)?;
        }
        match equations.layout.cycle {
            Some(_) => self.assemble_joints(equations, x, work, passes),
            None => self.boundary(equations, x, passes),
        }
        self.closing((equations, phase), x, work, passes)?;
        self.check(equations, &work.q)
    }

    /// Rearranges the typical sizes of all states and extra unknowns as sizes of the condensed
    /// unknowns.
    fn arrange_units(&mut self, layout: &UnknownLayout) {
        let Some(last) = self.units.last().copied() else { return };
        let states = match layout.cycle {
            Some(_) => {
                self.units.truncate(layout.segments[0].states);
                self.units.resize(layout.rest().states - 1, 1.0);
                self.units.push(last);
                self.units.len()
            }
            None => layout.states,
        };
        self.units.extend_from_within(..states);
        self.units[states..].rotate_right(states);
    }

    /// Computes the derivatives of the interval equations as sparse matrices. Returns false if the
    /// equations are dense, also because their sparsity pattern cannot be determined.
    fn sparse_intervals(
        &mut self,
        equations: &mut DiscretisedProblem,
        work: &Work<f64>,
    ) -> Result<bool, Failure> {
        let active = self.active.len();
        while let Structure::Sparse(sparse) = &mut self.structure {
            let mut agrees = true;
            let DiscretisedProblem { problem, method, meshes, layout, .. } = &mut *equations;
            for (s, j) in layout.intervals() {
                self.cancel.check()?;
                let rows = layout.degree * layout.segments[s].states;
                let block = Block {
                    residual: &mut self.residual[layout.equations(s, j)],
                    nodes: &mut [],
                    numbers: &mut self.numbers[s][j * rows * active..(j + 1) * rows * active],
                };
                let (span, nodes) = (span(meshes, s, j), &work.nodes[layout.interval(s, j)]);
                let q = &work.numbers[layout.local(s)];
                let interval = Interval { problem: &**problem, span, nodes, q };
                agrees &= sparse.linearise((method, j), interval, &self.active, block)?;
            }
            if agrees {
                return Ok(true);
            }
            if !sparse.widen(equations, work)? {
                self.structure = Structure::Dense;
                self.resize(equations);
            }
        }
        Ok(false)
    }

    fn intervals(
        &mut self,
        equations: &mut DiscretisedProblem,
        monitors: &mut Monitors,
        work: &Work<f64>,
    ) -> Result<(), Failure> {
        let active = self.active.len();
        let DiscretisedProblem { problem, method, meshes, layout, .. } = equations;
        let extremes = &mut monitors.extremes;
        let watching = method.watches_with_residual() && !self.rough;
        if watching {
            extremes.begin(&**problem, &work.q, 0.0);
        }
        for (s, segment) in layout.segments.iter().enumerate() {
            let (rows, n) = (layout.degree * segment.states, segment.states);
            let size = rows * (rows + n);
            for j in 0..segment.intervals {
                self.cancel.check()?;
                let block = Block {
                    residual: &mut self.residual[layout.equations(s, j)],
                    nodes: &mut self.blocks[s][j * size..(j + 1) * size],
                    numbers: &mut self.numbers[s][j * rows * active..(j + 1) * rows * active],
                };
                let (span, nodes) = (span(meshes, s, j), &work.nodes[layout.interval(s, j)]);
                let q = &work.numbers[layout.local(s)];
                let interval = Interval { problem: &**problem, span, nodes, q };
                let (watched, mut visit) = extremes.visitor(s, j);
                let watched = if watching { watched } else { MonitoredFunctions::default() };
                method.linearise(interval, &self.active, block, watched, &mut visit)?;
            }
        }
        if watching {
            extremes.end(&work.nodes, &work.q, false);
        }
        Ok(())
    }

    /// Computes the derivatives of the boundary conditions.
    fn boundary(&mut self, equations: &DiscretisedProblem, x: &[f64], passes: &mut Passes<Chunk>) {
        let layout = &equations.layout;
        let dependence =
            Dependence { unknowns: &layout.ends, segment: None, numbers: &self.active };
        let (width, first) = (dependence.len(), layout.conditions());
        for start in (0..width.max(1)).step_by(CHUNK) {
            passes.load(layout, dependence, start, Arguments::plain(x));
            let b = &mut passes.r[..layout.boundary];
            equations.boundary(&passes.unknowns, &passes.q, b);
            for (i, b) in b.iter().enumerate() {
                self.residual[first + i] = b.re;
                let row = &mut self.boundary[i * width..(i + 1) * width];
                row[start..].iter_mut().zip(b.eps).for_each(|(entry, slope)| *entry = slope);
            }
        }
    }

    /// Computes the rows of the integral conditions and of the phase condition.
    fn closing(
        &mut self,
        (equations, phase): (&DiscretisedProblem, &Phase),
        x: &[f64],
        work: &Work<f64>,
        passes: &mut Passes<Chunk>,
    ) -> Result<(), Failure> {
        let layout = &equations.layout;
        let first = layout.conditions() + layout.boundary;
        self.residual[first..].fill(0.0);
        self.closing.fill(0.0);
        self.closing_numbers.fill(0.0);
        if layout.integrals > 0 {
            for (s, j) in layout.intervals() {
                self.integrals(equations, (s, j), x, passes)?;
            }
        }
        if layout.phase {
            let row = &mut self.closing[layout.integrals * layout.values()..];
            row.copy_from_slice(&phase.row);
            self.residual[first + layout.integrals] = phase.value(layout, &work.nodes);
        }
        Ok(())
    }

    fn integrals(
        &mut self,
        equations: &DiscretisedProblem,
        (s, j): (usize, usize),
        x: &[f64],
        passes: &mut Passes<Chunk>,
    ) -> Result<(), Failure> {
        let (layout, active) = (&equations.layout, self.active.len());
        let (values, local) = (layout.values(), layout.interval(s, j));
        let first = layout.conditions() + layout.boundary;
        let unknowns = &layout.order[local.clone()];
        let dependence = Dependence { unknowns, segment: None, numbers: &self.active };
        for start in (0..dependence.len()).step_by(CHUNK) {
            passes.load(layout, dependence, start, Arguments::plain(x));
            let Passes { unknowns, q, r, local: buffers, .. } = &mut *passes;
            let sums = &mut r[..layout.integrals];
            sums.fill(Chunk::from(0.0));
            equations.integrals(equations.alone((s, j), unknowns, q), buffers, sums)?;
            for (i, sum) in sums.iter().enumerate() {
                if start == 0 {
                    self.residual[first + i] += sum.re;
                }
                for (k, slope) in (start..dependence.len()).zip(sum.eps) {
                    match k.checked_sub(local.len()) {
                        None => self.closing[i * values + local.start + k] += slope,
                        Some(k) => self.closing_numbers[i * active + k] += slope,
                    }
                }
            }
        }
        Ok(())
    }

    /// Writes the derivative of all equations with respect to an active parameter.
    pub fn column(&self, layout: &UnknownLayout, number: usize, out: &mut [f64]) {
        let active = self.active.len();
        let Some(k) = self.active.iter().position(|a| *a == number) else { return };
        for (s, numbers) in layout.segments.iter().zip(&self.numbers) {
            let rows = numbers.chunks_exact(active);
            out[s.equations..].iter_mut().zip(rows).for_each(|(out, row)| *out = row[k]);
        }
        if layout.cycle.is_some() {
            return self.joint_column(layout, k, out);
        }
        let width = 2 * layout.states + active;
        let conditions = &mut out[layout.conditions()..];
        for (out, row) in conditions.iter_mut().zip(self.boundary.chunks_exact(width)) {
            *out = row[width - active + k];
        }
        let closing = conditions[layout.boundary..].iter_mut();
        let rows = self.closing_numbers.chunks_exact(active);
        closing.zip(rows).for_each(|(out, row)| *out = row[k]);
    }

    /// Returns the largest factor by which deviations grow over any interval.
    pub fn growth(&self, equations: &DiscretisedProblem) -> f64 {
        let (method, layout) = (&equations.method, &equations.layout);
        let segments = layout.segments.iter().zip(&self.blocks);
        let intervals = segments.flat_map(|(s, blocks)| {
            let rows = layout.degree * s.states;
            blocks
                .chunks_exact(rows * (rows + s.states))
                .map(|nodes| method.growth(nodes, s.states))
        });
        intervals.fold(1.0, f64::max)
    }

    /// Returns an error that names the equation if an entry of the Jacobian or the residual is not
    /// finite.
    fn check(&self, equations: &DiscretisedProblem, q: &[f64]) -> Result<(), Failure> {
        equations.check(&self.residual, q)?;
        let layout = &equations.layout;
        let check = |entries: &[f64], width: usize, first: usize| match not_finite(entries) {
            Some(k) => Err(equations.refusal(first + k / width, entries[k], q)),
            None => Ok(()),
        };
        if let Some(sparse) = self.structure.sparse()
            && let Some(k) = not_finite(sparse.slopes())
        {
            return Err(equations.refusal(sparse.equation_of(k), sparse.slopes()[k], q));
        }
        for ((s, blocks), numbers) in layout.segments.iter().zip(&self.blocks).zip(&self.numbers) {
            check(blocks, (layout.degree + 1) * s.states, s.equations)?;
            check(numbers, self.active.len(), s.equations)?;
        }
        let width = match layout.cycle {
            // In cycles rows differ in length: errors are reported for the first condition.
            Some(_) => self.boundary.len(),
            None => 2 * layout.states + self.active.len(),
        };
        check(&self.boundary, width, layout.conditions())?;
        check(&self.closing, layout.values(), layout.conditions() + layout.boundary)
    }
}
