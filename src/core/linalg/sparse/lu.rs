//! Multifrontal LU factorisation of a bordered sparse matrix.

use super::super::border::Border;
use super::super::factors::{ComplexFactors, Factorisation, Shifted};
use super::super::lu::{Entry, inverse_power_of_two};
use super::front::Front;
use super::tree::{Node, Tree};
use super::{Pattern, parity};
use crate::core::failure::{Failure, SINGULAR, unusable};
use faer::c64;
use std::mem::take;
use std::ops::Range;
use std::sync::Arc;

/// The order of elimination for matrices with the same sparsity pattern, computed once.
#[derive(Clone, Debug, Default)]
pub(in crate::core) struct Elimination {
    pub pattern: Pattern,
    tree: Tree,
}

impl Elimination {
    /// Computes the order of elimination for matrices with a given sparsity pattern.
    pub fn of(pattern: Pattern) -> Self {
        Elimination { tree: Tree::of(&pattern), pattern }
    }

    /// Returns the number of multiplications in an elimination without a border.
    pub fn products(&self) -> f64 {
        let products = |node: &Node| {
            let (own, size) = (node.own.len(), node.own.len() + node.pattern.len());
            (own * size * size) as f64
        };
        self.tree.nodes.iter().map(products).sum()
    }
}

/// The Schur complement of a node's front, which is added to the front of the node's parent.
#[derive(Clone, Debug, Default)]
struct Rest<E> {
    entries: Vec<E>,
    /// The indices of the rows and columns of the Schur complement.
    lists: [Vec<usize>; 2],
    /// The number of leading rows and columns that are fully summed but were not eliminated,
    /// because their pivots were too small.
    delayed: usize,
}

/// The eliminated part of a front.
#[derive(Clone, Debug)]
struct Eliminated {
    pivots: usize,
    /// The range of this front's rows and columns in the lists that hold the rows and columns of
    /// all fronts.
    place: Range<usize>,
    /// The position of the node's factors among all factors: first `L` (all rows of the pivot
    /// columns), then `U` (the pivot rows of all other columns).
    factors: usize,
}

/// The LU factorisation of a bordered sparse matrix.
///
/// Each node of the elimination tree adds its rows and columns and the Schur complements of its
/// children to a dense front (I. S. Duff and J. K. Reid, ACM TOMS 9 (1983) 302). Pivots are chosen
/// among the fully summed rows of a front. A column without a sufficiently large pivot is delayed
/// to the front of the parent; the border is part of every front and is eliminated last. Hence a
/// singular matrix with a border that makes it regular is factored as accurately as a dense
/// bordered matrix. Refactoring reuses the storage of the previous factorisation.
#[derive(Default)]
pub(in crate::core) struct SparseLu<E = f64> {
    elimination: Arc<Elimination>,
    width: usize,
    scales: [Vec<f64>; 2],
    /// The position of each row and of each column in the current front.
    local: [Vec<usize>; 2],
    /// Runs of consecutive rows of a child's Schur complement, with their positions in the current
    /// front.
    runs: Vec<Range<usize>>,
    /// The Schur complements of the children of each node.
    rests: Vec<Vec<Rest<E>>>,
    pool: Vec<Rest<E>>,
    front: Vec<E>,
    lists: [Vec<usize>; 2],
    eliminated: Vec<Eliminated>,
    factors: Vec<E>,
    work: Vec<E>,
    sign: f64,
}

/// The matrices `A` and `M` of a pencil `A − σ M`, given by their entries in the order of a common
/// pattern; without `M`, the identity matrix.
#[derive(Clone, Copy)]
pub(in crate::core) struct Pencil<'a> {
    pub entries: &'a [f64],
    pub mass: Option<&'a [f64]>,
}

/// A bordered sparse matrix `A − shift M`.
struct Matrix<'a, E> {
    pencil: Pencil<'a>,
    shift: E,
    border: Bordering<'a, E>,
    /// Whether pivots are taken from the diagonal if possible.
    diagonal: bool,
}

