//! Fronts: small dense matrices whose leading columns are eliminated together.

use crate::core::failure::{Failure, SINGULAR, unusable};
use crate::core::vectors::in_fours;
use faer::linalg::matmul::matmul;
use faer::linalg::triangular_solve::solve_unit_lower_triangular_in_place;
use faer::{Accum, MatMut, Par};
use fearless_simd::{Level, dispatch};
use std::array::from_fn;
use std::ops::Range;

/// The row length of a front is padded with zeros to a multiple of this number, so that updates use
/// whole SIMD lanes. The same number of columns is eliminated before the other columns are updated:
/// the update then reads and writes each row once for the whole group.
const LANES: usize = 4;

/// Heuristic: the smallest number of eliminated columns for which elimination proceeds by panels,
/// and all other columns are updated by matrix products.
const BLOCKED: usize = 96;

/// Heuristic: the length up to which rows have a length known at compile time. With four Gauss
/// points, the rows of up to eight states are as short.
const SHORT: usize = 44;

/// Heuristic: the length from which on a scalar product is computed in more partial sums.
const LONG: usize = 32;

/// Heuristic: the number of columns of a panel, which is a multiple of the number of lanes.
const PANEL: usize = 32;

/// Several fronts of the same shape. In each front, the leading columns are eliminated with pivots
/// from the leading rows:
///
/// ```text
///     ⎡ L₁    ⎤     ⎡ U  * ⎤      pivotal rows (permuted by P): as many as columns
///     ⎢ L₂  I ⎥ ·   ⎣ 0  S ⎦      remaining pivotal rows
///     ⎣ L₃  I ⎦                   border rows: updated, never a pivot
/// ```
///
/// The factors overwrite the matrix, and `S` is the Schur complement. Whole rows are exchanged
/// together with their multipliers, so that all row exchanges can be applied before the elimination
/// of a right-hand side.
#[derive(Default)]
pub(super) struct Fronts {
    /// The number of eliminated columns.
    pub(super) eliminated: usize,
    /// The number of rows that can contain a pivot.
    pivotal: usize,
    /// The distance in memory from the start of a row to the start of the next row.
    pub(super) stride: usize,
    /// The number of stored entries of a front.
    length: usize,
    /// The entries of all fronts, one front after the other.
    factors: Vec<f64>,
    /// The rows from which the pivots were taken.
    exchanges: Vec<usize>,
    /// For each column, the inverse of a typical entry; zero for columns that do not affect pivots.
    pub(super) scales: Vec<f64>,
    /// For each row, the inverse of the largest entry after columns are scaled.
    row_scales: Vec<f64>,
}

/// The pivots found so far, each relative to the largest entry of its row.
pub(super) struct Pivots {
    /// The sign of the product of the pivots, times the sign of the permutation of rows.
    pub(super) sign: f64,
    largest: f64,
}

impl Pivots {
    pub(super) fn new() -> Self {
        Pivots { sign: 1.0, largest: 0.0 }
    }

    /// Adds pivots that were found separately.
    pub(super) fn join(&mut self, others: &Pivots) {
        self.sign *= others.sign;
        self.largest = self.largest.max(others.largest);
    }

    /// Records a pivot. [`Failure`] if a pivot vanishes to working accuracy or is not finite.
    fn record(&mut self, pivot: f64, relative: f64) -> Result<(), Failure> {
        self.sign *= pivot.signum();
        self.largest = self.largest.max(relative);
        match relative > SINGULAR {
            true => Ok(()),
            // In an empty row the relative pivot is 0 · ∞.
            false => Err(unusable(if pivot == 0.0 { 0.0 } else { relative }, self.largest)),
        }
    }
}

impl Fronts {
    /// Creates `count` fronts; the other arguments give, for each front, the number of eliminated
    /// columns, of rows that can contain a pivot, of rows after these rows, and of columns.
    pub(super) fn new(
        count: usize,
        eliminated: usize,
        pivotal: usize,
        border: usize,
        width: usize,
    ) -> Self {
        let stride = width.next_multiple_of(LANES);
        let length = (pivotal + border) * stride;
        Fronts {
            eliminated,
            pivotal,
            stride,
            length,
            factors: vec![0.0; count * length],
            exchanges: vec![0; count * eliminated],
            scales: vec![0.0; stride],
            row_scales: vec![0.0; pivotal],
        }
    }

    /// Returns the entries of a front, row by row.
    pub(super) fn front(&self, i: usize) -> &[f64] {
        &self.factors[i * self.length..][..self.length]
    }

    /// Returns the entries of a front, row by row, as a mutable slice to fill in.
    pub(super) fn front_mut(&mut self, i: usize) -> &mut [f64] {
        &mut self.factors[i * self.length..][..self.length]
    }

