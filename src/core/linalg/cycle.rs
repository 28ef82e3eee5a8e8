//! Block-cyclic matrices: chains of blocks whose first and last nodes are identified.
//!
//! ```text
//!         x_0   x_1   x_2          x_{K−1}
//!     ⎡  A_0   B_0                        │  columns ⎤
//!     ⎢        A_1   B_1                  │          ⎥
//!     ⎢              ⋱     ⋱              │          ⎥      K blocks of n equations
//!     ⎢ μB_{K−1}                A_{K−1}   │          ⎥
//!     ⎣  rows                             │  corner  ⎦
//! ```
//!
//! The blocks form a [`Chain`] with the values `x_0 … x_K` and the condition `x_K = μ x_0`. The
//! condensation of the chain leaves equations with the following matrix:
//!
//! ```text
//!           x_0   x_K   border
//!     D = ⎡ P     Q     *      ⎤      n rows
//!         ⎢ μ I   −I    0      ⎥      n rows
//!         ⎣ *     *     corner ⎦
//! ```
//!
//! The condensation takes O(K n³) operations and O(K n²) memory. The Floquet multipliers of the
//! cycle are the eigenvalues of the pencil `P + μ Q`.

use super::balance::balance;
use super::border::{Border, Spectrum};
use super::chain::Chain;
use super::condensed::Condensed;
use super::pencil::multipliers;
use super::vector::refill;
use crate::core::cancel::CancelToken;
use crate::core::failure::Failure;

/// A block-cyclic matrix and its border: each block has `n` rows of the `2n` entries `[A_k  B_k]`;
/// the border has columns in the order of the equations and rows in the order of the unknowns.
#[derive(Clone, Copy)]
pub(in crate::core) struct Blocks<'a> {
    pub blocks: &'a [f64],
    pub border: Border<'a>,
    /// The token that cancels eliminations between blocks.
    pub cancel: &'a CancelToken,
}

/// A condensed block-cyclic matrix.
#[derive(Default)]
pub(in crate::core) struct Cycle {
    states: usize,
    chain: Chain,
    /// For each value in `x_0 … x_{K−1}`, its position among the unknowns.
    order: Vec<usize>,
    width: usize,
    columns: Vec<f64>,
    rows: Vec<f64>,
    /// The values `x_0 … x_K` of the chain.
    nodes: Vec<f64>,
    reduced: Vec<f64>,
}

impl Cycle {
    /// Creates a cycle of blocks of `states` equations; `order` contains, for each value in `x_0 …
    /// x_{K−1}`, its position among the unknowns.
    pub fn new(states: usize, order: Vec<usize>) -> Self {
        let blocks = order.len() / states.max(1);
        let (chain, nodes) = (Chain::new(blocks, 1, states), vec![0.0; order.len() + states]);
        Cycle { states, chain, order, nodes, ..Cycle::default() }
    }

    /// Creates a cycle without entries that has the same number of blocks, of the same sizes.
    pub fn another(&self) -> Self {
        Cycle::new(self.states, self.order.clone())
    }

    /// Whether the cycle has `count` unknowns.
    pub fn fits(&self, unknowns: usize) -> bool {
        self.order.len() == unknowns
    }

    /// Computes the Floquet multipliers of a cycle of blocks without a border, in descending order
    /// of their size.
    ///
    /// # Errors
    /// The errors of [`multipliers`] and of [`Chain::factor`].
    pub fn multipliers(&mut self, of: Blocks) -> Result<Spectrum, Failure> {
        self.condense(of)?;
        let n = self.states;
        let half = |first: usize| -> Vec<f64> {
            let rows = self.chain.reduced().chunks_exact(2 * n);
            rows.flat_map(|row| &row[first..first + n]).copied().collect()
        };
        let (mut p, mut q) = (half(0), half(n));
        // The states at both ends have the same units, and so do the equations.
        let mut sizes: Vec<f64> = p.iter().zip(&q).map(|(p, q)| p.abs() + q.abs()).collect();
        // The entries are row-wise instead of column-wise: the matrix is transposed, its units
        // inverted.
        let units = balance(&mut sizes, n);
        for half in [&mut p, &mut q] {
            for (row, own) in half.chunks_exact_mut(n).zip(&units) {
                row.iter_mut().zip(&units).for_each(|(entry, unit)| *entry *= own / unit);
            }
        }
        multipliers(&p, &q, n)
    }
}

