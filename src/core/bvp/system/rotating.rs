//! Linearisations of complex multipliers.

use super::factorisation::{Factorisation, Left, form_of};
use super::layout::Layout;
use super::linearisation::{Bordered, Linearisation};
use crate::core::failure::Failure;
use crate::core::linear::{self, BorderedLu};
use crate::core::vector::refill;
use crate::core::zero::Border;
use faer::c64;
use std::sync::Arc;

/// The factored linearisation of a complex multiplier, within a complex column and row.
///
/// A complex column `b` is two real ones, `b_r` and `b_i`, which the chains eliminate
/// independently: `b g = (b_r g_r − b_i g_i) + i (b_r g_i + b_i g_r)`. So is the row `c*`.
pub(super) struct Rotating {
    factors: Factorisation,
    omega: f64,
    lu: BorderedLu<c64>,
    right: Vec<c64>,
    /// Real and imaginary parts of a right side, and what the chains leave of them.
    parts: [Vec<f64>; 2],
    left: [Left; 2],
}

impl Rotating {
    pub fn new(layout: &Arc<Layout>) -> Self {
        let (lu, right, parts, left) = Default::default();
        Rotating { factors: Factorisation::new(layout), omega: 0.0, lu, right, parts, left }
    }

    pub fn layout(&self) -> &Arc<Layout> {
        &self.factors.layout
    }

    pub fn factor(
        &mut self,
        assembled: &Linearisation,
        omega: f64,
        border: Border,
    ) -> Result<(), Failure> {
        self.omega = omega;
        let layout = &*self.layout().clone();
        let border = Border { width: 2, corner: &[0.0; 4], ..border };
        let of = Bordered { layout, assembled, form: form_of(layout), border };
        self.factors.condense(of)?;
        self.factors.place(of, 1.0);
        let last = self.factors.left().dense.len() - 2;
        let size = last + 1;
        // The last column is `b_r + i b_i`, the last row `c_r − i c_i`.
        let entry = |i, j| self.factors.entry(i, j);
        for (k, target) in self.lu.room(size).iter_mut().enumerate() {
            let (i, j) = (k % size, k / size);
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
        for r in &layout.returns {
            let (i, j) = layout.place(r);
            self.lu.room(size)[size * j + i] += returned;
        }
        let mut units = assembled.units.clone();
        if !units.is_empty() {
            units.resize(size, 0.0);
        }
        self.lu.factor_room(&units)
    }

    /// Solves with the matrix, or with its conjugate transposed, in place.
    fn solve_with(&mut self, right: &mut [f64], transposed: bool) {
        let Rotating { factors, lu, right: dense, parts, left, .. } = self;
        let length = right.len() / 2;
        let (real, imaginary) = right.split_at_mut(length);
        let g = [real[length - 1], imaginary[length - 1]];
        for ((part, left), given) in parts.iter_mut().zip(&mut *left).zip([&*real, &*imaginary]) {
            // Room for the two real unknowns of the border.
            given[..length - 1].clone_into(part);
            part.extend([0.0, 0.0]);
            match transposed {
                true => factors.forward_transposed(part),
                false => factors.forward(part),
            }
            left.dense.clone_from(&factors.left().dense);
            left.joined.clone_from(&factors.left().joined);
        }
        let last = left[0].dense.len() - 2;
        let [a, b] = [&left[0].dense, &left[1].dense];
        refill(dense, a[..last].iter().zip(b).map(|(re, im)| c64::new(*re, *im)));
        dense.push(c64::new(g[0] + a[last] + b[last + 1], g[1] + b[last] - a[last + 1]));
        match transposed {
            true => lu.solve_transposed(dense),
            false => lu.solve(dense),
        }
        let g = dense[last];
        for (k, (part, out)) in parts.iter_mut().zip([real, imaginary]).enumerate() {
            if transposed {
                // The chains remember one elimination only.
                factors.forward_transposed(part);
            }
            let own = |value: &c64| if k == 0 { value.re } else { value.im };
            factors.left().joined.clone_from(&left[k].joined);
            let ends = &mut factors.left().dense;
            ends.iter_mut().zip(&*dense).for_each(|(end, value)| *end = own(value));
            ends[last + 1] = if k == 0 { -g.im } else { g.re };
            match transposed {
                true => factors.back_transposed(part),
                false => factors.back(part),
            }
            out[..length - 1].copy_from_slice(&part[..length - 1]);
            out[length - 1] = own(&g);
        }
    }
}

impl linear::Factorisation for Rotating {
    fn solve(&mut self, right: &mut [f64]) {
        self.solve_with(right, false);
    }

    fn solve_transposed(&mut self, right: &mut [f64]) {
        self.solve_with(right, true);
    }

    fn determinant_sign(&self) -> f64 {
        1.0
    }

    /// `i e^{iω} v` in the rows of the returns.
    fn frequency_derivative(&self, v: &[f64], out: &mut [f64]) {
        let layout = self.layout();
        let (length, first) = (v.len() / 2, layout.conditions());
        let (sine, cosine) = self.omega.sin_cos();
        out.fill(0.0);
        for r in &layout.returns {
            let z = layout.position(r.unknown);
            let (re, im) = (v[z], v[length + z]);
            out[first + r.condition] = -sine * re - cosine * im;
            out[length + first + r.condition] = cosine * re - sine * im;
        }
    }
}
