//! Matrices that are condensed to small dense matrices, and the factors of the dense matrices:
//! real, or complex for a Floquet multiplier `μ = e^{iω}`.
//!
//! ```text
//!     ⎡ U  * ⎤      U: by all eliminated unknowns, real for every μ
//!     ⎣ 0  D ⎦      D: dense, with μ in some of its entries
//! ```

use super::border::Border;
use super::factors::Factorisation;
use super::lu::BorderedLu;
use super::vector::refill;
use crate::core::failure::Failure;
use faer::c64;

/// A bordered matrix that elimination reduces to a small dense matrix `D`.
///
/// The reduced right-hand side is a vector that begins with the right-hand side of `D`; an
/// implementation may append values of its own.
pub(in crate::core) trait Condensed: Send + 'static {
    /// The data that determine the matrix and its border.
    type Matrix<'a>: Copy;

    /// Eliminates all unknowns of the matrix except the unknowns of `D`.
    ///
    /// # Errors
    /// [`Failure::Singular`] if the equations do not determine the eliminated unknowns.
    fn condense(&mut self, of: Self::Matrix<'_>) -> Result<(), Failure>;

    /// Returns the size of `D`, whose last unknowns are the unknowns of the border.
    fn side(&self) -> usize;

    /// Adds the entries of `D` for `μ = 1` to a matrix of zeros, stored column by column.
    fn place(&self, of: Self::Matrix<'_>, dense: &mut [f64]);

    /// For every entry that is multiplied by `μ`, calls `visit` with two arguments: the row and
    /// column of the entry in `D`, and its equation and unknown in the whole matrix.
    fn visit_returns(&self, visit: &mut dyn FnMut([usize; 2], [usize; 2]));

    /// Eliminates unknowns from a right-hand side, in place; `left` becomes the reduced right-hand
    /// side.
    fn forward(&mut self, right: &mut [f64], left: &mut Vec<f64>);

    /// Computes all unknowns from the unknowns of `D`, which are stored in `left`; `right` is the
    /// output of [`forward`](Self::forward).
    fn back(&mut self, right: &mut [f64], left: &mut Vec<f64>);

    /// Eliminates unknowns like [`forward`](Self::forward), for the transposed matrix, and stores
    /// the result for `back_transposed`.
    fn forward_transposed(&mut self, right: &[f64], left: &mut Vec<f64>);

    /// Computes all unknowns like [`back`](Self::back), for the transposed matrix, after a call of
    /// `forward_transposed`.
    fn back_transposed(&mut self, right: &mut [f64], left: &mut Vec<f64>);

    /// Returns the sign of the determinant of the upper triangular factor `U`, up to a factor that
    /// depends only on sizes.
    fn determinant_sign(&self) -> f64;
}

/// The factors of a condensed matrix with a real `μ`.
#[derive(Default)]
pub(in crate::core) struct CondensedLu<C> {
    /// The eliminated part of the matrix, without `D`.
    pub condensed: C,
    mu: f64,
    lu: BorderedLu,
    left: Vec<f64>,
    units: Vec<f64>,
}

impl<C: Condensed> CondensedLu<C> {
    /// Creates an empty factorisation.
    pub fn new(condensed: C) -> Self {
        let (left, units) = Default::default();
        CondensedLu { condensed, mu: 1.0, lu: Default::default(), left, units }
    }

    /// Factors a matrix, given the typical sizes of the first unknowns of `D`; the sizes of the
    /// remaining unknowns of `D` are unknown, and all sizes are unknown if `units` is empty.
    ///
    /// # Errors
    /// [`Failure::Singular`] if the matrix is singular to working accuracy.
    pub fn factor(&mut self, of: C::Matrix<'_>, mu: f64, units: &[f64]) -> Result<(), Failure> {
        self.mu = mu;
        self.condensed.condense(of)?;
        let side = self.condensed.side();
        let room = self.lu.room(side);
        room.fill(0.0);
        self.condensed.place(of, room);
        self.condensed.visit_returns(&mut |[row, column], _| room[column * side + row] += mu - 1.0);
        self.lu.factor_room(in_side(units, side, &mut self.units))
    }
}

/// Extends the list of known sizes from the first unknowns to all unknowns; returns an empty list
/// if no sizes are known.
fn in_side<'a>(units: &[f64], side: usize, all: &'a mut Vec<f64>) -> &'a [f64] {
    refill(all, units.iter().copied());
    if !units.is_empty() {
        all.resize(side, 0.0);
    }
    all
}

