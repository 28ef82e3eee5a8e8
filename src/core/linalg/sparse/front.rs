//! Elimination inside a front, which is a dense matrix whose leading rows and columns are fully
//! summed.

use super::super::lu::{Entry, largest};
use crate::core::threads::side_by_side;
use faer::linalg::matmul::matmul;
use faer::linalg::triangular_solve::solve_unit_lower_triangular_in_place;
use faer::{Accum, MatMut, MatRef, Par};
use fearless_simd::{Level, dispatch};

/// Heuristic: the smallest size of a pivot, as a fraction of the largest entry of its column: in
/// one elimination step, entries grow by at most the factor one plus the inverse of this number.
const THRESHOLD: f64 = 0.1;

/// Rounding: a pivot must have at least this size, as a fraction of the border's entries in the
/// column of the pivot, even if many columns lack such a pivot: rounding errors grow by at most the
/// inverse of this number.
const LEAST: f64 = 1e-8;

/// Heuristic: the number of columns of the panels that are eliminated before the rest of the front
/// is updated.
const PANEL: usize = 32;

/// Heuristic: the size of a front from which on the processor's widest vectors are faster.
const WIDE: usize = 32;

/// Heuristic: the number of multiplications below which an update is faster with plain loops.
const SMALL: usize = 4096;

/// Heuristic: the number of multiplications from which on an update is divided into blocks of columns
/// that several threads update.
const LARGE: usize = 2_000_000;

/// Heuristic: the number of blocks of columns of a large update.
const BLOCKS: usize = 4;

/// A front: a dense matrix whose first `summed` rows and columns are fully summed, so that they can
/// be eliminated. Each row of a front is labelled by the index of its equation, and each column by
/// the index of its unknown.
pub(super) struct Front<'a, E> {
    /// The entries of the front, stored column by column.
    pub entries: &'a mut [E],
    pub rows: &'a mut [usize],
    pub columns: &'a mut [usize],
    pub summed: usize,
    /// The number of rows and columns of the border, which are the last rows and columns of the
    /// front.
    pub width: usize,
    /// Whether pivots must lie on the diagonal, so that the signs of the pivots count eigenvalues. A
    /// column without a sufficiently large diagonal pivot is delayed to the parent's front; in the last
    /// front, any pivot of the column is accepted.
    pub diagonal: bool,
}

