//! The linearised motion about an equilibrium, in real arithmetic of twice the size.

use super::lu::BorderedLu;
use crate::core::failure::Failure;
use crate::core::zero::{Border, Oscillation};

/// [`Oscillation`] of a dense matrix `A`: `L = A − iω`.
#[derive(Default)]
pub(crate) struct DenseOscillation {
    matrix: Vec<f64>,
    doubled: Vec<f64>,
    columns: Vec<f64>,
    rows: Vec<f64>,
    work: Vec<f64>,
    lu: BorderedLu,
}

impl DenseOscillation {
    /// That of this matrix, one column after the other.
    pub fn of(&mut self, matrix: &[f64]) -> &mut Self {
        self.matrix.clear();
        self.matrix.extend_from_slice(matrix);
        self
    }

    /// The border's unknown comes after its part of the vector outside, after both parts inside.
    fn permuted(&mut self, right: &mut [f64], solve: impl Fn(&mut BorderedLu, &mut [f64])) {
        let n = right.len() / 2 - 1;
        self.work.clear();
        self.work.extend_from_slice(&right[..n]);
        self.work.extend_from_slice(&right[n + 1..2 * n + 1]);
        self.work.extend([right[n], right[2 * n + 1]]);
        solve(&mut self.lu, &mut self.work);
        right[..n].copy_from_slice(&self.work[..n]);
        right[n + 1..2 * n + 1].copy_from_slice(&self.work[n..2 * n]);
        (right[n], right[2 * n + 1]) = (self.work[2 * n], self.work[2 * n + 1]);
    }
}

impl Oscillation for DenseOscillation {
    fn factor(&mut self, omega: f64, column: &[f64], row: &[f64]) -> Result<(), Failure> {
        let n = self.matrix.len().isqrt();
        let size = 2 * n;
        self.doubled.clear();
        self.doubled.resize(size * size, 0.0);
        for j in 0..n {
            for i in 0..n {
                let entry = self.matrix[j * n + i];
                self.doubled[j * size + i] = entry;
                self.doubled[(n + j) * size + n + i] = entry;
            }
            self.doubled[(n + j) * size + j] = omega;
            self.doubled[j * size + n + j] = -omega;
        }
        // Columns b·1 and b·i; rows of c*·v, real and imaginary part.
        for (pair, given) in [(&mut self.columns, column), (&mut self.rows, row)] {
            pair.clear();
            pair.extend_from_slice(given);
            pair.extend(given[n..].iter().map(|imaginary| -imaginary));
            pair.extend_from_slice(&given[..n]);
        }
        let border =
            Border { width: 2, columns: &self.columns, rows: &self.rows, corner: &[0.0; 4] };
        self.lu.factor(&self.doubled, border)
    }

    fn solve(&mut self, right: &mut [f64]) {
        self.permuted(right, BorderedLu::solve);
    }

    fn solve_transposed(&mut self, right: &mut [f64]) {
        self.permuted(right, BorderedLu::solve_transposed);
    }

    /// `∂L/∂ω v = −i v`.
    fn slope(&mut self, _omega: f64, v: &[f64], out: &mut [f64]) {
        let n = v.len() / 2;
        for i in 0..n {
            (out[i], out[n + i]) = (v[n + i], -v[i]);
        }
    }
}
