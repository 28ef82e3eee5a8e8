//! Condensation of a chain of intervals: the linear algebra of boundary-value problems.
//!
//! A discretised boundary-value problem couples the values of `n` states at the `m + 1` nodes of each
//! of `N` intervals; neighbouring intervals share a node (collocation with `m` points; shooting with
//! `m = 1`). The matrix `M` of the discretised problem is a bordered chain of blocks:
//!
//! ```text
//!     ⎡ chain: N·m·n equations by (N·m + 1)·n values  │  k columns ⎤
//!     ⎣ l rows                                        │  corner    ⎦
//! ```
//!
//! Interval `i` has `m·n` equations in the values at nodes `i·m … (i + 1)·m`. [`Chain`] eliminates
//! all values except `x_0` and `x_N` at the ends, interval by interval, at a cost linear in `N`.
//! The first pivots eliminate the nodes inside an interval and come from the interval's own
//! equations; then the node shared with the previous interval is eliminated, with pivots from the
//! `2n` remaining equations of both intervals (Ascher, Mattheij & Russell 1995, ch. 7; Fairgrieve &
//! Jepson 1991). The elimination is Gaussian elimination with row exchanges, applied to the chain
//! as a whole: neither transfer matrices nor their products are formed, so that growing and
//! decaying solutions along the chain are both preserved. The matrix `E` of row operations
//! transforms the matrix `M` as follows:
//!
//! ```text
//!     E M = ⎡ U  * ⎤        R: (n + l) × (2n + k), by x_0, x_N and the k columns
//!           ⎣ 0  R ⎦
//! ```
//!
//! The caller adds the equations of the ends (boundary conditions, the corner) to `R` and solves
//! linear systems with the result.

use super::front::Fronts;
use super::grouped_fronts::GroupedFronts;
use crate::core::cancel::CancelToken;
use crate::core::failure::Failure;

/// A chain of `N` intervals with `m·n` equations each, condensed to its ends.
///
/// Values at nodes are stored node by node, `n` states each. Repeated factorisations with the same
/// border sizes do not allocate memory.
///
/// ```
/// use tangency::core::linalg::Chain;
/// // x_1 = 2 x_0 + 1, x_2 = 3 x_1 (shooting, n = 1), closed by x_2 − x_0 = 10.
/// let mut chain = Chain::new(2, 1, 1);
/// chain.factor(&[-2.0, 1.0, -3.0, 1.0], &[], 0, &[-1.0, 0.0, 1.0], 1).unwrap();
/// let (mut right, mut reduced) = ([1.0, 0.0], [0.0, 10.0]);
/// chain.forward(&mut right, &mut reduced);
/// // Two equations are left for x_0 and x_2; Cramer's rule solves them.
/// let r = chain.reduced();
/// let determinant = r[0] * r[3] - r[1] * r[2];
/// let x_0 = (reduced[0] * r[3] - r[1] * reduced[1]) / determinant;
/// let x_2 = (r[0] * reduced[1] - reduced[0] * r[2]) / determinant;
/// let mut x = [0.0; 3];
/// chain.back(&right, &[x_0], &[x_2], &[], &mut x);
/// for (x, exact) in x.iter().zip([1.4, 3.8, 11.4]) {
///     assert!((x - exact).abs() < 1e-14);
/// }
/// ```
#[derive(Default)]
pub struct Chain {
    shape: Shape,
    /// Fronts of intervals. The matrix of an interval, with columns `[inner nodes | right node |
    /// left node | k]`, and with the interval's equations and the border's rows as its rows.
    inner: GroupedFronts,
    /// The matrices in which shared nodes are eliminated (fronts). The columns of a front are
    /// `[left node | right node | x_0 | k]`; its rows are the remaining equations of the previous
    /// intervals, the remaining equations of this interval, and the border's rows.
    shared: Fronts,
    /// The matrix `R` for the chain up to the current node, with columns for `x_0`, for the current
    /// node, and for the `k` border unknowns.
    reduced: Vec<f64>,
    state_scales: Vec<f64>,
    sign: f64,
    /// The right-hand sides of the transposed system after elimination, in the order of the
    /// equations.
    transposed: Vec<f64>,
    /// The token that cancels factorisations between intervals.
    pub cancel: CancelToken,
    /// Scratch space with one entry for each column of a front.
    unknowns: Vec<f64>,
    /// Scratch space with one entry for each row of a front.
    equations: Vec<f64>,
}

