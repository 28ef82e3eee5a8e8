//! Linearisation of the collocation equations of an interval, several directions at a time.

use super::basis::{Basis, combine};
use crate::core::bvp::colored::ColoredField;
use crate::core::bvp::erased::Number;
use crate::core::bvp::interval::{Block, Interval, placed};
use crate::core::failure::Failure;
use crate::core::linalg::refill;
use crate::core::problem::FieldIn;
use crate::core::scalar::{DualChunk, seeded};

/// The arguments and the values of the vector field in one pass; each pass computes derivatives in
/// `W` directions.
#[derive(Clone, Debug, Default)]
pub(super) struct Passes<const W: usize> {
    x: Vec<DualChunk<f64, W>>,
    q: Vec<DualChunk<f64, W>>,
    f: Vec<DualChunk<f64, W>>,
    real: Vec<f64>,
    /// Scratch space for the product of a sparse Jacobian with its probe.
    product: Vec<[f64; 2]>,
}

/// Computes the residual and the Jacobian of the collocation equations at all Gauss points, `W`
/// directions at a time; the directions are the `n` states at the Gauss point, followed by the
/// entries of `q` with respect to which derivatives are computed.
#[inline(always)]
pub(super) fn linearise_in<const W: usize>(
    basis: &Basis,
    passes: &mut Passes<W>,
    interval: Interval<f64>,
    active: &[usize],
    mut block: Block,
) -> Result<(), Failure>
where
    DualChunk<f64, W>: Number,
{
    let n = interval.nodes.len() / basis.nodes.len();
    passes.resize(n);
    for start in (0..n + active.len()).step_by(W) {
        passes.seed_numbers(interval.q, active, n, start);
        for c in 0..basis.gauss.len() {
            passes.evaluate(basis, &interval, c, |i, x| seeded(x, i, start))?;
            passes.place_residual(basis, interval.nodes, c, block.residual);
            if start < n {
                passes.place_nodes(basis, c, start, &mut block);
            }
            if start + W > n {
                passes.place_numbers((n, active.len()), c, start, block.numbers);
            }
        }
    }
    Ok(())
}

/// Computes the residual and the derivatives like [`linearise_in`], for a vector field with a sparse
/// Jacobian: `nodes` receives, for each Gauss point, the entries of `h L f_x` in the order of the
/// pattern. Returns whether the Jacobian agrees with its pattern at all Gauss points.
pub(super) fn linearise_colored<const W: usize>(
    basis: &Basis,
    passes: &mut Passes<W>,
    interval: Interval<f64>,
    (active, field): (&[usize], &ColoredField),
    block: Block,
) -> Result<bool, Failure>
where
    DualChunk<f64, W>: Number,
{
    let (own, count) = (field.directions(), field.pattern.count());
    let mut agrees = true;
    passes.resize(field.pattern.size());
    for start in (0..own + active.len()).step_by(W) {
        passes.seed_numbers(interval.q, active, own, start);
        for (c, entries) in block.nodes.chunks_exact_mut(count).enumerate() {
            passes.evaluate(basis, &interval, c, |i, x| field.seeded(x, i, start))?;
            passes.place_residual(basis, interval.nodes, c, block.residual);
            field.place(&passes.f, start, entries);
            agrees &= field.agrees(&passes.f, start, entries, &mut passes.product);
            if start + W > own {
                passes.place_numbers((own, active.len()), c, start, block.numbers);
            }
        }
    }
    Ok(agrees)
}

/// Marks the states on which each component of the vector field depends, like
/// [`Collocation::mark_dependences`](super::Collocation::mark_dependences).
pub(super) fn mark_dependences<const W: usize>(
    basis: &Basis,
    passes: &mut Passes<W>,
    interval: Interval<f64>,
    start: usize,
    seen: &mut [[bool; W]],
) -> Result<(), Failure>
where
    DualChunk<f64, W>: Number,
{
    passes.resize(seen.len());
    passes.seed_numbers(interval.q, &[], 0, 0);
    for c in 0..basis.gauss.len() {
        passes.evaluate(basis, &interval, c, |i, x| seeded(x, i, start))?;
        for (seen, f) in seen.iter_mut().zip(&passes.f) {
            seen.iter_mut().zip(f.eps).for_each(|(seen, part)| *seen |= part != 0.0);
        }
    }
    Ok(())
}

