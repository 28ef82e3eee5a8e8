//! Factors of the sparse matrix of a periodic orbit for a complex Floquet multiplier `e^{iω}`, extended
//! by a complex border.

use super::layout::UnknownLayout;
use super::sparse_orbit::SparseOrbit;
use crate::core::failure::Failure;
use crate::core::linalg::{Border, Factorisation, Pencil, SparseShiftedLu, refill, rotate};
use std::sync::Arc;

/// The factors of the sparse matrix of a periodic orbit with the return conditions `x(1) = e^{iω}
/// x(0)`. Extra unknowns, such as the period, are zero: their equations are solved separately, and the
/// border does not contain these unknowns.
///
/// Complex vectors consist of the real parts of all components, followed by the imaginary parts.
#[derive(Default)]
pub(super) struct RotatedSparseLu {
    lu: SparseShiftedLu,
    rows: Arc<[usize]>,
    /// The positions of the return conditions among the equations, and of `x(0)` among the unknowns.
    returns: Vec<[usize; 2]>,
    omega: f64,
    /// The width of the border.
    width: usize,
    /// The matrices `A` and `M` of the factored matrix `A − i M`.
    pencil: [Vec<f64>; 2],
    border: [Vec<f64>; 2],
    right: Vec<f64>,
}

impl RotatedSparseLu {
    /// Factors the bordered matrix for the multiplier `e^{iω}`.
    ///
    /// # Errors
    /// [`Failure::Singular`] if the matrix is singular to working accuracy.
    pub fn factor(
        &mut self,
        sparse: &SparseOrbit,
        layout: &UnknownLayout,
        omega: f64,
        border: Border,
    ) -> Result<(), Failure> {
        (self.omega, self.width) = (omega, border.width);
        self.rows = sparse.rows.clone();
        refill(&mut self.returns, sparse.returns(layout));
        let [entries, mass] = &mut self.pencil;
        sparse.fill([omega.cos(), -1.0], entries);
        sparse.fill_returns(-omega.sin(), mass);
        let (values, dimension) = (layout.values(), layout.dimension);
        let [columns, rows] = &mut self.border;
        refill(columns, std::iter::repeat_n(0.0, 2 * border.width * values));
        refill(rows, std::iter::repeat_n(0.0, 2 * border.width * values));
        let given = border.columns.chunks_exact(dimension);
        for (column, given) in columns.chunks_exact_mut(values).zip(given) {
            given.iter().zip(&*self.rows).for_each(|(entry, &at)| column[at] = *entry);
        }
        let given = border.rows.chunks_exact(dimension);
        for (row, given) in rows.chunks_exact_mut(values).zip(given) {
            row.copy_from_slice(&given[..values]);
        }
        let border = Border { columns, rows, ..border };
        let pencil = Pencil { entries, mass: Some(mass) };
        self.lu.factor(&sparse.elimination, (pencil, 1.0), border)
    }

    /// Solves with the matrix, or with its conjugate transpose, in place.
    fn solve_with(&mut self, right: &mut [f64], transposed: bool) {
        let (values, length) = (self.rows.len(), right.len() / 2);
        let border = length - self.width..length;
        self.right.clear();
        for part in right.chunks_exact(length) {
            let start = self.right.len();
            self.right.extend_from_slice(&part[..values]);
            self.right.extend_from_slice(&part[border.clone()]);
            if !transposed {
                let own = &mut self.right[start..];
                part.iter().zip(&*self.rows).for_each(|(value, &at)| own[at] = *value);
            }
        }
        match transposed {
            true => self.lu.solve_transposed(&mut self.right),
            false => self.lu.solve(&mut self.right),
        }
        let solved = self.right.chunks_exact(values + border.len());
        for (part, solved) in right.chunks_exact_mut(length).zip(solved) {
            part[border.clone()].copy_from_slice(&solved[values..]);
            match transposed {
                true => {
                    let own = part.iter_mut().zip(&*self.rows);
                    own.for_each(|(value, &at)| *value = solved[at]);
                }
                false => part[..values].copy_from_slice(&solved[..values]),
            }
        }
    }
}

impl Factorisation for RotatedSparseLu {
    fn solve(&mut self, right: &mut [f64]) {
        self.solve_with(right, false);
    }

    fn solve_transposed(&mut self, right: &mut [f64]) {
        self.solve_with(right, true);
    }

    fn determinant_sign(&self) -> f64 {
        1.0
    }

    /// Computes the product of a complex vector `v` with the part of the matrix that is proportional
    /// to `μ = e^{iω}`.
    fn growth_derivative(&self, v: &[f64], out: &mut [f64]) {
        out.fill(0.0);
        self.returns.iter().for_each(|place| rotate(self.omega, *place, v, out));
    }
}