/// The numbers of intervals, of nodes beyond the left node of an interval, of states at a node, and of
/// columns and rows of the border.
#[derive(Clone, Copy, Default)]
struct Shape {
    intervals: usize,
    nodes: usize,
    states: usize,
    columns: usize,
    rows: usize,
}

impl Shape {
    /// Returns the number of equations of an interval.
    fn each(&self) -> usize {
        self.nodes * self.states
    }

    /// Returns the number of inner values of an interval.
    fn inner(&self) -> usize {
        self.each() - self.states
    }

    /// Returns the distance in memory from the start of a row to the start of the next row, in a
    /// front of an interval with the given number of entries.
    fn stride(&self, front: &[f64]) -> usize {
        front.len() / (self.each() + self.rows)
    }

    fn fill_inner(&self, i: usize, front: &mut [f64], [blocks, columns, rows]: [&[f64]; 3]) {
        let (n, k, each) = (self.states, self.columns, self.each());
        let stride = self.stride(front);
        let (equations, border) = front.split_at_mut(each * stride);
        for (r, row) in equations.chunks_exact_mut(stride).enumerate() {
            let source = &blocks[(i * each + r) * (each + n)..][..each + n];
            row[..each].copy_from_slice(&source[n..]);
            row[each..each + n].copy_from_slice(&source[..n]);
            row[each + n..each + n + k].copy_from_slice(&columns[(i * each + r) * k..][..k]);
        }
        let nodes = (self.intervals * self.nodes + 1) * n;
        for (r, row) in border.chunks_exact_mut(stride).enumerate() {
            row.fill(0.0);
            row[..each].copy_from_slice(&rows[r * nodes + i * each + n..][..each]);
        }
    }
}

impl Chain {
    /// Creates a chain of `intervals` intervals (N), with `nodes` nodes (m) beyond the left node in
    /// each interval and `states` states (n) at each node; all three numbers are at least 1.
    pub fn new(intervals: usize, nodes: usize, states: usize) -> Self {
        let shape = Shape { intervals, nodes, states, ..Shape::default() };
        Chain { shape, ..Chain::default() }
    }

    /// Factors the bordered chain.
    ///
    /// The argument `blocks` contains, for each interval, `m·n` rows of `(m + 1)·n` derivatives
    /// with respect to the values at its nodes; `columns` contains `k` entries for each of the
    /// `N·m·n` equations; `rows` contains `l` rows of `(N·m + 1)·n` entries.
    ///
    /// # Errors
    /// [`Failure::Singular`] if the equations of some interval, or of the chain up to its end, do not
    /// determine the eliminated values: a pivot vanishes to working accuracy or is NaN. Pivots are
    /// reported relative to the largest entries of their rows. [`Failure::Cancelled`] between
    /// intervals.
    pub fn factor(
        &mut self,
        blocks: &[f64],
        columns: &[f64],
        k: usize,
        rows: &[f64],
        l: usize,
    ) -> Result<(), Failure> {
        self.resize(k, l);
        self.scale(blocks);
        let (shape, cancel) = (self.shape, &self.cancel);
        let mut pivots = self.inner.eliminate(|i, front| {
            cancel.check()?;
            shape.fill_inner(i, front, [blocks, columns, rows]);
            Ok(())
        })?;
        self.begin(rows);
        for i in 1..shape.intervals {
            self.cancel.check()?;
            self.fill_shared(i);
            self.shared.eliminate(i - 1, &mut pivots)?;
            self.keep_shared(i);
        }
        let reordered = self.shape.states * (self.shape.intervals * self.shape.nodes - 1);
        self.sign = if reordered.is_multiple_of(2) { pivots.sign } else { -pivots.sign };
        Ok(())
    }

    /// Returns the matrix `R`, stored row by row: its rows are the `n` remaining equations of the
    /// chain, then the `l` border rows; its columns belong to `x_0`, to `x_N` and to the `k` border
    /// unknowns; the corner is zero.
    pub fn reduced(&self) -> &[f64] {
        &self.reduced
    }

