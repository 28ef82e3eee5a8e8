//! LU factorisation with partial pivoting of a bordered dense matrix.

use super::border::Border;
use crate::core::failure::{Failure, SINGULAR, unusable};
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::lu::partial_pivoting::factor::{lu_in_place, lu_in_place_scratch};
use faer::{MatMut, Par, c64};
use nalgebra::ComplexField;
use std::f64::consts::SQRT_2;
use std::iter::Sum;

/// The smallest size of a matrix for which faer's blocked factorisation is faster than plain loops.
const BLOCKED_FROM: usize = 40;

/// The LU factorisation `P R M C = L U` of a bordered matrix `M`:
///
/// ```text
///     M = ⎡ A  B ⎤
///         ⎣ C  D ⎦
/// ```
///
/// The diagonal matrices `R` and `C`, whose entries are powers of two, bring the largest entry of
/// each row and column near 1, so that the pivots and the test for singularity do not depend on
/// units. Repeated factorisations of matrices of the same size do not allocate memory.
///
/// ```
/// use tangency::core::linalg::{Border, BorderedLu};
/// // A = [0] is singular; within its border it is regular.
/// let mut lu = BorderedLu::default();
/// lu.factor(&[0.0], Border { width: 1, columns: &[2.0], rows: &[4.0], corner: &[0.0], units: &[] }).unwrap();
/// let mut x = [2.0, 8.0];
/// lu.solve(&mut x);
/// assert_eq!(x, [2.0, 1.0]);
/// assert!(lu.factor(&[0.0], Border::NONE).is_err());
/// ```
#[derive(Default)]
pub struct BorderedLu<E = f64> {
    size: usize,
    /// The factor `L` below the diagonal (with a unit diagonal) and the factor `U` on and above the
    /// diagonal, stored column by column.
    factors: Vec<E>,
    /// The row permutation: row `i` of the permuted matrix is row `source[i]` of the original
    /// matrix.
    source: Vec<usize>,
    position: Vec<usize>,
    row_scale: Vec<f64>,
    column_scale: Vec<f64>,
    work: Vec<E>,
    scratch: Option<MemBuffer>,
    sign: f64,
}

/// An entry of a matrix, real or complex.
pub(super) trait Entry:
    faer::traits::ComplexField + ComplexField<RealField = f64> + Copy + Default + Sum
{
}
impl Entry for f64 {}
impl Entry for c64 {}

impl BorderedLu {
    /// Factors the bordered matrix with the block `A` (stored column by column).
    ///
    /// # Errors
    /// [`Failure`] if a pivot vanishes to working accuracy or is not finite.
    pub fn factor(&mut self, matrix: &[f64], border: Border) -> Result<(), Failure> {
        let outcome = self.factor_in_units(matrix, border, &[]);
        match differ(border.units) {
            true => outcome.or_else(|_| self.factor_in_units(matrix, border, border.units)),
            false => outcome,
        }
    }

    /// Factors the bordered matrix with the block `A`, given known sizes of the first unknowns; the
    /// size 0 means unknown.
    pub(in crate::core) fn factor_in_units(
        &mut self,
        matrix: &[f64],
        border: Border,
        units: &[f64],
    ) -> Result<(), Failure> {
        self.resize(matrix.len().isqrt() + border.width);
        self.fill(matrix, border);
        self.factor_room(units)
    }

    fn fill(&mut self, matrix: &[f64], border: Border) {
        let (size, m) = (self.size, border.width);
        let n = size - m;
        for j in 0..n {
            let column = &mut self.factors[j * size..(j + 1) * size];
            column[..n].copy_from_slice(&matrix[j * n..(j + 1) * n]);
            for i in 0..m {
                column[n + i] = border.rows[i * n + j];
            }
        }
        for j in 0..m {
            let column = &mut self.factors[(n + j) * size..(n + j + 1) * size];
            column[..n].copy_from_slice(&border.columns[j * n..(j + 1) * n]);
            for i in 0..m {
                column[n + i] = border.corner[i * m + j];
            }
        }
    }
}

#[allow(private_bounds)]
impl<E: Entry> BorderedLu<E> {
    /// Returns the storage for a matrix of the given size, column by column, to fill in before a
    /// call of [`factor_room`](Self::factor_room).
    pub(in crate::core) fn room(&mut self, size: usize) -> &mut [E] {
        self.resize(size);
        &mut self.factors
    }

    /// Factors the matrix in the storage returned by [`room`](Self::room), given known sizes of its
    /// unknowns.
    pub(in crate::core) fn factor_room(&mut self, units: &[f64]) -> Result<(), Failure> {
        let size = self.size;
        self.equilibrate(units);
        self.sign = if size < BLOCKED_FROM { self.factor_plain() } else { self.factor_blocked() };
        self.judge()
    }