    fn exchanges(&self, i: usize) -> &[usize] {
        &self.exchanges[i * self.eliminated..][..self.eliminated]
    }

    /// Eliminates with implicitly scaled partial pivoting: entries of a column are compared as if
    /// the largest entry of every row were 1. The scaling keeps the growing and decaying solutions
    /// of a dichotomy at their own sizes, which bounds the growth of entries (with plain partial
    /// pivoting the growth can be exponential in the number of fronts: Wright 1993).
    ///
    /// # Errors
    /// [`Failure::Singular`] at the first pivot that vanishes to working accuracy.
    pub(super) fn eliminate(&mut self, i: usize, pivots: &mut Pivots) -> Result<(), Failure> {
        let w = self.stride;
        let mut front = Front {
            a: &mut self.factors[i * self.length..][..self.length],
            w,
            scales: &self.scales,
            row_scales: &mut self.row_scales,
            exchanges: &mut self.exchanges[i * self.eliminated..][..self.eliminated],
        };
        if w <= SHORT {
            in_fours(
                #[inline(always)]
                || front.eliminate_short(pivots),
            )
        } else {
            dispatch!(Level::new(), _ => front.eliminate(pivots))
        }
    }

    /// Applies `L⁻¹ P` to the right-hand sides of the pivotal rows and of the border rows.
    pub(super) fn forward(&self, i: usize, y: &mut [f64], border: &mut [f64]) {
        dispatch!(Level::new(), _ => self.forward_inlined(i, y, border))
    }

    #[inline(always)]
    fn forward_inlined(&self, i: usize, y: &mut [f64], border: &mut [f64]) {
        for (c, pivot) in self.exchanges(i).iter().enumerate() {
            y.swap(c, *pivot);
        }
        let mut rows = self.front(i).chunks_exact(self.stride);
        for (r, row) in rows.by_ref().take(self.pivotal).enumerate() {
            let done = r.min(self.eliminated);
            y[r] -= dot(&row[..done], &y[..done]);
        }
        for (value, row) in border.iter_mut().zip(rows) {
            *value -= dot(&row[..self.eliminated], &y[..self.eliminated]);
        }
    }

    /// Computes the eliminated unknowns from the other unknowns, in the order of the front's
    /// columns.
    pub(super) fn back(&self, i: usize, right: &[f64], unknowns: &mut [f64]) {
        dispatch!(Level::new(), _ => self.back_inlined(i, right, unknowns))
    }

    #[inline(always)]
    fn back_inlined(&self, i: usize, right: &[f64], unknowns: &mut [f64]) {
        let (a, width) = (self.front(i), unknowns.len());
        for r in (0..self.eliminated).rev() {
            let row = &a[r * self.stride..][..width];
            unknowns[r] = (right[r] - dot(&row[r + 1..], &unknowns[r + 1..])) / row[r];
        }
    }

    /// Applies `U⁻ᵀ` to right-hand sides of the transposed system, in the order of the front's
    /// columns.
    pub(super) fn forward_transposed(&self, i: usize, right: &mut [f64]) {
        let (a, width) = (self.front(i), right.len());
        for r in 0..self.eliminated {
            let row = &a[r * self.stride..][..width];
            right[r] /= row[r];
            let factor = right[r];
            subtract(&mut right[r + 1..], factor, &row[r + 1..]);
        }
    }

    /// Applies `Pᵀ L⁻ᵀ` to unknowns of the transposed system, given by pivotal and border rows.
    pub(super) fn back_transposed(&self, i: usize, y: &mut [f64], border: &[f64]) {
        let a = self.front(i);
        for (r, factor) in border.iter().enumerate() {
            let row = &a[(self.pivotal + r) * self.stride..][..self.eliminated];
            subtract(&mut y[..self.eliminated], *factor, row);
        }
        for r in (0..self.pivotal).rev() {
            let (done, factor) = (r.min(self.eliminated), y[r]);
            subtract(&mut y[..done], factor, &a[r * self.stride..][..done]);
        }
        for (c, pivot) in self.exchanges(i).iter().enumerate().rev() {
            y.swap(c, *pivot);
        }
    }
}

/// A front whose leading columns are eliminated.
struct Front<'f> {
    /// The entries, row by row.
    a: &'f mut [f64],
    /// The distance in memory from the start of a row to the start of the next row.
    w: usize,
    scales: &'f [f64],
    row_scales: &'f mut [f64],
    /// The rows from which the pivots are taken, one for each column that is eliminated.
    exchanges: &'f mut [usize],
}