    /// Returns the sign of the determinant of the eliminated block. If `l = n + k`, the whole
    /// matrix `M` is square (columns: nodes in their order, then the `k` border unknowns; rows:
    /// equations in their order, then the `l` border rows), and `sign det M` is the returned sign
    /// times `sign det (R + corner)`.
    pub fn determinant_sign(&self) -> f64 {
        self.sign
    }

    /// Applies the row operations `E` to a right-hand side. The argument `right` (`N·m·n` entries)
    /// is changed in place and becomes the input of [`back`](Self::back). On entry, the last
    /// entries of the vector `reduced_right`, whose length is `n + l`, contain the right-hand sides
    /// of the `l` border rows; on exit, `reduced_right` contains the right-hand side of the system
    /// with the matrix `R`.
    pub fn forward(&mut self, right: &mut [f64], reduced_right: &mut [f64]) {
        let (n, each, inner) = (self.shape.states, self.shape.each(), self.shape.inner());
        let (left_over, border) = reduced_right.split_at_mut(n);
        for (i, right) in right.chunks_exact_mut(each).enumerate() {
            let (fronts, own) = self.inner.at(i);
            fronts.forward(own, right, border);
            if i == 0 {
                left_over.copy_from_slice(&right[inner..]);
                continue;
            }
            let y = &mut self.equations[..2 * n];
            y[..n].copy_from_slice(left_over);
            y[n..].copy_from_slice(&right[inner..]);
            self.shared.forward(i - 1, y, border);
            right[inner..].copy_from_slice(&y[..n]);
            left_over.copy_from_slice(&y[n..]);
        }
    }

    /// Computes the values at all nodes (`(N·m + 1)·n` entries) from the values at the ends and the
    /// `k` border unknowns `y`; `right` is the output of [`forward`](Self::forward).
    pub fn back(
        &mut self,
        right: &[f64],
        x_0: &[f64],
        x_n: &[f64],
        y: &[f64],
        nodes_out: &mut [f64],
    ) {
        let (n, each, inner) = (self.shape.states, self.shape.each(), self.shape.inner());
        nodes_out[..n].copy_from_slice(x_0);
        nodes_out[self.shape.intervals * each..].copy_from_slice(x_n);
        for (i, right) in right.chunks_exact(each).enumerate().rev() {
            let nodes = &mut nodes_out[i * each..(i + 1) * each + n];
            if i > 0 {
                let z = &mut self.unknowns[..3 * n + self.shape.columns];
                z[n..2 * n].copy_from_slice(&nodes[each..]);
                z[2 * n..3 * n].copy_from_slice(x_0);
                z[3 * n..].copy_from_slice(y);
                self.shared.back(i - 1, &right[inner..], z);
                nodes[..n].copy_from_slice(&z[..n]);
            }
            let z = &mut self.unknowns[..each + n + self.shape.columns];
            z[inner..each].copy_from_slice(&nodes[each..]);
            z[each..each + n].copy_from_slice(&nodes[..n]);
            z[each + n..].copy_from_slice(y);
            let (fronts, own) = self.inner.at(i);
            fronts.back(own, right, z);
            nodes[n..each].copy_from_slice(&z[..inner]);
        }
    }

