//! Multifrontal LU factorisation of a bordered sparse matrix.

use super::super::border::Border;
use super::super::factors::{ComplexFactors, Shifted};
use super::super::lu::{Entry, inverse_power_of_two};
use super::matrix::{Bordering, Matrix, Pencil};
use super::node::Node;
use super::part::{Job, Part};
use super::tree::Tree;
use super::triangles::{Side, Triangles};
use super::{Pattern, parity};
use crate::core::failure::{Failure, SINGULAR, unusable};
use crate::core::linalg::refill;
use crate::core::threads::side_by_side;
use faer::c64;
use std::iter::repeat_n;
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
        self.tree.nodes.iter().map(Node::products).sum()
    }
}

/// The LU factorisation of a bordered sparse matrix.
///
/// Each node of the elimination tree adds its rows and columns and the Schur complements of its
/// children to a dense front (I. S. Duff and J. K. Reid, ACM TOMS 9 (1983) 302). Pivots are chosen
/// among the fully summed rows of a front. A column without a sufficiently large pivot is delayed
/// to the front of the parent; the border is part of every front and is eliminated last. Hence a
/// singular matrix with a border that makes it regular is factored as accurately as a dense
/// bordered matrix. Refactoring reuses the storage of the previous factorisation.
///
/// Parts of the elimination tree of a large matrix are factored, and used for the solution of linear
/// systems, on several threads.
#[derive(Default)]
pub(in crate::core) struct SparseLu<E = f64> {
    elimination: Arc<Elimination>,
    /// The factors by which rows and columns are scaled.
    scales: [Vec<f64>; 2],
    /// The parts of the elimination tree; the last part comes after all others.
    parts: Vec<Part<E>>,
    work: Vec<E>,
    sign: f64,
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
        let (tree, size, scales) = (&elimination.tree, elimination.pattern.size(), &self.scales);
        let job = Job { tree, matrix, size, scales };
        if let Some((last, others)) = self.parts.split_last_mut() {
            side_by_side(others, |k, part| part.factor(job, &tree.parts[k], false));
            last.take_rests(others);
            last.factor(job, &tree.parts[others.len()], true);
            last.give_memory(others);
        }
        self.judge()
    }

    fn prepare(&mut self, elimination: &Arc<Elimination>, width: usize) {
        if !Arc::ptr_eq(&self.elimination, elimination) {
            *self = SparseLu { elimination: elimination.clone(), ..Self::default() };
        }
        let (size, tree) = (elimination.pattern.size() + width, &elimination.tree);
        self.scales.iter_mut().for_each(|scales| refill(scales, repeat_n(0.0, size)));
        self.parts.resize_with(tree.parts.len(), Part::default);
        self.parts.iter_mut().for_each(|part| part.prepare(size, tree.nodes.len()));
    }

    /// Computes powers of two that scale rows and columns, so that the largest entry of each row and
    /// column is near 1.
    fn equilibrate(&mut self, matrix: &Matrix<E>) {
        let pattern = &self.elimination.pattern;
        let [rows, columns] = &mut self.scales;
        matrix.for_each_size(pattern, |_, j, size| columns[j] = size.max(columns[j]));
        columns.iter_mut().for_each(|scale| *scale = inverse_power_of_two(*scale));
        matrix.for_each_size(pattern, |i, j, size| rows[i] = (size * columns[j]).max(rows[i]));
        rows.iter_mut().for_each(|scale| *scale = inverse_power_of_two(*scale));
    }

    /// Computes the sign of the determinant. [`Failure`] if a pivot vanishes to working accuracy.
    fn judge(&mut self) -> Result<(), Failure> {
        let (mut least, mut largest, mut sign) = (f64::INFINITY, 0.0_f64, 1.0);
        let triangles = || self.parts.iter().map(|part| &part.triangles);
        for triangles in triangles() {
            for pivot in triangles.pivots() {
                sign *= pivot.signum().real();
                let modulus = pivot.modulus();
                if modulus.is_nan() {
                    return Err(unusable(if least == 0.0 { least } else { modulus }, largest));
                }
                least = least.min(modulus);
                largest = largest.max(modulus);
            }
        }
        let eliminated = |side| triangles().flat_map(move |it| it.eliminated(side).iter().copied());
        let count = eliminated(Side::Rows).count();
        // After a division by a zero pivot, no other pivot of the front is acceptable.
        if count < self.size() {
            return Err(unusable(least.min(0.0), largest));
        }
        self.sign = sign * parity(eliminated(Side::Rows).zip(eliminated(Side::Columns)));
        let regular = count == 0 || least > SINGULAR * largest;
        if regular { Ok(()) } else { Err(unusable(least, largest)) }
    }

    /// Returns the number of rows of the factored matrix, including its border.
    pub fn size(&self) -> usize {
        self.scales[0].len()
    }

    /// Returns the number of negative pivots outside the border. For a real symmetric matrix, this
    /// number equals the number of negative eigenvalues of the matrix without its border (Sylvester's
    /// law of inertia). Returns `None` if a pivot is not on the diagonal, or if the border was not
    /// eliminated last.
    pub fn negative_pivots(&self) -> Option<usize> {
        let (n, mut negative) = (self.elimination.pattern.size(), 0);
        for triangles in self.parts.iter().map(|part| &part.triangles) {
            let rows = triangles.eliminated(Side::Rows);
            if rows != triangles.eliminated(Side::Columns) || !rows.is_sorted_by_key(|v| *v >= n) {
                return None;
            }
            let own = triangles.pivots().zip(rows).filter(|(_, v)| **v < n);
            negative += own.filter(|(pivot, _)| pivot.real() < 0.0).count();
        }
        Some(negative)
    }

    /// Returns the sign of the determinant.
    pub fn determinant_sign(&self) -> f64 {
        self.sign
    }

    /// Solves in place.
    pub fn solve(&mut self, right: &mut [E]) {
        self.solve_lanes::<1>(right.as_chunks_mut().0);
    }

    /// Solves linear systems for several right-hand sides in place, with one right-hand side in each
    /// lane of a vector register, because reading the factors from memory takes longer than
    /// multiplying by them.
    pub fn solve_lanes<const W: usize>(&mut self, right: &mut [[E; W]]) {
        for (row, scale) in right.iter_mut().zip(&self.scales[0]) {
            *row = scaled(*row, *scale);
        }
        self.solve_parts(
            right,
            [Side::Rows, Side::Columns],
            Triangles::forward,
            Triangles::backward::<W>,
        );
        let solved = self.work.as_chunks().0.iter().zip(&self.scales[1]);
        for (row, (solved, scale)) in right.iter_mut().zip(solved) {
            *row = scaled(*solved, *scale);
        }
    }

    /// Solves a linear system with the transpose (for a complex matrix, the conjugate transpose),
    /// in place.
    pub fn solve_transposed(&mut self, right: &mut [E]) {
        for (x, scale) in right.iter_mut().zip(&self.scales[1]) {
            *x *= E::from_real(*scale);
        }
        self.solve_parts(
            right.as_chunks_mut::<1>().0,
            [Side::Columns, Side::Rows],
            Triangles::forward_transposed,
            Triangles::backward_transposed,
        );
        for ((x, solved), scale) in right.iter_mut().zip(&self.work).zip(&self.scales[0]) {
            *x = *solved * E::from_real(*scale);
        }
    }

    /// Solves two triangular linear systems in turn, given the side of the factors to
    /// which the right-hand sides and the solution belong. The solution is stored in `work`.
    fn solve_parts<const W: usize>(
        &mut self,
        right: &mut [[E; W]],
        [from, to]: [Side; 2],
        forward: impl Fn(&mut Triangles<E>, &[[E; W]]) + Sync,
        backward: impl Fn(&mut Triangles<E>) + Sync,
    ) {
        self.work.resize(W * right.len(), E::default());
        let work = self.work.as_chunks_mut::<W>().0;
        let Some((last, others)) = self.parts.split_last_mut() else { return };
        let known = &*right;
        side_by_side(others, |_, part| forward(&mut part.triangles, known));
        others.iter().for_each(|part| part.triangles.add_changes(from, right));
        forward(&mut last.triangles, right);
        backward(&mut last.triangles);
        last.triangles.store(to, work);
        let known = &*work;
        side_by_side(others, |_, part| {
            part.triangles.load_others(to, known);
            backward(&mut part.triangles);
        });
        others.iter().for_each(|part| part.triangles.store(to, work));
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