impl<E: Entry> Matrix<'_, E> {
    /// Returns entry number `k` of the pattern without the share of an identity matrix `M`.
    fn entry(&self, k: usize) -> E {
        let own = E::from_real(self.pencil.entries[k]);
        self.pencil.mass.map_or(own, |mass| own - self.shift * E::from_real(mass[k]))
    }

    /// Returns the number that an identity matrix `M` subtracts from the diagonal.
    fn on_diagonal(&self) -> E {
        if self.pencil.mass.is_some() { E::default() } else { self.shift }
    }

    /// Visits the row, the column and the size of every entry, including the entries of the border.
    fn for_each_size(&self, pattern: &Pattern, mut visit: impl FnMut(usize, usize, f64)) {
        let (n, border, shift) = (pattern.size(), &self.border, self.on_diagonal());
        for j in 0..n {
            for (k, &i) in (pattern.start(j)..).zip(pattern.column(j)) {
                let shift = if i == j { shift } else { E::default() };
                visit(i, j, (self.entry(k) - shift).modulus());
            }
            for k in 0..border.width {
                visit(n + k, j, (border.row)(k, j).modulus());
                visit(j, n + k, (border.column)(j, k).modulus());
            }
        }
        for i in 0..border.width {
            (0..border.width).for_each(|k| visit(n + i, n + k, (border.corner)(i, k).modulus()));
        }
    }
}

/// The entries of a border: columns with one entry for each equation, rows with one entry for each
/// unknown, and the corner.
struct Bordering<'a, E> {
    width: usize,
    column: &'a dyn Fn(usize, usize) -> E,
    row: &'a dyn Fn(usize, usize) -> E,
    corner: &'a dyn Fn(usize, usize) -> E,
}

impl SparseLu {
    /// Factors the bordered matrix `A − shift M`.
    ///
    /// # Errors
    /// [`Failure`] if a pivot vanishes to working accuracy or is not finite.
    pub fn factor(
        &mut self,
        elimination: &Arc<Elimination>,
        (pencil, shift): (Pencil, f64),
        border: Border,
    ) -> Result<(), Failure> {
        let (n, m) = (elimination.pattern.size(), border.width);
        let border = Bordering {
            width: m,
            column: &|i, k| border.columns[k * n + i],
            row: &|k, j| border.rows[k * n + j],
            corner: &|i, k| border.corner[i * m + k],
        };
        self.factor_matrix(elimination, &Matrix { pencil, shift, border, diagonal: false })
    }

    /// Factors an unbordered matrix that becomes symmetric by a diagonal scaling. Pivots are taken
    /// from the diagonal, and the number of negative pivots equals the number of negative
    /// eigenvalues.
    ///
    /// # Errors
    /// The same errors as [`factor`](Self::factor).
    pub fn factor_symmetric(
        &mut self,
        elimination: &Arc<Elimination>,
        (pencil, shift): (Pencil, f64),
    ) -> Result<(), Failure> {
        let none = |_, _| 0.0;
        let border = Bordering { width: 0, column: &none, row: &none, corner: &none };
        self.factor_matrix(elimination, &Matrix { pencil, shift, border, diagonal: true })
    }
}

#[allow(private_bounds)]
impl<E: Entry> SparseLu<E> {
    fn factor_matrix(
        &mut self,
        elimination: &Arc<Elimination>,
        matrix: &Matrix<E>,
    ) -> Result<(), Failure> {
        self.prepare(elimination, matrix.border.width);
        self.equilibrate(matrix);
        let elimination = elimination.clone();
        for (k, node) in elimination.tree.nodes.iter().enumerate() {
            self.eliminate(&elimination, k, Some(node), matrix);
        }
        self.eliminate(&elimination, elimination.tree.nodes.len(), None, matrix);
        self.judge()
    }