    /// Solves in place.
    pub fn solve(&mut self, right: &mut [E]) {
        let n = self.size;
        for i in 0..n {
            self.work[i] = right[self.source[i]] * E::from_real(self.row_scale[self.source[i]]);
        }
        for j in 0..n {
            let (xj, column) = (self.work[j], &self.factors[j * n..(j + 1) * n]);
            for i in j + 1..n {
                self.work[i] -= column[i] * xj;
            }
        }
        for j in (0..n).rev() {
            let column = &self.factors[j * n..(j + 1) * n];
            let xj = self.work[j] / column[j];
            self.work[j] = xj;
            for i in 0..j {
                self.work[i] -= column[i] * xj;
            }
        }
        for j in 0..n {
            right[j] = self.work[j] * E::from_real(self.column_scale[j]);
        }
    }

    /// Solves a linear system with the transpose (for a complex matrix, the conjugate transpose),
    /// in place.
    pub fn solve_transposed(&mut self, right: &mut [E]) {
        let n = self.size;
        for j in 0..n {
            let column = &self.factors[j * n..(j + 1) * n];
            let sum: E = (0..j).map(|i| column[i].conjugate() * self.work[i]).sum();
            let scaled = right[j] * E::from_real(self.column_scale[j]);
            self.work[j] = (scaled - sum) / column[j].conjugate();
        }
        for j in (0..n).rev() {
            let column = &self.factors[j * n..(j + 1) * n];
            let sum: E = (j + 1..n).map(|i| column[i].conjugate() * self.work[i]).sum();
            self.work[j] -= sum;
        }
        for i in 0..n {
            right[self.source[i]] = self.work[i] * E::from_real(self.row_scale[self.source[i]]);
        }
    }

    /// Returns the sign of the determinant.
    pub fn determinant_sign(&self) -> f64 {
        self.sign
    }

    fn resize(&mut self, size: usize) {
        if self.size == size && !self.factors.is_empty() {
            return;
        }
        self.size = size;
        self.factors.resize(size * size, E::default());
        for indices in [&mut self.source, &mut self.position] {
            indices.resize(size, 0);
        }
        self.work.resize(size, E::default());
        for numbers in [&mut self.row_scale, &mut self.column_scale] {
            numbers.resize(size, 0.0);
        }
        self.scratch = (size >= BLOCKED_FROM).then(|| {
            let need = lu_in_place_scratch::<usize, E>(size, size, Par::Seq, Default::default());
            MemBuffer::new(need)
        });
    }

    /// Scales columns by the known sizes of their unknowns or by their largest entries, and rows by their
    /// largest entries in columns of known sizes. Border rows that contain only rounding errors in the
    /// columns of known sizes are scaled last, by the largest of all their entries.
    fn equilibrate(&mut self, units: &[f64]) {
        self.row_scale.fill(1.0);
        if units.is_empty() {
            self.scale_columns(|_, column| Some(largest(column)));
            return self.scale_rows(|_| true, |_| true);
        }
        let size = self.size;
        let known = |j: usize| units.get(j).is_some_and(|unit| *unit > 0.0);
        self.column_scale.fill(1.0);
        self.scale_columns(|j, _| known(j).then(|| 1.0 / units[j]));
        let own = (0..size).rfind(|j| known(*j)).map_or(size, |last| last + 1);
        self.scale_rows(|i| i < own, known);
        let factors = &self.factors;
        let rounding = |i: usize| {
            let entry = |j: usize| factors[j * size + i].modulus();
            let in_known = (0..size).filter(|j| known(*j)).map(entry).fold(0.0, f64::max);
            let of_column = |j: usize| largest(&factors[j * size..][..own]);
            let mut others = (0..size).filter(|j| !known(*j));
            in_known < NOTHING && others.any(|j| NOTHING * entry(j) > in_known * of_column(j))
        };
        let idle: Vec<usize> = (own..size).filter(|i| rounding(*i)).collect();
        self.scale_rows(|i| i >= own && !idle.contains(&i), known);
        let rest = |column: &[E]| {
            let counted = column.iter().enumerate().filter(|(i, _)| !idle.contains(i));
            counted.map(|(_, a)| a.modulus()).fold(0.0, f64::max)
        };
        self.scale_columns(|j, column| (!known(j)).then(|| rest(column)));
        self.scale_rows(|i| idle.contains(&i), |_| true);
    }

    /// Divides columns by powers of two near the given sizes.
    fn scale_columns(&mut self, size: impl Fn(usize, &[E]) -> Option<f64>) {
        for (j, column) in self.factors.chunks_exact_mut(self.size).enumerate() {
            let Some(size) = size(j, column) else { continue };
            let scale = inverse_power_of_two(size);
            self.column_scale[j] = scale;
            column.iter_mut().for_each(|a| *a *= E::from_real(scale));
        }
    }

    /// Divides selected rows by powers of two near their largest entries in selected columns.
    fn scale_rows(&mut self, rows: impl Fn(usize) -> bool, counts: impl Fn(usize) -> bool) {
        let chosen = |(i, scale)| rows(i).then_some(scale);
        let scales = &mut self.row_scale;
        scales.iter_mut().enumerate().filter_map(chosen).for_each(|scale| *scale = 0.0);
        let columns = self.factors.chunks_exact(self.size).enumerate();
        for (_, column) in columns.filter(|(j, _)| counts(*j)) {
            for (i, (largest, a)) in scales.iter_mut().zip(column).enumerate() {
                if rows(i) {
                    *largest = a.modulus().max(*largest);
                }
            }
        }
        let chosen = |(i, scale)| rows(i).then_some(scale);
        let scales_of = scales.iter_mut().enumerate().filter_map(chosen);
        scales_of.for_each(|scale| *scale = inverse_power_of_two(*scale));
        for column in self.factors.chunks_exact_mut(self.size) {
            for (i, (a, scale)) in column.iter_mut().zip(&*scales).enumerate() {
                if rows(i) {
                    *a *= E::from_real(*scale);
                }
            }
        }
    }