impl<C: Condensed> Factorisation for CondensedLu<C> {
    fn solve(&mut self, right: &mut [f64]) {
        self.condensed.forward(right, &mut self.left);
        self.lu.solve(&mut self.left[..self.condensed.side()]);
        self.condensed.back(right, &mut self.left);
    }

    fn solve_transposed(&mut self, right: &mut [f64]) {
        self.condensed.forward_transposed(right, &mut self.left);
        self.lu.solve_transposed(&mut self.left[..self.condensed.side()]);
        self.condensed.back_transposed(right, &mut self.left);
    }

    fn determinant_sign(&self) -> f64 {
        self.condensed.determinant_sign() * self.lu.determinant_sign()
    }

    /// Computes the product of `v` with the part of the matrix that is proportional to `μ`, which
    /// is the derivative of the matrix with respect to `σ` for `μ = e^σ`.
    fn growth_derivative(&self, v: &[f64], out: &mut [f64]) {
        out.fill(0.0);
        self.condensed.visit_returns(&mut |_, [equation, unknown]| {
            out[equation] = self.mu * v[unknown];
        });
    }

    fn growth_derivative_transposed(&self, w: &[f64], out: &mut [f64]) {
        out.fill(0.0);
        self.condensed.visit_returns(&mut |_, [equation, unknown]| {
            out[unknown] += self.mu * w[equation];
        });
    }
}

/// The factors of a condensed matrix with `μ = e^{iω}`, bordered by a complex column `b` and a
/// complex row `c*`.
///
/// The complex column is eliminated as two real columns, `b_r` and `b_i`, and the complex row as
/// two real rows: `b g = (b_r g_r − b_i g_i) + i (b_r g_i + b_i g_r)`.
#[derive(Default)]
pub(in crate::core) struct RotatedLu<C> {
    /// The eliminated part of the matrix, without `D`.
    pub condensed: C,
    omega: f64,
    lu: BorderedLu<c64>,
    /// The matrix `D` with the real border of width 2, then the right-hand side of the complex
    /// system.
    matrix: Vec<f64>,
    dense: Vec<c64>,
    /// The real and imaginary parts of a right-hand side, and of the reduced right-hand side.
    parts: [Vec<f64>; 2],
    left: [Vec<f64>; 2],
    units: Vec<f64>,
}

impl<C: Condensed> RotatedLu<C> {
    /// Creates an empty factorisation.
    pub fn new(condensed: C) -> Self {
        let (lu, matrix, dense) = Default::default();
        let (parts, left, units) = Default::default();
        RotatedLu { condensed, omega: 0.0, lu, matrix, dense, parts, left, units }
    }