    fn prepare(&mut self, elimination: &Arc<Elimination>, width: usize) {
        if !Arc::ptr_eq(&self.elimination, elimination) {
            *self = SparseLu { elimination: elimination.clone(), ..Self::default() };
        }
        self.width = width;
        let size = elimination.pattern.size() + width;
        self.local.iter_mut().for_each(|local| local.resize(size, 0));
        self.work.resize(size, E::default());
        self.lists.iter_mut().for_each(Vec::clear);
        self.eliminated.clear();
        self.factors.clear();
        self.rests.resize_with(elimination.tree.nodes.len() + 1, Vec::new);
    }

    /// Computes powers of two that scale rows and columns, so that the largest entry of each row and
    /// column is near 1.
    fn equilibrate(&mut self, matrix: &Matrix<E>) {
        let pattern = &self.elimination.pattern;
        let [rows, columns] = &mut self.scales;
        for scales in [&mut *rows, &mut *columns] {
            scales.clear();
            scales.resize(pattern.size() + self.width, 0.0);
        }
        matrix.for_each_size(pattern, |_, j, size| columns[j] = size.max(columns[j]));
        columns.iter_mut().for_each(|scale| *scale = inverse_power_of_two(*scale));
        matrix.for_each_size(pattern, |i, j, size| rows[i] = (size * columns[j]).max(rows[i]));
        rows.iter_mut().for_each(|scale| *scale = inverse_power_of_two(*scale));
    }

    /// Assembles the frontal matrix (the front) of a node of the elimination tree, eliminates
    /// columns with acceptable pivots, and passes the remaining columns to the front of the parent
    /// node. If no node is given, eliminates all remaining columns: the columns of the border, and
    /// columns that were delayed because they had no acceptable pivot.
    fn eliminate(
        &mut self,
        elimination: &Elimination,
        k: usize,
        node: Option<&Node>,
        matrix: &Matrix<E>,
    ) {
        let (n, m) = (elimination.pattern.size(), self.width);
        let children = take(&mut self.rests[k]);
        let (own, pattern) = node.map_or((&[][..], &[][..]), |node| (&node.own, &node.pattern));
        let from = self.lists[0].len();
        for (side, list) in self.lists.iter_mut().enumerate() {
            list.extend(own);
            children.iter().for_each(|child| list.extend(&child.lists[side][..child.delayed]));
            list.extend(pattern);
            list.extend(n..n + m);
        }
        let size = self.lists[0].len() - from;
        let summed = if node.is_some() { size - m - pattern.len() } else { size };
        self.assemble(from, summed - own.len(), node, matrix);
        if !children.is_empty() {
            for (local, list) in self.local.iter_mut().zip(&self.lists) {
                list[from..].iter().enumerate().for_each(|(at, &v)| local[v] = at);
            }
        }
        for child in children {
            self.add(size, &child);
            self.pool.push(child);
        }
        let [rows, columns] = &mut self.lists;
        let (rows, columns) = (&mut rows[from..], &mut columns[from..]);
        let entries = &mut self.front[..size * size];
        let diagonal = matrix.diagonal;
        let pivots = Front { entries, rows, columns, summed, width: m, diagonal }.eliminate();
        self.keep(from, pivots);
        if let Some(node) = node {
            self.leave(from, [pivots, summed], node.parent);
        }
    }

    /// Clears a front (frontal matrix) whose row and column lists begin at `from`, and adds the
    /// matrix entries of a node and of the border. In the row and column lists of the front,
    /// delayed columns come after the node's own columns and before the node's pattern.
    fn assemble(&mut self, from: usize, delayed: usize, node: Option<&Node>, matrix: &Matrix<E>) {
        let [rows, columns] = &self.lists;
        let (rows, columns) = (&rows[from..], &columns[from..]);
        let (size, m) = (rows.len(), self.width);
        self.front.clear();
        self.front.resize(size * size, E::default());
        let [row_scales, column_scales] = &self.scales;
        let mut put = |i: usize, j: usize, a: E| {
            self.front[j * size + i] +=
                a * E::from_real(row_scales[rows[i]] * column_scales[columns[j]]);
        };
        let (border, shift) = (&matrix.border, matrix.on_diagonal());
        let first = size - m;
        let Some(node) = node else {
            for i in 0..m {
                (0..m).for_each(|k| put(first + i, first + k, (border.corner)(i, k)));
            }
            return;
        };
        let own = node.own.len();
        let place = |at: u32| if (at as usize) < own { at as usize } else { at as usize + delayed };
        for &[k, i, j] in &node.entries {
            put(place(i), place(j), matrix.entry(k as usize));
        }
        for (at, &v) in node.own.iter().enumerate() {
            put(at, at, -shift);
            for k in 0..m {
                put(first + k, at, (border.row)(k, v));
                put(at, first + k, (border.column)(v, k));
            }
        }
    }