impl Condensed for Cycle {
    type Matrix<'a> = Blocks<'a>;

    fn condense(&mut self, Blocks { blocks, border, cancel }: Blocks) -> Result<(), Failure> {
        let (n, size, width) = (self.states, self.order.len(), border.width);
        let entries = (0..size).flat_map(|e| (0..width).map(move |c| (c, e)));
        refill(&mut self.columns, entries.map(|(c, e)| border.columns[c * size + e]));
        self.rows.clear();
        for row in border.rows.chunks_exact(size).take(width) {
            self.rows.extend(self.order.iter().map(|&z| row[z]));
            self.rows.extend(std::iter::repeat_n(0.0, n));
        }
        self.width = width;
        self.chain.cancel.clone_from(cancel);
        self.chain.factor(blocks, &self.columns, width, &self.rows, width)
    }

    fn side(&self) -> usize {
        2 * self.states + self.width
    }

    fn place(&self, Blocks { border, .. }: Blocks, dense: &mut [f64]) {
        let (n, side, width) = (self.states, self.side(), self.width);
        for (i, row) in self.chain.reduced().chunks_exact(side).enumerate() {
            let target = if i < n { i } else { n + i };
            row.iter().enumerate().for_each(|(j, entry)| dense[j * side + target] = *entry);
        }
        for i in 0..n {
            dense[i * side + n + i] = 1.0;
            dense[(n + i) * side + n + i] = -1.0;
        }
        for (k, entry) in border.corner[..width * width].iter().enumerate() {
            dense[(2 * n + k % width) * side + 2 * n + k / width] += entry;
        }
    }

    /// In the whole matrix, the rows with the coefficient `μ` belong to the last block, in which
    /// `μ` multiplies `x_0`.
    fn visit_returns(&self, visit: &mut dyn FnMut([usize; 2], [usize; 2])) {
        let n = self.states;
        let last = self.order.len() - n;
        (0..n).for_each(|i| visit([n + i, i], [last + i, self.order[i]]));
    }

    fn forward(&mut self, right: &mut [f64], left: &mut Vec<f64>) {
        let (n, size) = (self.states, self.order.len());
        left.clear();
        left.resize(n, 0.0);
        left.extend_from_slice(&right[size..]);
        self.chain.forward(&mut right[..size], left);
        // The ends are joined: `x_0 − x_K = 0`.
        left.splice(n..n, std::iter::repeat_n(0.0, n));
    }

    fn back(&mut self, right: &mut [f64], left: &mut Vec<f64>) {
        let (n, size) = (self.states, self.order.len());
        let (x_0, x_k, y) = (&left[..n], &left[n..2 * n], &left[2 * n..]);
        self.chain.back(&right[..size], x_0, x_k, y, &mut self.nodes);
        self.order.iter().zip(&self.nodes).for_each(|(&z, value)| right[z] = *value);
        right[size..].copy_from_slice(y);
    }

    fn forward_transposed(&mut self, right: &[f64], left: &mut Vec<f64>) {
        let size = self.order.len();
        self.nodes.fill(0.0);
        self.nodes.iter_mut().zip(&self.order).for_each(|(value, &z)| *value = right[z]);
        left.resize(self.side(), 0.0);
        self.chain.forward_transposed(&self.nodes, &right[size..], left);
    }

    fn back_transposed(&mut self, right: &mut [f64], left: &mut Vec<f64>) {
        let (n, size) = (self.states, self.order.len());
        refill(&mut self.reduced, left[..n].iter().chain(&left[2 * n..]).copied());
        self.chain.back_transposed(&self.reduced, &mut right[..size]);
        right[size..].copy_from_slice(&left[2 * n..]);
    }

    fn determinant_sign(&self) -> f64 {
        self.chain.determinant_sign()
    }
}
