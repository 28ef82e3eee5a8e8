//! Linearisations of complex multipliers.

use super::factorisation::{Bordered, Factorisation, column_of, form_of};
use super::layout::Layout;
use super::linearisation::Linearisation;
use crate::core::failure::Failure;
use crate::core::linear::BorderedLu;
use crate::core::zero::Border;

/// The factored linearisation of a complex multiplier, within a complex column and row.
///
/// A complex column `b` is two real ones, `b_r` and `b_i`, which the chains eliminate independently:
/// `b g = (b_r g_r − b_i g_i) + i (b_r g_i + b_i g_r)`. So is the row `c*`.
#[derive(Default)]
pub(super) struct Rotating {
    factors: Factorisation,
    /// The dense complex matrix in real arithmetic of twice its size, one column after the other.
    matrix: Vec<f64>,
    lu: BorderedLu,
    right: Vec<f64>,
    /// Real and imaginary parts of a right side, and what the chains leave of them.
    parts: [Vec<f64>; 2],
    left: [Vec<f64>; 2],
}

impl Rotating {
    pub fn new(layout: &Layout) -> Self {
        Rotating { factors: Factorisation::new(layout), ..Default::default() }
    }

    pub fn factor(
        &mut self,
        layout: &Layout,
        assembled: &Linearisation,
        omega: f64,
        column: &[f64],
        row: &[f64],
    ) -> Result<(), Failure> {
        let border = Border { width: 2, columns: column, rows: row, corner: &[0.0; 4] };
        let of = Bordered { layout, assembled, form: form_of(layout), border };
        self.factors.condense(of)?;
        self.factors.place(of, &assembled.boundary);
        let last = self.factors.dense().len() - 2;
        let size = last + 1;
        self.matrix.clear();
        self.matrix.resize(4 * size * size, 0.0);
        for i in 0..size {
            for j in 0..size {
                let entry = self.complex_entry(i, j, last);
                self.add(size, (i, j), entry);
            }
        }
        for r in &layout.returns {
            let place = (layout.states + r.condition, column_of(layout, r.unknown));
            self.add(size, place, (omega.cos() - 1.0, omega.sin()));
        }
        let mut units = assembled.units.clone();
        if !units.is_empty() {
            units.resize(size, 0.0);
            units.extend_from_within(..);
        }
        self.lu.factor_in_units(&self.matrix, Border::NONE, &units)
    }

    /// Adds to an entry of the complex matrix.
    fn add(&mut self, size: usize, (i, j): (usize, usize), (re, im): (f64, f64)) {
        self.matrix[2 * size * j + i] += re;
        self.matrix[2 * size * (size + j) + size + i] += re;
        self.matrix[2 * size * j + size + i] += im;
        self.matrix[2 * size * (size + j) + i] -= im;
    }

    /// An entry of the complex matrix: its last column is `b_r + i b_i`, its last row `c_r − i c_i`.
    fn complex_entry(&self, i: usize, j: usize, last: usize) -> (f64, f64) {
        let entry = |i, j| self.factors.entry(i, j);
        match (i == last, j == last) {
            (false, false) => (entry(i, j), 0.0),
            (false, true) => (entry(i, last), entry(i, last + 1)),
            (true, false) => (entry(last, j), -entry(last + 1, j)),
            (true, true) => (
                entry(last, last) + entry(last + 1, last + 1),
                entry(last, last + 1) - entry(last + 1, last),
            ),
        }
    }

    /// Solves with the matrix, or with its conjugate transposed, in place.
    pub fn solve(&mut self, layout: &Layout, right: &mut [f64], transposed: bool) {
        let Rotating { factors, lu, right: dense, parts, left, .. } = self;
        let length = right.len() / 2;
        let (real, imaginary) = right.split_at_mut(length);
        let g = [real[length - 1], imaginary[length - 1]];
        for ((part, left), given) in parts.iter_mut().zip(&mut *left).zip([&*real, &*imaginary]) {
            // Room for the two real unknowns of the border.
            part.clear();
            part.extend_from_slice(&given[..length - 1]);
            part.extend([0.0, 0.0]);
            match transposed {
                true => factors.forward_transposed(layout, part),
                false => factors.forward(layout, part),
            }
            left.clone_from(factors.dense());
        }
        let last = left[0].len() - 2;
        let [a, b] = &*left;
        dense.clear();
        dense.extend_from_slice(&a[..last]);
        dense.push(g[0] + a[last] + b[last + 1]);
        dense.extend_from_slice(&b[..last]);
        dense.push(g[1] + b[last] - a[last + 1]);
        match transposed {
            true => lu.solve_transposed(dense),
            false => lu.solve(dense),
        }
        let (re, im) = dense.split_at(last + 1);
        for (k, (part, out)) in parts.iter_mut().zip([real, imaginary]).enumerate() {
            if transposed {
                // The chains remember one elimination only.
                factors.forward_transposed(layout, part);
            }
            let (own, pair) =
                if k == 0 { (re, [re[last], -im[last]]) } else { (im, [im[last], re[last]]) };
            let ends = factors.dense();
            ends[..last].copy_from_slice(&own[..last]);
            ends[last..].copy_from_slice(&pair);
            match transposed {
                true => factors.back_transposed(layout, part),
                false => factors.back(layout, part),
            }
            out[..length - 1].copy_from_slice(&part[..length - 1]);
            out[length - 1] = own[last];
        }
    }
}