    /// Adds the Schur complement of a child node to the parent's front (frontal matrix), which has
    /// the given size; `local` contains the positions of rows and columns in this front.
    fn add(&mut self, size: usize, child: &Rest<E>) {
        let [rows, columns] = &child.lists;
        self.runs.clear();
        for &row in rows {
            let at = self.local[0][row];
            match self.runs.last_mut() {
                Some(run) if run.end == at => run.end += 1,
                _ => self.runs.push(at..at + 1),
            }
        }
        let entries = child.entries.chunks_exact(rows.len().max(1));
        for (&column, mut entries) in columns.iter().zip(entries) {
            let target = &mut self.front[self.local[1][column] * size..][..size];
            for run in &self.runs {
                let (own, rest) = entries.split_at(run.len());
                let target = &mut target[run.clone()];
                for i in 0..own.len() {
                    target[i] += own[i];
                }
                entries = rest;
            }
        }
    }

    /// Stores the factors of the eliminated columns, which are the first columns of the front
    /// (frontal matrix); the row and column lists of the front begin at `from`.
    fn keep(&mut self, from: usize, pivots: usize) {
        let size = self.lists[0].len() - from;
        let factors = self.factors.len();
        if pivots > 0 {
            self.eliminated.push(Eliminated { pivots, place: from..from + size, factors });
        }
        self.factors.extend_from_slice(&self.front[..pivots * size]);
        for column in self.front[pivots * size..].chunks_exact(size.max(1)) {
            self.factors.extend_from_slice(&column[..pivots]);
        }
    }

    /// Passes the rows and columns that were not eliminated in a front (frontal matrix) to the
    /// parent's front; the lists of the front begin at `from`.
    fn leave(&mut self, from: usize, [pivots, summed]: [usize; 2], parent: usize) {
        let size = self.lists[0].len() - from;
        if pivots == size {
            return;
        }
        let mut rest = self.pool.pop().unwrap_or_default();
        rest.delayed = summed - pivots;
        for (to, list) in rest.lists.iter_mut().zip(&self.lists) {
            to.clear();
            to.extend_from_slice(&list[from + pivots..]);
        }
        rest.entries.clear();
        for column in self.front[pivots * size..].chunks_exact(size) {
            rest.entries.extend_from_slice(&column[pivots..]);
        }
        self.rests[parent].push(rest);
    }

    /// Computes the sign of the determinant. [`Failure`] if a pivot vanishes to working accuracy.
    fn judge(&mut self) -> Result<(), Failure> {
        let (mut least, mut largest, mut sign) = (f64::INFINITY, 0.0_f64, 1.0);
        let mut order: [Vec<usize>; 2] = Default::default();
        for Eliminated { pivots, place, factors } in &self.eliminated {
            let size = place.len();
            for k in 0..*pivots {
                let pivot = self.factors[factors + k * size + k];
                sign *= pivot.signum().real();
                let modulus = pivot.modulus();
                if modulus.is_nan() {
                    return Err(unusable(if least == 0.0 { least } else { modulus }, largest));
                }
                least = least.min(modulus);
                largest = largest.max(modulus);
            }
            for (order, list) in order.iter_mut().zip(&self.lists) {
                order.extend_from_slice(&list[place.start..][..*pivots]);
            }
        }
        self.sign = sign * parity(&order);
        let regular = order[0].is_empty() || least > SINGULAR * largest;
        if regular { Ok(()) } else { Err(unusable(least, largest)) }
    }