    /// Eliminates a right-hand side of `Mᵀ w = r`: `right_nodes` (`(N·m + 1)·n` entries) and
    /// `right_columns` (`k` entries) together form `r`, and `reduced_right` (`2n + k` entries)
    /// becomes the right-hand side of the system with the matrix `Rᵀ`.
    ///
    /// With `w = Eᵀ y`, the system `Mᵀ w = r` is equivalent to `Uᵀ y₁ = r₁`, `Rᵀ y₂ = r₂ − *ᵀ y₁`.
    /// The vector `y₁` is kept until the call of [`back_transposed`](Self::back_transposed).
    pub fn forward_transposed(
        &mut self,
        right_nodes: &[f64],
        right_columns: &[f64],
        reduced_right: &mut [f64],
    ) {
        let (n, each, inner) = (self.shape.states, self.shape.each(), self.shape.inner());
        reduced_right[..n].copy_from_slice(&right_nodes[..n]);
        reduced_right[n..2 * n].fill(0.0);
        reduced_right[2 * n..].copy_from_slice(right_columns);
        for (i, kept) in self.transposed.chunks_exact_mut(each).enumerate() {
            let nodes = &right_nodes[i * each..(i + 1) * each + n];
            let z = &mut self.unknowns[..each + n + self.shape.columns];
            z[..each].copy_from_slice(&nodes[n..]);
            z[each..].fill(0.0);
            let (fronts, own) = self.inner.at(i);
            fronts.forward_transposed(own, z);
            kept[..inner].copy_from_slice(&z[..inner]);
            let (right, left, k) = (&z[inner..each], &z[each..each + n], &z[each + n..]);
            add(&mut reduced_right[2 * n..], k);
            if i == 0 {
                add(&mut reduced_right[..n], left);
                reduced_right[n..2 * n].copy_from_slice(right);
                continue;
            }
            add(&mut reduced_right[n..2 * n], left);
            // The right sides by x_0, node i and the k columns, with the interval's contribution to
            // node i + 1, become right sides with node i + 1 in place of node i.
            let front = &mut self.equations[..3 * n + self.shape.columns];
            place(front, reduced_right, n);
            front[n..2 * n].copy_from_slice(right);
            self.shared.forward_transposed(i - 1, front);
            unplace(reduced_right, front, n);
            kept[inner..].copy_from_slice(&front[..n]);
        }
    }

    /// Computes the components of `w` for the chain's equations (`N·m·n` entries) from the solution
    /// `reduced_left` (`n + l` entries) of the system with `Rᵀ`; the last `l` entries of
    /// `reduced_left` are the other components of `w`.
    pub fn back_transposed(&mut self, reduced_left: &[f64], equations_out: &mut [f64]) {
        let (n, each, inner) = (self.shape.states, self.shape.each(), self.shape.inner());
        let (left_over, border) = reduced_left.split_at(n);
        equations_out.copy_from_slice(&self.transposed);
        let y = &mut self.equations[..2 * n];
        y[n..].copy_from_slice(left_over);
        for (i, out) in equations_out.chunks_exact_mut(each).enumerate().rev() {
            if i > 0 {
                y[..n].copy_from_slice(&out[inner..]);
                self.shared.back_transposed(i - 1, y, border);
                out[inner..].copy_from_slice(&y[n..]);
                y.copy_within(..n, n);
            } else {
                out[inner..].copy_from_slice(&y[n..]);
            }
            let (fronts, own) = self.inner.at(i);
            fronts.back_transposed(own, out, border);
        }
    }

    fn resize(&mut self, k: usize, l: usize) {
        if !self.reduced.is_empty() && (k, l) == (self.shape.columns, self.shape.rows) {
            return;
        }
        (self.shape.columns, self.shape.rows) = (k, l);
        let (n, each, intervals) = (self.shape.states, self.shape.each(), self.shape.intervals);
        self.inner = GroupedFronts::new(intervals, [each - n, each, l, each + n + k]);
        self.shared = Fronts::new(intervals - 1, n, 2 * n, l, 3 * n + k);
        self.reduced = vec![0.0; (n + l) * (2 * n + k)];
        self.state_scales = vec![0.0; each + n];
        self.transposed = vec![0.0; intervals * each];
        self.unknowns = vec![0.0; each + 2 * n + k];
        self.equations = vec![0.0; 3 * n + k];
    }

    /// Computes one scale for each state, the inverse of the largest derivative with respect to
    /// that state, so that the choice of pivots does not depend on the units of the states.
    fn scale(&mut self, blocks: &[f64]) {
        let (n, each) = (self.shape.states, self.shape.each());
        self.state_scales.fill(0.0);
        for row in blocks.chunks_exact(each + n) {
            for (largest, entry) in self.state_scales.iter_mut().zip(row) {
                *largest = if entry.abs() > *largest { entry.abs() } else { *largest };
            }
        }
        for state in 0..n {
            let largest = self.state_scales.iter().skip(state).step_by(n);
            let scale = 1.0 / largest.fold(0.0, |a: f64, b| a.max(*b));
            self.inner.set_scales(|scales| {
                let inner = scales[..each + n].iter_mut().skip(state).step_by(n);
                inner.for_each(|column| *column = scale);
            });
            let shared = self.shared.scales[..3 * n].iter_mut().skip(state).step_by(n);
            shared.for_each(|column| *column = scale);
        }
    }