impl Front<'_> {
    /// Eliminates like [`eliminate`](Self::eliminate), with rows of at most [`SHORT`] numbers.
    #[inline(always)]
    fn eliminate_short(&mut self, pivots: &mut Pivots) -> Result<(), Failure> {
        match self.w {
            4 => self.eliminate_rows::<4>(pivots),
            8 => self.eliminate_rows::<8>(pivots),
            12 => self.eliminate_rows::<12>(pivots),
            16 => self.eliminate_rows::<16>(pivots),
            20 => self.eliminate_rows::<20>(pivots),
            24 => self.eliminate_rows::<24>(pivots),
            28 => self.eliminate_rows::<28>(pivots),
            32 => self.eliminate_rows::<32>(pivots),
            36 => self.eliminate_rows::<36>(pivots),
            40 => self.eliminate_rows::<40>(pivots),
            _ => self.eliminate_rows::<SHORT>(pivots),
        }
    }

    /// Eliminates column by column in rows of `W` numbers.
    #[inline(always)]
    fn eliminate_rows<const W: usize>(&mut self, pivots: &mut Pivots) -> Result<(), Failure> {
        let (rows, row_scales) = (self.a.as_chunks_mut::<W>().0, &mut *self.row_scales);
        for (row, scale) in rows.iter().zip(&mut *row_scales) {
            *scale = 1.0 / largest(row, self.scales);
        }
        for (c, exchange) in self.exchanges.iter_mut().enumerate() {
            let (pivot, relative) = pivot_of(c, row_scales, |r| rows[r][c]);
            *exchange = pivot;
            if pivot != c {
                rows.swap(c, pivot);
                row_scales.swap(c, pivot);
                pivots.sign = -pivots.sign;
            }
            let (above, below) = rows.split_at_mut(c + 1);
            let mut top = above[c];
            pivots.record(top[c], relative * self.scales[c])?;
            let inverse = 1.0 / top[c];
            // Entries to the left of column `c` do not change.
            top[..=c].fill(0.0);
            for row in below {
                let multiplier = row[c] * inverse;
                for k in 0..W {
                    row[k] -= top[k] * multiplier;
                }
                row[c] = multiplier;
            }
        }
        Ok(())
    }

    #[inline(always)]
    fn eliminate(&mut self, pivots: &mut Pivots) -> Result<(), Failure> {
        let (w, eliminated) = (self.w, self.exchanges.len());
        for (row, scale) in self.a.chunks_exact(w).zip(&mut *self.row_scales) {
            *scale = 1.0 / largest(row, self.scales);
        }
        let panel = if eliminated < BLOCKED { eliminated } else { PANEL };
        for start in (0..eliminated).step_by(panel.max(1)) {
            let end = (start + panel).min(eliminated);
            // The range of updated columns: no columns follow the last panel.
            let width = if end == eliminated { w } else { end };
            for first in (start..end).step_by(LANES) {
                let group = first..end.min(first + LANES);
                self.eliminate_group(group.clone(), pivots)?;
                update(&mut self.a[first * w..], w, group, width);
            }
            if width < w {
                update_beyond(&mut self.a[start * w..], w, start..end);
            }
        }
        Ok(())
    }

    /// Eliminates a group of columns that lies in one group of lanes, and updates only these lanes.
    #[inline(always)]
    fn eliminate_group(&mut self, group: Range<usize>, pivots: &mut Pivots) -> Result<(), Failure> {
        let (w, first) = (self.w, group.start);
        for c in group {
            let (pivot, relative) = pivot_of(c, self.row_scales, |r| self.a[r * w + c]);
            self.exchanges[c] = pivot;
            if pivot != c {
                let (above, below) = self.a.split_at_mut(pivot * w);
                above[c * w..(c + 1) * w].swap_with_slice(&mut below[..w]);
                self.row_scales.swap(c, pivot);
                pivots.sign = -pivots.sign;
            }
            let (above, below) = self.a.split_at_mut((c + 1) * w);
            let top = &above[c * w..];
            pivots.record(top[c], relative * self.scales[c])?;
            let inverse = 1.0 / top[c];
            // Entries to the left of column `c` do not change.
            let top: [f64; LANES] = from_fn(|k| if first + k > c { top[first + k] } else { 0.0 });
            for row in below.chunks_exact_mut(w) {
                let multiplier = row[c] * inverse;
                for k in 0..LANES {
                    row[first + k] -= top[k] * multiplier;
                }
                row[c] = multiplier;
            }
        }
        Ok(())
    }
}

/// Returns the pivot row of column `c` and the scaled magnitude of its entry; the function `entry`
/// returns the entry of a row in this column.
#[inline(always)]
fn pivot_of(c: usize, row_scales: &[f64], entry: impl Fn(usize) -> f64) -> (usize, f64) {
    let mut best = (c, entry(c).abs() * row_scales[c]);
    for r in c + 1..row_scales.len() {
        let size = entry(r).abs() * row_scales[r];
        if size > best.1 {
            best = (r, size);
        }
    }
    best
}