    /// Returns the number of negative pivots of a real symmetric matrix, which equals the number of
    /// its negative eigenvalues (Sylvester's law of inertia). Returns `None` if a pivot is not on
    /// the diagonal.
    pub fn negative_pivots(&self) -> Option<usize> {
        let mut negative = 0;
        for Eliminated { pivots, place, factors } in &self.eliminated {
            let [rows, columns] = &self.lists;
            for k in 0..*pivots {
                if rows[place.start + k] != columns[place.start + k] {
                    return None;
                }
                negative += usize::from(self.factors[factors + k * place.len() + k].real() < 0.0);
            }
        }
        Some(negative)
    }

    /// Solves in place.
    pub fn solve(&mut self, right: &mut [E]) {
        self.solve_lanes::<1>(right.as_chunks_mut().0);
    }

    /// Solves linear systems for several right-hand sides in place, with one right-hand side in each
    /// lane of a vector register, because reading the factors from memory takes longer than
    /// multiplying by them.
    pub fn solve_lanes<const W: usize>(&mut self, right: &mut [[E; W]]) {
        let ([rows, columns], [row_scales, column_scales]) = (&self.lists, &self.scales);
        for (row, scale) in right.iter_mut().zip(row_scales) {
            *row = scaled(*row, *scale);
        }
        // `right` is indexed by equations, `work` by unknowns; each front gathers its own part.
        if self.work.len() < W * right.len() {
            self.work.resize(W * right.len(), E::default());
        }
        let (work, mut part) = (self.work.as_chunks_mut::<W>().0, Vec::new());
        for Eliminated { pivots, place, factors } in &self.eliminated {
            let (size, rows) = (place.len(), &rows[place.clone()]);
            gather(&mut part, rows, right);
            let lower = self.factors[*factors..][..pivots * size].chunks_exact(size);
            for (k, column) in lower.enumerate() {
                let x = part[k];
                reduce(&mut part[k + 1..], &column[k + 1..], x);
            }
            rows.iter().zip(&part).for_each(|(&row, x)| right[row] = *x);
        }
        for Eliminated { pivots, place, factors } in self.eliminated.iter().rev() {
            let size = place.len();
            let [rows, columns] = [rows, columns].map(|list| &list[place.clone()]);
            let (lower, upper) = self.factors[*factors..].split_at(pivots * size);
            gather(&mut part, &rows[..*pivots], right);
            for (column, &unknown) in upper.chunks_exact(*pivots).zip(&columns[*pivots..]) {
                reduce(&mut part, column, work[unknown]);
            }
            for (k, column) in lower.chunks_exact(size).enumerate().rev() {
                let mut x = part[k];
                for lane in 0..W {
                    x[lane] /= column[k];
                }
                work[columns[k]] = x;
                reduce(&mut part[..k], column, x);
            }
        }
        for ((row, solved), scale) in right.iter_mut().zip(&*work).zip(column_scales) {
            *row = scaled(*solved, *scale);
        }
    }