impl<E: Entry> Front<'_, E> {
    #[inline(always)]
    fn size(&self) -> usize {
        self.rows.len()
    }

    /// Eliminates the columns with sufficiently large pivots and moves these columns, with their pivot
    /// rows, to the beginning of the front. After the elimination, the matrix contains the factors `L`
    /// (with a unit diagonal) and `U` of the eliminated columns, and the Schur complement. Returns the
    /// number of eliminated columns.
    pub fn eliminate(&mut self) -> usize {
        if self.size() < WIDE {
            return self.eliminate_columns();
        }
        dispatch!(Level::new(), _ => self.eliminate_columns())
    }

    #[inline(always)]
    fn eliminate_columns(&mut self) -> usize {
        let mut done = 0;
        loop {
            let (before, mut end) = (done, self.summed);
            while done < end {
                let [accepted, rejected] = self.panel(done, end);
                done += accepted;
                end -= rejected;
            }
            // Rejected columns have changed in the meantime.
            if done == self.summed || done == before && !(self.diagonal && self.is_last()) {
                return done;
            }
            // In the last front, columns cannot be delayed.
            self.diagonal &= done > before;
        }
    }

    /// Eliminates the columns of the panel that begins at `start`; the candidates for elimination
    /// lie before `end`. Rejected columns are moved to the end of the candidates. Returns the
    /// numbers of eliminated and rejected columns.
    #[inline(always)]
    fn panel(&mut self, start: usize, end: usize) -> [usize; 2] {
        let size = self.size();
        let beyond = end.min(start + PANEL);
        let (mut k, mut last) = (start, beyond);
        while k < last {
            let rejected = self.summed - end + beyond - last;
            let Some(row) = self.pivot(k, rejected) else {
                last -= 1;
                self.swap_columns(k, last);
                continue;
            };
            self.swap_rows(k, row);
            let (left, right) = self.entries.split_at_mut((k + 1) * size);
            let column = &mut left[k * size + k..];
            let inverse = E::from_real(1.0) / column[0];
            column[1..].iter_mut().for_each(|a| *a *= inverse);
            for other in right[..(beyond - k - 1) * size].chunks_exact_mut(size) {
                subtract(&mut other[k..], column);
            }
            k += 1;
        }
        self.update(start, k, beyond);
        for step in 1..=beyond - k {
            self.swap_columns(beyond - step, end - step);
        }
        [k - start, beyond - k]
    }

    /// Whether this front is the last front of the elimination.
    fn is_last(&self) -> bool {
        self.summed == self.size()
    }

    /// Returns the row of a column's pivot: the diagonal entry of a symmetric matrix if this entry is
    /// large enough, otherwise the largest entry; `None` if all entries are too small.
    ///
    /// A matrix with a border of width `m` has up to `m` pivots near zero, which need the border's
    /// rows. Therefore, up to `2m` columns are delayed if their pivots are smaller than entries of the
    /// border; if more columns were delayed, the fronts would become too large.
    #[inline(always)]
    fn pivot(&self, k: usize, rejected: usize) -> Option<usize> {
        let column = &self.entries[k * self.size()..][..self.size()];
        let (mut row, mut most, mut own) = (k, 0.0, None);
        for (i, a) in column.iter().enumerate().take(self.summed).skip(k) {
            let size = a.modulus();
            if size > most || size.is_nan() {
                (row, most) = (i, size);
            }
            if self.rows[i] == self.columns[k] {
                own = Some((i, size));
            }
        }
        let others = &column[self.summed..];
        let (pattern, border) = others.split_at(others.len().saturating_sub(self.width));
        let for_border = if rejected < 2 * self.width { THRESHOLD } else { LEAST };
        let least = (THRESHOLD * largest(pattern).max(most)).max(for_border * largest(border));
        match own {
            Some((i, size)) if size >= least && size > 0.0 => Some(i),
            _ if self.diagonal => None,
            // If no rows are excluded, the column is compared with all entries.
            _ if most >= least && (most > 0.0 || others.is_empty()) => Some(row),
            _ => None,
        }
    }

    #[inline(always)]
    fn swap_rows(&mut self, i: usize, k: usize) {
        if i != k {
            self.rows.swap(i, k);
            let size = self.rows.len();
            self.entries.chunks_exact_mut(size).for_each(|column| column.swap(i, k));
        }
    }

    #[inline(always)]
    fn swap_columns(&mut self, j: usize, k: usize) {
        if j != k {
            self.columns.swap(j, k);
            let size = self.size();
            let (left, right) = self.entries.split_at_mut(j.max(k) * size);
            left[j.min(k) * size..][..size].swap_with_slice(&mut right[..size]);
        }
    }

    /// Updates the columns from `from` on with the eliminated columns from `start` to `end`.
    #[inline(always)]
    fn update(&mut self, start: usize, end: usize, from: usize) {
        let (size, width) = (self.size(), end - start);
        let (left, right) = self.entries.split_at_mut(from * size);
        let count = right.len() / size;
        if width * (size - start) * count < SMALL {
            for column in right.chunks_exact_mut(size) {
                for (k, factor) in (start..end).zip(left[start * size..].chunks_exact(size)) {
                    subtract(&mut column[k..], &factor[k..]);
                }
            }
            return;
        }
        let left = MatRef::from_column_major_slice(&left[start * size..end * size], size, width);
        let unit = left.subrows(start, width);
        let (lower, factor) = (left.subrows(end, size - end), E::from_real(-1.0));
        let apply = |block: &mut [E]| {
            let count = block.len() / size;
            let block = MatMut::from_column_major_slice_mut(block, size, count);
            let (_, block) = block.split_at_row_mut(start);
            let (mut top, bottom) = block.split_at_row_mut(width);
            solve_unit_lower_triangular_in_place(unit, top.as_mut(), Par::Seq);
            matmul(bottom, Accum::Add, lower, top.as_ref(), factor, Par::Seq);
        };
        if width * (size - start) * count < LARGE {
            return apply(right);
        }
        let mut blocks: Vec<_> = right.chunks_mut(size * count.div_ceil(BLOCKS)).collect();
        side_by_side(&mut blocks, |_, block| apply(block));
    }
}

/// Subtracts a multiple of another column, given as `(pivot, multipliers…)`, from a column; the
/// column's first entry determines the factor.
#[inline(always)]
fn subtract<E: Entry>(column: &mut [E], factor: &[E]) {
    let Some((first, rest)) = column.split_first_mut() else { return };
    let first = *first;
    if first != E::default() {
        rest.iter_mut().zip(&factor[1..]).for_each(|(a, m)| *a -= *m * first);
    }
}
