//! Factors of the sparse matrix of a periodic orbit, extended by a border.

use super::assembly::{AssembledJacobian, Bordered, Form};
use super::layout::UnknownLayout;
use super::sparse_orbit::SparseOrbit;
use crate::core::failure::Failure;
use crate::core::linalg::{Border, Factorisation, LANES, Lanes, Pencil, SparseLu, refill};
use std::sync::Arc;

/// The factors of the sparse matrix of a periodic orbit, for a real Floquet multiplier `μ`.
#[derive(Default)]
pub(super) struct SparseOrbitLu {
    lu: SparseLu,
    rows: Arc<[usize]>,
    /// The positions of the return conditions among the equations, and of `x(0)` among the unknowns.
    returns: Vec<[usize; 2]>,
    mu: f64,
    entries: Vec<f64>,
    border: [Vec<f64>; 3],
    right: Vec<f64>,
    lanes: Vec<[f64; LANES]>,
}

impl SparseOrbitLu {
    /// Factors the bordered matrix for a multiplier.
    ///
    /// # Errors
    /// [`Failure::Singular`] if the matrix is singular to working accuracy.
    pub fn factor(&mut self, sparse: &SparseOrbit, of: Bordered, mu: f64) -> Result<(), Failure> {
        self.mu = mu;
        self.factor_with(sparse, of, [mu, -1.0])
    }

    /// Factors the matrix of the initial-value problem: the return conditions are replaced by `x(0) =
    /// v`.
    ///
    /// # Errors
    /// [`Failure::Singular`] if the matrix is singular to working accuracy.
    pub fn factor_flow(
        &mut self,
        sparse: &SparseOrbit,
        (layout, assembled): (&UnknownLayout, &AssembledJacobian),
    ) -> Result<(), Failure> {
        let of = Bordered { layout, assembled, form: Form::Twisted, border: Border::NONE };
        self.factor_with(sparse, of, [1.0, 0.0])
    }

    fn factor_with(
        &mut self,
        sparse: &SparseOrbit,
        of: Bordered,
        ends: [f64; 2],
    ) -> Result<(), Failure> {
        let layout = of.layout;
        self.rows = sparse.rows.clone();
        refill(&mut self.returns, sparse.returns(layout));
        sparse.fill(ends, &mut self.entries);
        let width = self.fill_border(of);
        let [columns, rows, corner] = &self.border;
        let border = Border { width, columns, rows, corner, units: &[] };
        let pencil = Pencil { entries: &self.entries, mass: None };
        self.lu.factor(&sparse.elimination, (pencil, 0.0), border)
    }

    /// Fills the border: the extra unknowns and closing conditions, then the given border. Returns the
    /// border's width.
    fn fill_border(&mut self, Bordered { layout, assembled, form, border }: Bordered) -> usize {
        let (values, extras, active) = (layout.values(), layout.extras, assembled.active.len());
        let (dimension, below) = (layout.dimension, layout.conditions() + layout.boundary);
        let (width, twisted) = (extras + border.width, form == Form::Twisted);
        let [columns, rows, corner] = &mut self.border;
        [&mut *columns, &mut *rows]
            .into_iter()
            .for_each(|part| refill(part, std::iter::repeat_n(0.0, width * values)));
        refill(corner, std::iter::repeat_n(0.0, width * width));
        for c in 0..width {
            let column = &mut columns[c * values..(c + 1) * values];
            match c.checked_sub(extras) {
                None if twisted => {}
                None => {
                    let numbers = assembled.numbers[0].chunks_exact(active);
                    numbers.zip(&*self.rows).for_each(|(row, &at)| column[at] = row[c]);
                }
                Some(k) => {
                    let given = border.columns[k * dimension..].iter().zip(&*self.rows);
                    given.for_each(|(entry, &at)| column[at] = *entry);
                }
            }
        }
        for r in 0..width {
            let row = &mut rows[r * values..(r + 1) * values];
            match r.checked_sub(extras) {
                None if twisted => corner[r * width + r] = 1.0,
                None => {
                    let own = assembled.closing[r * values..].iter().zip(&layout.order);
                    own.for_each(|(entry, &at)| row[at] = *entry);
                    corner[r * width..][..extras]
                        .copy_from_slice(&assembled.closing_numbers[r * active..][..extras]);
                }
                Some(k) => {
                    let given = &border.rows[k * dimension..(k + 1) * dimension];
                    row.copy_from_slice(&given[..values]);
                    corner[r * width..][..extras].copy_from_slice(&given[values..]);
                    corner[r * width + extras..][..border.width]
                        .copy_from_slice(&border.corner[k * border.width..][..border.width]);
                }
            }
            for c in 0..border.width * usize::from(r < extras) {
                corner[r * width + extras + c] = border.columns[c * dimension + below + r];
            }
        }
        width
    }

    /// Replaces the states `x(0)`, several vectors side by side, by the states `x(1)` of the
    /// linearised flow; the matrix of the initial-value problem must be factored.
    pub fn flow(&mut self, layout: &UnknownLayout, states: &mut Lanes) {
        refill(&mut self.lanes, std::iter::repeat_n([0.0; LANES], layout.dimension));
        let last = layout.values() - layout.states;
        for (x, &at) in states.iter().zip(&layout.order) {
            self.lanes[at] = *x;
        }
        self.lu.solve_lanes(&mut self.lanes);
        for (x, &at) in states.iter_mut().zip(&layout.order[last..]) {
            *x = self.lanes[at];
        }
    }
}

impl Factorisation for SparseOrbitLu {
    fn solve(&mut self, right: &mut [f64]) {
        self.right.clear();
        self.right.extend_from_slice(right);
        right.iter().zip(&*self.rows).for_each(|(value, &at)| self.right[at] = *value);
        self.lu.solve(&mut self.right);
        right.copy_from_slice(&self.right);
    }

    fn solve_transposed(&mut self, right: &mut [f64]) {
        self.right.clear();
        self.right.extend_from_slice(right);
        self.lu.solve_transposed(&mut self.right);
        right.copy_from_slice(&self.right);
        right.iter_mut().zip(&*self.rows).for_each(|(value, &at)| *value = self.right[at]);
    }

    fn determinant_sign(&self) -> f64 {
        self.lu.determinant_sign()
    }

    /// Computes the product of `v` with the part of the matrix that is proportional to `μ = e^σ`.
    fn growth_derivative(&self, v: &[f64], out: &mut [f64]) {
        out.fill(0.0);
        self.returns.iter().for_each(|&[equation, unknown]| out[equation] = self.mu * v[unknown]);
    }

    fn growth_derivative_transposed(&self, w: &[f64], out: &mut [f64]) {
        out.fill(0.0);
        self.returns.iter().for_each(|&[equation, unknown]| out[unknown] = self.mu * w[equation]);
    }
}