    /// Solves a linear system with the transpose (for a complex matrix, the conjugate transpose),
    /// in place.
    pub fn solve_transposed(&mut self, right: &mut [E]) {
        let ([rows, columns], [row_scales, column_scales]) = (&self.lists, &self.scales);
        for (x, scale) in right.iter_mut().zip(column_scales) {
            *x *= E::from_real(*scale);
        }
        let (work, part) = (&mut self.work, &mut self.front);
        let product = |column: &[E], part: &[E]| -> E {
            column.iter().zip(part).map(|(a, x)| a.conjugate() * *x).sum()
        };
        for Eliminated { pivots, place, factors } in &self.eliminated {
            let size = place.len();
            let [rows, columns] = [rows, columns].map(|list| &list[place.clone()]);
            let (lower, upper) = self.factors[*factors..].split_at(pivots * size);
            gather(part, &columns[..*pivots], right);
            for (k, column) in lower.chunks_exact(size).enumerate() {
                let sum = product(&column[..k], part);
                part[k] = (part[k] - sum) / column[k].conjugate();
                work[rows[k]] = part[k];
            }
            for (column, &unknown) in upper.chunks_exact(*pivots).zip(&columns[*pivots..]) {
                right[unknown] -= product(column, part);
            }
        }
        for Eliminated { pivots, place, factors } in self.eliminated.iter().rev() {
            let (size, rows) = (place.len(), &rows[place.clone()]);
            gather(part, rows, work);
            let lower = self.factors[*factors..][..pivots * size].chunks_exact(size);
            for (k, column) in lower.enumerate().rev() {
                let sum = product(&column[k + 1..], &part[k + 1..]);
                part[k] -= sum;
                work[rows[k]] = part[k];
            }
        }
        for ((x, solved), scale) in right.iter_mut().zip(&*work).zip(row_scales) {
            *x = *solved * E::from_real(*scale);
        }
    }
}

/// Multiplies one component of the right-hand sides in all lanes by a number.
#[inline]
fn scaled<E: Entry, const W: usize>(mut row: [E; W], scale: f64) -> [E; W] {
    for lane in 0..W {
        row[lane] *= E::from_real(scale);
    }
    row
}

/// Subtracts a multiple of one column of the factors from the right-hand side in each lane.
#[inline]
fn reduce<E: Entry, const W: usize>(part: &mut [[E; W]], column: &[E], multiples: [E; W]) {
    let column = &column[..part.len()];
    for i in 0..column.len() {
        for lane in 0..W {
            part[i][lane] -= column[i] * multiples[lane];
        }
    }
}

/// Copies those components of a vector that belong to a front (frontal matrix) to contiguous
/// memory.
fn gather<T: Copy>(part: &mut Vec<T>, places: &[usize], vector: &[T]) {
    part.clear();
    part.extend(places.iter().map(|&place| vector[place]));
}

impl Factorisation for SparseLu {
    fn solve(&mut self, right: &mut [f64]) {
        self.solve(right);
    }

    fn solve_transposed(&mut self, right: &mut [f64]) {
        self.solve_transposed(right);
    }

    fn determinant_sign(&self) -> f64 {
        self.sign
    }
}

impl ComplexFactors for SparseLu<c64> {
    fn solve(&mut self, right: &mut [c64]) {
        self.solve(right);
    }

    fn solve_transposed(&mut self, right: &mut [c64]) {
        self.solve_transposed(right);
    }
}

/// The factors of `A − iω` for a sparse matrix `A`, with a complex border.
pub(in crate::core) type SparseShiftedLu = Shifted<SparseLu<c64>>;

impl SparseShiftedLu {
    /// Factors the bordered matrix `A − iω M`; the border consists of complex columns and rows, and a
    /// zero corner. All columns and rows of the border are given as real parts, followed by
    /// imaginary parts. The bordered matrix contains the complex conjugates of the given rows.
    ///
    /// # Errors
    /// Returns the same errors as the factorisation of real matrices.
    pub fn factor(
        &mut self,
        elimination: &Arc<Elimination>,
        (pencil, omega): (Pencil, f64),
        border: Border,
    ) -> Result<(), Failure> {
        let n = elimination.pattern.size();
        let part = |list: &[f64], k: usize, at: usize| {
            let (real, imaginary) = list[2 * k * n..2 * (k + 1) * n].split_at(n);
            c64::new(real[at], imaginary[at])
        };
        let border = Bordering {
            width: border.width,
            column: &|i, k| part(border.columns, k, i),
            row: &|k, j| part(border.rows, k, j).conj(),
            corner: &|_, _| c64::new(0.0, 0.0),
        };
        let shift = c64::new(0.0, omega);
        self.lu.factor_matrix(elimination, &Matrix { pencil, shift, border, diagonal: false })
    }
}