    /// Stores the rows of the chain that remain after the elimination up to the end of interval
    /// `i`.
    fn keep_shared(&mut self, i: usize) {
        let (n, k) = (self.shape.states, self.shape.columns);
        let rows = self.shared.front(i - 1).chunks_exact(self.shared.stride).skip(n);
        for (reduced, row) in self.reduced.chunks_exact_mut(2 * n + k).zip(rows) {
            unplace(reduced, &row[..3 * n + k], n);
        }
    }

    /// Stores the rows of the first interval that remain after its elimination, with columns for
    /// both ends of the interval.
    fn begin(&mut self, rows: &[f64]) {
        let (n, k, each) = (self.shape.states, self.shape.columns, self.shape.each());
        let (inner, front) = (self.shape.inner(), self.inner.front(0));
        let left = front.chunks_exact(self.shape.stride(front)).skip(inner);
        for (reduced, row) in self.reduced.chunks_exact_mut(2 * n + k).zip(left) {
            reduced[..n].copy_from_slice(&row[each..each + n]);
            reduced[n..2 * n].copy_from_slice(&row[inner..each]);
            reduced[2 * n..].copy_from_slice(&row[each + n..each + n + k]);
        }
        let border = self.reduced.chunks_exact_mut(2 * n + k).skip(n);
        for (reduced, row) in
            border.zip(rows.chunks_exact((self.shape.intervals * self.shape.nodes + 1) * n))
        {
            add(&mut reduced[..n], &row[..n]);
        }
    }

    /// Assembles the remaining rows of the chain up to node `i` and the rows of interval `i`,
    /// ordered by nodes.
    fn fill_shared(&mut self, i: usize) {
        let (n, k, each) = (self.shape.states, self.shape.columns, self.shape.each());
        let (inner, front) = (self.shape.inner(), self.inner.front(i));
        let wide = self.shared.stride;
        let a = self.shared.front_mut(i - 1);
        a.fill(0.0);
        let (before, others) = a.split_at_mut(n * wide);
        let carried = self.reduced.chunks_exact(2 * n + k);
        let border = others[n * wide..].chunks_exact_mut(wide);
        for (row, reduced) in before.chunks_exact_mut(wide).chain(border).zip(carried) {
            place(row, reduced, n);
        }
        let left = front.chunks_exact(self.shape.stride(front)).skip(inner);
        for (row, left) in others.chunks_exact_mut(wide).zip(left) {
            add(&mut row[..n], &left[each..each + n]);
            add(&mut row[n..2 * n], &left[inner..each]);
            add(&mut row[3 * n..3 * n + k], &left[each + n..each + n + k]);
        }
    }
}

/// Copies a row with columns for `x_0`, node `i` and the `k` border unknowns into a row with
/// columns for node `i`, node `i + 1`, `x_0` and the `k` border unknowns.
fn place(row: &mut [f64], reduced: &[f64], n: usize) {
    row[..n].copy_from_slice(&reduced[n..2 * n]);
    row[2 * n..3 * n].copy_from_slice(&reduced[..n]);
    row[3 * n..n + reduced.len()].copy_from_slice(&reduced[2 * n..]);
}

/// Extracts the row with columns for `x_0`, the current node and the `k` border unknowns from a row
/// whose columns also include an eliminated node.
fn unplace(reduced: &mut [f64], row: &[f64], n: usize) {
    reduced[..n].copy_from_slice(&row[2 * n..3 * n]);
    reduced[n..2 * n].copy_from_slice(&row[n..2 * n]);
    reduced[2 * n..].copy_from_slice(&row[3 * n..]);
}

fn add(target: &mut [f64], source: &[f64]) {
    target.iter_mut().zip(source).for_each(|(target, source)| *target += source);
}