    fn factor_plain(&mut self) -> f64 {
        let (n, a) = (self.size, &mut self.factors);
        let mut sign = 1.0;
        for (i, source) in self.source.iter_mut().enumerate() {
            *source = i;
        }
        for k in 0..n {
            let mut pivot = k;
            for i in k + 1..n {
                if a[k * n + i].modulus() > a[k * n + pivot].modulus() {
                    pivot = i;
                }
            }
            if pivot != k {
                sign = -sign;
                self.source.swap(k, pivot);
                for j in 0..n {
                    a.swap(j * n + k, j * n + pivot);
                }
            }
            let inverse = E::from_real(1.0) / a[k * n + k];
            let (left, right) = a.split_at_mut((k + 1) * n);
            let multipliers = &mut left[k * n + k + 1..];
            multipliers.iter_mut().for_each(|m| *m *= inverse);
            for column in right.chunks_exact_mut(n) {
                let top = column[k];
                for (a, m) in column[k + 1..].iter_mut().zip(multipliers.iter()) {
                    *a -= *m * top;
                }
            }
        }
        sign
    }

    fn factor_blocked(&mut self) -> f64 {
        let n = self.size;
        let Some(scratch) = self.scratch.as_mut() else { return 0.0 };
        let (info, _) = lu_in_place(
            MatMut::from_column_major_slice_mut(&mut self.factors, n, n),
            &mut self.source,
            &mut self.position,
            Par::Seq,
            MemStack::new(scratch),
            Default::default(),
        );
        if info.transposition_count.is_multiple_of(2) { 1.0 } else { -1.0 }
    }

    fn judge(&mut self) -> Result<(), Failure> {
        let (mut least, mut largest) = (f64::INFINITY, 0.0_f64);
        for k in 0..self.size {
            let pivot = self.factors[k * self.size + k];
            self.sign *= pivot.signum().real();
            let size = pivot.modulus();
            // Numbers after a zero pivot are NaN.
            if size.is_nan() {
                return Err(unusable(if least == 0.0 { least } else { size }, largest));
            }
            least = least.min(size);
            largest = largest.max(size);
        }
        let regular = self.size == 0 || least > SINGULAR * largest;
        if regular { Ok(()) } else { Err(unusable(least, largest)) }
    }
}

/// Rounding: Entries of scaled matrices count as rounding errors if they are smaller than this,
/// relative to 1.
const NOTHING: f64 = 1e-12;

/// Heuristic: Units that differ by less than this factor affect only the condition number of a
/// matrix.
const DIFFER: f64 = 1e3;

/// Whether units differ so much that the size of an entry does not reveal the size of the term to
/// which the entry belongs.
pub(in crate::core) fn differ(units: &[f64]) -> bool {
    let known = || units.iter().filter(|unit| **unit > 0.0);
    let [least, most] =
        [known().copied().fold(f64::MAX, f64::min), known().copied().fold(0.0, f64::max)];
    most > DIFFER * least
}

/// Solves `A x = b` for a dense matrix `A` that is given by its entries.
pub(in crate::core) fn solved(
    n: usize,
    entry: impl Fn(usize, usize) -> f64,
    right: impl Fn(usize) -> f64,
) -> Result<Vec<f64>, Failure> {
    let matrix: Vec<f64> = (0..n * n).map(|k| entry(k % n, k / n)).collect();
    let mut x: Vec<f64> = (0..n).map(right).collect();
    if n > 0 {
        let mut lu = BorderedLu::default();
        lu.factor(&matrix, Border::NONE)?;
        lu.solve(&mut x);
    }
    Ok(x)
}

/// Returns the entry `(i, j)` of the identity matrix.
pub(in crate::core) fn unit(i: usize, j: usize) -> f64 {
    if i == j { 1.0 } else { 0.0 }
}

/// Returns the inverse of the power of two that is nearest to a positive number on a logarithmic
/// scale; 1 for zero and for numbers that are not finite.
pub(super) fn inverse_power_of_two(largest: f64) -> f64 {
    if !(largest > 0.0 && largest.is_finite()) {
        return 1.0;
    }
    // A number in the format of IEEE 754: the exponent with bias 1023, and 52 bits of the fraction.
    // The exponent is rounded up from √2 on.
    let one = 1 << 52;
    let exponent = (largest.to_bits() + one - SQRT_2.to_bits() % one) / one;
    f64::from_bits(2046_u64.saturating_sub(exponent).max(1) * one)
}

pub(super) fn largest<E: Entry>(column: &[E]) -> f64 {
    column.iter().fold(0.0, |m, a| a.modulus().max(m))
}