/// Subtracts multiples of the rows of a group of eliminated columns from all rows below, in the columns
/// from the end of the group's lanes up to `width`; `rows` begins at the first row of the group, and
/// the multipliers stand in the columns of the group.
#[inline(always)]
fn update(rows: &mut [f64], w: usize, group: Range<usize>, width: usize) {
    let Range { start, end } = group;
    let (count, others) = (end - start, width.min(start + LANES)..width);
    let (top, below) = rows.split_at_mut(count * w);
    for r in 1..count {
        let (above, own) = top.split_at_mut(r * w);
        for (k, row) in above.chunks_exact(w).enumerate() {
            let multiplier = own[start + k];
            subtract(&mut own[others.clone()], multiplier, &row[others.clone()]);
        }
    }
    match count {
        LANES => update_rows::<LANES>(top, below, (w, start), others),
        3 => update_rows::<3>(top, below, (w, start), others),
        2 => update_rows::<2>(top, below, (w, start), others),
        _ => update_rows::<1>(top, below, (w, start), others),
    }
}

/// Subtracts multiples of `N` rows from all rows below.
#[inline(always)]
fn update_rows<const N: usize>(
    top: &[f64],
    below: &mut [f64],
    (w, start): (usize, usize),
    others: Range<usize>,
) {
    let top: [&[f64]; N] = from_fn(|k| &top[k * w..][others.clone()]);
    for row in below.chunks_exact_mut(w) {
        let multipliers: [f64; N] = from_fn(|k| row[start + k]);
        let row = &mut row[others.clone()];
        let top = top.map(|top| &top[..row.len()]);
        for j in 0..row.len() {
            let mut entry = row[j];
            for k in 0..N {
                entry -= top[k][j] * multipliers[k];
            }
            row[j] = entry;
        }
    }
}

/// Updates the columns beyond a panel of eliminated columns; `rows` begins at the panel.
fn update_beyond(rows: &mut [f64], w: usize, panel: Range<usize>) {
    let (top, below) = rows.split_at_mut(panel.len() * w);
    let (lower, mut upper) =
        MatMut::from_row_major_slice_mut(top, panel.len(), w).split_at_col_mut(panel.end);
    let lower = lower.as_ref().subcols(panel.start, panel.len());
    solve_unit_lower_triangular_in_place(lower, upper.as_mut(), Par::Seq);
    let height = below.len() / w;
    let below = MatMut::from_row_major_slice_mut(below, height, w);
    let (multipliers, rest) = below.split_at_col_mut(panel.end);
    let multipliers = multipliers.as_ref().subcols(panel.start, panel.len());
    matmul(rest, Accum::Add, multipliers, upper.as_ref(), -1.0, Par::Seq);
}

/// Returns the largest entry of a row after columns are scaled; the row consists of whole lanes.
#[inline(always)]
fn largest(row: &[f64], scales: &[f64]) -> f64 {
    let mut largest = [0.0; LANES];
    for (entries, scales) in row.as_chunks::<LANES>().0.iter().zip(scales.as_chunks::<LANES>().0) {
        for lane in 0..LANES {
            let entry = entries[lane].abs() * scales[lane];
            largest[lane] = if entry > largest[lane] { entry } else { largest[lane] };
        }
    }
    largest.into_iter().fold(0.0, f64::max)
}

/// Computes the scalar product `a · b`. Long products are computed in more partial sums, because each
/// addition to a sum waits for the preceding addition.
#[inline(always)]
fn dot(a: &[f64], b: &[f64]) -> f64 {
    if a.len() < LONG { dot_in::<LANES>(a, b) } else { dot_in::<{ 4 * LANES }>(a, b) }
}

/// Computes the scalar product `a · b` in `N` partial sums, where `N` is a power of two.
#[inline(always)]
fn dot_in<const N: usize>(a: &[f64], b: &[f64]) -> f64 {
    let ((a, a_rest), (b, b_rest)) = (a.as_chunks::<N>(), b.as_chunks::<N>());
    let mut sums = [0.0; N];
    for (a, b) in a.iter().zip(b) {
        for lane in 0..N {
            sums[lane] += a[lane] * b[lane];
        }
    }
    let rest: f64 = a_rest.iter().zip(b_rest).map(|(a, b)| a * b).sum();
    let mut count = N;
    while count > 1 {
        count /= 2;
        for lane in 0..count {
            sums[lane] = sums[2 * lane] + sums[2 * lane + 1];
        }
    }
    sums[0] + rest
}

/// Computes `target ← target − factor · row`.
#[inline(always)]
fn subtract(target: &mut [f64], factor: f64, row: &[f64]) {
    for (target, entry) in target.iter_mut().zip(row) {
        *target -= factor * entry;
    }
}