    /// Converts a complex border of width 1 to a real border of width 2.
    pub fn border(border: Border<'_>) -> Border<'_> {
        Border { width: 2, corner: &[0.0; 4], ..border }
    }

    /// Factors a bordered matrix, with the [`border`](Self::border) and with sizes of unknowns as
    /// in [`CondensedLu`].
    ///
    /// # Errors
    /// [`Failure::Singular`] if the matrix is singular to working accuracy.
    pub fn factor(&mut self, of: C::Matrix<'_>, omega: f64, units: &[f64]) -> Result<(), Failure> {
        self.omega = omega;
        self.condensed.condense(of)?;
        let real = self.condensed.side();
        self.matrix.clear();
        self.matrix.resize(real * real, 0.0);
        self.condensed.place(of, &mut self.matrix);
        let (last, side) = (real - 2, real - 1);
        // The last column is `b_r + i b_i`, the last row `c_r − i c_i`.
        let entry = |i: usize, j: usize| self.matrix[j * real + i];
        let room = self.lu.room(side);
        for (k, target) in room.iter_mut().enumerate() {
            let (i, j) = (k % side, k / side);
            *target = match (i == last, j == last) {
                (false, false) => c64::new(entry(i, j), 0.0),
                (false, true) => c64::new(entry(i, last), entry(i, last + 1)),
                (true, false) => c64::new(entry(last, j), -entry(last + 1, j)),
                (true, true) => c64::new(
                    entry(last, last) + entry(last + 1, last + 1),
                    entry(last, last + 1) - entry(last + 1, last),
                ),
            };
        }
        let returned = c64::new(omega.cos() - 1.0, omega.sin());
        self.condensed.visit_returns(&mut |[i, j], _| room[side * j + i] += returned);
        self.lu.factor_room(in_side(units, side, &mut self.units))
    }

    /// Solves linear systems with the matrix, or with its conjugate transpose, in place.
    fn solve_with(&mut self, right: &mut [f64], transposed: bool) {
        let RotatedLu { condensed, lu, dense, parts, left, .. } = self;
        let (length, last) = (right.len() / 2, condensed.side() - 2);
        let (real, imaginary) = right.split_at_mut(length);
        let g = [real[length - 1], imaginary[length - 1]];
        for ((part, left), given) in parts.iter_mut().zip(&mut *left).zip([&*real, &*imaginary]) {
            // Space for the two real unknowns of the border.
            given[..length - 1].clone_into(part);
            part.extend([0.0, 0.0]);
            match transposed {
                true => condensed.forward_transposed(part, left),
                false => condensed.forward(part, left),
            }
        }
        let [a, b] = &*left;
        refill(dense, a[..last].iter().zip(b).map(|(re, im)| c64::new(*re, *im)));
        dense.push(c64::new(g[0] + a[last] + b[last + 1], g[1] + b[last] - a[last + 1]));
        match transposed {
            true => lu.solve_transposed(dense),
            false => lu.solve(dense),
        }
        let g = dense[last];
        for (k, (part, out)) in parts.iter_mut().zip([real, imaginary]).enumerate() {
            if transposed {
                // The condensed matrix stores one elimination only.
                condensed.forward_transposed(part, &mut left[k]);
            }
            let own = |value: &c64| if k == 0 { value.re } else { value.im };
            left[k].iter_mut().zip(&*dense).for_each(|(end, value)| *end = own(value));
            left[k][last + 1] = if k == 0 { -g.im } else { g.re };
            match transposed {
                true => condensed.back_transposed(part, &mut left[k]),
                false => condensed.back(part, &mut left[k]),
            }
            out[..length - 1].copy_from_slice(&part[..length - 1]);
            out[length - 1] = own(&g);
        }
    }
}

impl<C: Condensed> Factorisation for RotatedLu<C> {
    fn solve(&mut self, right: &mut [f64]) {
        self.solve_with(right, false);
    }

    fn solve_transposed(&mut self, right: &mut [f64]) {
        self.solve_with(right, true);
    }

    fn determinant_sign(&self) -> f64 {
        1.0
    }

    /// Computes the product of a complex vector `v` with the part of the matrix that is
    /// proportional to `μ`, which is the derivative of the matrix with respect to `σ` for `μ =
    /// e^σ`.
    fn growth_derivative(&self, v: &[f64], out: &mut [f64]) {
        out.fill(0.0);
        self.condensed.visit_returns(&mut |_, place| rotate(self.omega, place, v, out));
    }
}

/// Multiplies the component `unknown` of the complex vector `v` by `e^{iω}`, and writes the product
/// to the component `equation` of `out`.
pub(in crate::core) fn rotate(
    omega: f64,
    [equation, unknown]: [usize; 2],
    v: &[f64],
    out: &mut [f64],
) {
    let (length, (sine, cosine)) = (v.len() / 2, omega.sin_cos());
    let (re, im) = (v[unknown], v[length + unknown]);
    out[equation] = cosine * re - sine * im;
    out[length + equation] = sine * re + cosine * im;
}
