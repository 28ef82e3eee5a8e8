//! The inverse of a shifted sparse matrix, applied to blocks of vectors.

use super::block::{Block, LANES};
use super::{Elimination, Pencil, SparseLu};
use crate::core::failure::Failure;
use crate::core::linalg::{Border, generic, largest};
use std::sync::Arc;

/// Rounding: if a shift equals an eigenvalue, the shift is changed by this fraction of the largest
/// entry of the matrix.
const ASIDE: f64 = 1e-10;

/// Rounding: the inverse in a border is used if a solution is at least as large as this fraction of its
/// terms.
const REMAINING: f64 = 1e-6;

/// A sparse matrix whose eigenvalues are computed.
pub(super) struct Matrix<'a> {
    pub elimination: &'a Arc<Elimination>,
    pub pencil: Pencil<'a>,
    /// The diagonal scales that make the matrix symmetric; `None` if no such scales are known.
    pub scales: Option<&'a [f64]>,
}

impl Matrix<'_> {
    pub fn size(&self) -> usize {
        self.elimination.pattern.size()
    }

    /// Multiplies the vectors of a block by the mass matrix.
    fn times_mass(&self, block: &mut Block) {
        let (Some(mass), pattern) = (self.pencil.mass, &self.elimination.pattern) else { return };
        let mut products = vec![[0.0; LANES]; block.len()];
        for (j, row) in block.iter().enumerate() {
            for (m, &i) in mass[pattern.start(j)..].iter().zip(pattern.column(j)) {
                products[i].iter_mut().zip(row).for_each(|(sum, v)| *sum += m * v);
            }
        }
        block.copy_from_slice(&products);
    }
}

/// The inverse of a sparse matrix `A − σ M` with a shift `σ`.
pub(super) struct Inverse<'a> {
    pub matrix: Matrix<'a>,
    lu: &'a mut SparseLu,
    shift: f64,
    /// The inverse for the shift 0 in a border, which replaces the factors `lu`.
    in_border: Option<InBorder<'a>>,
}

impl<'a> Inverse<'a> {
    /// Creates the inverse for the shift 0, or for a shift near 0 if the matrix is singular. If the
    /// factors of the same matrix in a border are known, these factors are used; otherwise, the
    /// matrix is factored.
    ///
    /// # Errors
    /// [`Failure`] if an entry of the matrix is not finite, or if the matrix is singular for both shifts.
    pub fn near_zero(
        matrix: Matrix<'a>,
        lu: &'a mut SparseLu,
        known: Option<&'a mut SparseLu>,
    ) -> Result<Self, Failure> {
        let n = matrix.size();
        let counts = |lu: &&mut SparseLu| matrix.scales.is_none() || lu.negative_pivots().is_some();
        let in_border = known.filter(counts).and_then(|lu| InBorder::new(lu, n));
        let is_known = in_border.is_some();
        let mut inverse = Inverse { matrix, lu, shift: 0.0, in_border };
        if !is_known && inverse.factor(0.0).is_err() {
            let Pencil { entries, mass } = inverse.matrix.pencil;
            let unit = mass.map_or(1.0, largest).max(f64::MIN_POSITIVE);
            inverse.factor(ASIDE * largest(entries) / unit)?;
        }
        Ok(inverse)
    }

    /// Returns the shift.
    pub fn shift(&self) -> f64 {
        self.shift
    }

    /// Changes the shift.
    ///
    /// # Errors
    /// [`Failure`] if the shifted matrix is singular to working accuracy.
    pub fn move_to(&mut self, shift: f64) -> Result<(), Failure> {
        if shift == self.shift { Ok(()) } else { self.factor(shift) }
    }

    fn factor(&mut self, shift: f64) -> Result<(), Failure> {
        // After an error, no shift counts as factored.
        (self.shift, self.in_border) = (f64::NAN, None);
        let shifted = (self.matrix.pencil, shift);
        match self.matrix.scales {
            Some(_) => self.lu.factor_symmetric(self.matrix.elimination, shifted)?,
            None => self.lu.factor(self.matrix.elimination, shifted, Border::NONE)?,
        }
        self.shift = shift;
        Ok(())
    }

    /// Returns the number of eigenvalues below the shift, if a diagonal scaling makes the matrix
    /// symmetric and all pivots lie on the diagonal.
    pub fn count_below(&self) -> Option<usize> {
        self.matrix.scales?;
        self.in_border.as_ref().map_or(&*self.lu, |it| &*it.lu).negative_pivots()
    }

    /// Replaces the vectors `v` of a block by `(A − σ M)⁻¹ M v`.
    pub fn apply(&mut self, block: &mut Block) {
        self.matrix.times_mass(block);
        match &mut self.in_border {
            Some(in_border) => in_border.solve(block),
            None => self.lu.solve_lanes(block),
        }
    }
}

/// The inverse of a matrix `A` whose factors are known in a border of width 1:
///
/// ```text
///     ⎡ A  b ⎤ ⎡ y  v ⎤   ⎡ f  0 ⎤
///     ⎣ c  d ⎦ ⎣ μ  ν ⎦ = ⎣ 0  1 ⎦
/// ```
///
/// The solution of `A x = f` is `x = y − (μ/ν) v`.
struct InBorder<'a> {
    lu: &'a mut SparseLu,
    /// The vector `v`, divided by `ν`.
    v: Vec<f64>,
    right: Vec<[f64; LANES]>,
}

impl<'a> InBorder<'a> {
    /// Returns `None` if the border does not have width 1, or if the two terms of a solution `x` cancel
    /// each other, so that `x` loses digits.
    fn new(lu: &'a mut SparseLu, n: usize) -> Option<Self> {
        if lu.size() != n + 1 {
            return None;
        }
        let mut both: Vec<[f64; 2]> = generic(n, 0).into_iter().map(|f| [f, 0.0]).collect();
        both.push([0.0, 1.0]);
        lu.solve_lanes(&mut both);
        let [mu, nu] = both.pop()?;
        let v: Vec<f64> = both.iter().map(|row| row[1] / nu).collect();
        let x: Vec<f64> = both.iter().zip(&v).map(|(row, v)| row[0] - mu * v).collect();
        let y = both.iter().fold(0.0, |most: f64, row| most.max(row[0].abs()));
        // A comparison with NaN is false.
        let is_accurate = largest(&x) >= REMAINING * y && largest(&x).is_finite();
        is_accurate.then_some(InBorder { lu, v, right: Vec::new() })
    }

    fn solve(&mut self, block: &mut Block) {
        self.right.clear();
        self.right.extend_from_slice(block);
        self.right.push([0.0; LANES]);
        self.lu.solve_lanes(&mut self.right);
        let Some((mu, y)) = self.right.split_last() else { return };
        for ((x, y), v) in block.iter_mut().zip(y).zip(&self.v) {
            for lane in 0..LANES {
                x[lane] = y[lane] - mu[lane] * v;
            }
        }
    }
}