impl<const W: usize> Passes<W>
where
    DualChunk<f64, W>: Number,
{
    #[inline(always)]
    fn resize(&mut self, n: usize) {
        self.real.resize(n, 0.0);
        self.x.resize(n, DualChunk::from(0.0));
        self.f.resize(n, DualChunk::from(0.0));
    }

    /// Seeds the dual numbers for `q`; the entries of `q` with respect to which derivatives are
    /// computed are the directions that follow the `own` directions of the states.
    #[inline(always)]
    fn seed_numbers(&mut self, q: &[f64], active: &[usize], own: usize, start: usize) {
        refill(&mut self.q, q.iter().map(|q| DualChunk::from(*q)));
        for (k, &number) in active.iter().enumerate() {
            self.q[number] = seeded(q[number], own + k, start);
        }
    }

    /// Evaluates `h L f` at a Gauss point: the vector field `f` times the length `h` of the
    /// interval and the duration `L` of the segment. The function `seed` converts the states to dual
    /// numbers.
    #[inline(always)]
    fn evaluate(
        &mut self,
        basis: &Basis,
        interval: &Interval<f64>,
        c: usize,
        seed: impl Fn(usize, f64) -> DualChunk<f64, W>,
    ) -> Result<(), Failure> {
        let Interval { problem, span, nodes, q } = *interval;
        let equations = DualChunk::<f64, W>::residual(problem);
        let (duration, h) = (equations.duration_in(span.segment, &self.q), interval.length());
        let field = equations.on_segment(span.segment, &self.q);
        let t = duration * (span.start + h * basis.gauss[c]);
        combine(basis.row(&basis.values, c), nodes, &mut self.real);
        field.domain(&self.real, q).map_err(|cause| placed(cause, span.segment, t.re))?;
        for (i, (x, real)) in self.x.iter_mut().zip(&self.real).enumerate() {
            *x = seed(i, *real);
        }
        field.slope(t, &self.x, &self.q, &mut self.f);
        let step = duration * h;
        self.f.iter_mut().for_each(|f| *f *= step);
        Ok(())
    }

    #[inline(always)]
    fn place_residual(&self, basis: &Basis, nodes: &[f64], c: usize, residual: &mut [f64]) {
        let n = self.f.len();
        let residual = &mut residual[c * n..(c + 1) * n];
        combine(basis.row(&basis.slopes, c), nodes, residual);
        residual.iter_mut().zip(&self.f).for_each(|(r, f)| *r -= f.re);
    }

    /// Writes `ℓ_j'(ρ_c) I − ℓ_j(ρ_c) h L f_x` into the Jacobian's columns for the directions of
    /// this pass.
    #[inline(always)]
    fn place_nodes(&self, basis: &Basis, c: usize, start: usize, block: &mut Block) {
        let (n, places) = (self.f.len(), basis.nodes.len());
        let (values, slopes) = (basis.row(&basis.values, c), basis.row(&basis.slopes, c));
        let rows = block.nodes[c * n * n * places..].chunks_exact_mut(n * places);
        for (i, (row, f)) in rows.zip(&self.f).enumerate() {
            let parts = f.eps;
            match n {
                1 => outer_product::<1>(row, values, &parts),
                2 => outer_product::<2>(row, values, &parts),
                3 => outer_product::<3>(row, values, &parts),
                4 => outer_product::<4>(row, values, &parts),
                _ => {
                    for (entries, value) in row.chunks_exact_mut(n).zip(values) {
                        let entries = entries[start..].iter_mut();
                        entries.zip(&parts).for_each(|(entry, part)| *entry = -value * part);
                    }
                }
            }
            if (start..start + W).contains(&i) {
                row.chunks_exact_mut(n)
                    .zip(slopes)
                    .for_each(|(entries, slope)| entries[i] += slope);
            }
        }
    }

    /// Writes `−∂(h L f)/∂q` into the Jacobian's columns for the directions of this pass, which follow
    /// the `own` directions of the states.
    #[inline(always)]
    fn place_numbers(
        &self,
        (own, active): (usize, usize),
        c: usize,
        start: usize,
        numbers: &mut [f64],
    ) {
        let n = self.f.len();
        for (i, f) in self.f.iter().enumerate() {
            let row = (c * n + i) * active;
            for (direction, part) in (start..own + active).zip(f.eps) {
                if direction >= own {
                    numbers[row + direction - own] = -part;
                }
            }
        }
    }
}

/// Computes `−ℓ_j f_k` for all `k` of a range whose length is known at compile time, which makes
/// short loops fast.
#[inline(always)]
fn outer_product<const N: usize>(row: &mut [f64], values: &[f64], parts: &[f64]) {
    let Some(parts) = parts.first_chunk::<N>() else { return };
    for (entries, value) in row.as_chunks_mut::<N>().0.iter_mut().zip(values) {
        for (entry, part) in entries.iter_mut().zip(parts) {
            *entry = -value * part;
        }
    }
}
