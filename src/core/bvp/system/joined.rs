//! Condensation of the segments of a cycle.
//!
//! The condensed chain of a segment consists of `n` equations in the states `x(0)`, `x(1)` at its
//! ends, its start time `T` and its duration `L`. Together with the conditions at the transition to
//! the next segment,
//!
//! ```text
//!     x⁺ − r(x(1), T + L) = 0,    h(x(1), T + L) = 0,    T⁺ − T − L = 0,
//! ```
//!
//! the condensed equations form an interval of a chain with nodes `(x(0), T)`, `(x(1), L)`, `(x⁺,
//! T⁺)`: segments are condensed like intervals, at a cost linear in their number. The chain is
//! closed by the condition `x(0) = x⁺` and, under forcing, by the condition that `T⁺ − T` is the
//! duration of the cycle. Segments with fewer states than others are padded with zero states.

use super::assembly::Bordered;
use super::layout::UnknownLayout;
use crate::core::failure::Failure;
use crate::core::linalg::Chain;

/// The chain formed by the condensed segments of a cycle.
#[derive(Default)]
pub(super) struct Joined {
    /// The number of segments, and the number of unknowns at each node of the chain.
    count: usize,
    n: usize,
    chain: Chain,
    blocks: Vec<f64>,
    columns: Vec<f64>,
    rows: Vec<f64>,
    /// The contributions of the segments to the corner of the bordered matrix.
    corner: Vec<f64>,
    nodes: Vec<f64>,
    reduced: Vec<f64>,
}

impl Joined {
    pub fn new(layout: &UnknownLayout) -> Self {
        if layout.cycle.is_none() {
            return Joined::default();
        }
        let (segments, n) = (layout.segments.len(), layout.rest().states);
        let (chain, nodes) = (Chain::new(segments, 2, n), vec![0.0; (2 * segments + 1) * n]);
        Joined { count: segments, n, chain, nodes, ..Joined::default() }
    }

    /// Returns the sign of the determinant of the eliminated block; 1 if the problem has no cycle.
    pub fn determinant_sign(&self) -> f64 {
        if self.count > 0 { self.chain.determinant_sign() } else { 1.0 }
    }

    /// Condenses all segments, whose chains of intervals must already be condensed.
    pub fn condense(&mut self, of: Bordered, chains: &[Chain]) -> Result<(), Failure> {
        let (segments, n, width) = (self.count, self.n, of.border.width);
        for (numbers, length) in [
            (&mut self.blocks, segments * 6 * n * n),
            (&mut self.columns, segments * 2 * n * width),
            (&mut self.rows, width * (2 * segments + 1) * n),
            (&mut self.corner, width * width),
        ] {
            numbers.clear();
            numbers.resize(length, 0.0);
        }
        for (segment, joint) in of.assembled.joints(of.layout) {
            self.fill_chain(of, segment, chains[segment].reduced());
            self.fill_joint(of, segment, joint);
        }
        self.fill_border(of);
        self.chain.factor(&self.blocks, &self.columns, width, &self.rows, width)
    }

    /// Fills in a segment's condensed equations, and the segment's contributions to the border's
    /// rows.
    fn fill_chain(
        &mut self,
        Bordered { layout, border, .. }: Bordered,
        segment: usize,
        reduced: &[f64],
    ) {
        let (n, m, width) = (self.n, layout.segments[segment].states, border.width);
        let length = (2 * self.count + 1) * n;
        for (i, row) in reduced.chunks_exact(2 * m + 2 + width).enumerate() {
            let (ends, others) = row.split_at(2 * m);
            let (own, columns) = others.split_at(2);
            let (target, last) = match i.checked_sub(m) {
                None => (
                    &mut self.blocks[(segment * 2 * n + i) * 3 * n..][..2 * n],
                    &mut self.columns[(segment * 2 * n + i) * width..][..width],
                ),
                Some(r) => (
                    &mut self.rows[r * length + segment * 2 * n..][..2 * n],
                    &mut self.corner[r * width..(r + 1) * width],
                ),
            };
            for half in 0..2 {
                let node = &mut target[half * n..(half + 1) * n];
                add(node, &ends[half * m..(half + 1) * m]);
                node[n - 1] += own[half];
            }
            add(last, columns);
        }
    }

    /// Fills in the conditions between a segment and the next segment, and the equations of padded
    /// states.
    fn fill_joint(&mut self, of: Bordered, segment: usize, joint: &[f64]) {
        let Bordered { layout, assembled, border, .. } = of;
        let (n, m, next) = (self.n, layout.segments[segment].states, layout.after(segment).states);
        let first = segment * 2 * n + m;
        let mut rows = self.blocks[first * 3 * n..].chunks_exact_mut(3 * n);
        let given = joint.chunks_exact(assembled.joint_width(layout, segment));
        for ((i, given), row) in given.enumerate().zip(&mut rows) {
            row[n..n + m].copy_from_slice(&given[..m]);
            (row[n - 1], row[2 * n - 1]) = (given[m], given[m + 1]);
            if i < next {
                row[2 * n + i] = 1.0;
            }
            let condition = layout.joint(segment, i);
            for c in 0..border.width {
                self.columns[(first + i) * border.width + c] =
                    border.columns[c * layout.dimension + condition];
            }
        }
        if let Some(time) = rows.next() {
            (time[n - 1], time[2 * n - 1], time[3 * n - 1]) = (-1.0, -1.0, 1.0);
        }
        let missing = (n + m..2 * n - 1).chain(2 * n + next..3 * n - 1);
        missing.zip(rows).for_each(|(column, row)| row[column] = 1.0);
    }

    /// Fills in the derivatives of the border's rows with respect to the start time and the
    /// durations, and the corner of the border.
    fn fill_border(&mut self, Bordered { layout, border, .. }: Bordered) {
        let (n, length) = (self.n, (2 * self.count + 1) * self.n);
        let forced = usize::from(layout.forced());
        for r in 0..border.width {
            let extras = &border.rows[r * layout.dimension..][layout.values()..layout.dimension];
            let row = &mut self.rows[r * length..(r + 1) * length];
            let (start, durations) = extras.split_at(forced);
            row[n - 1] += start.first().copied().unwrap_or(0.0);
            for (segment, duration) in durations.iter().enumerate() {
                row[(2 * segment + 2) * n - 1] += duration;
            }
        }
        add(&mut self.corner, &border.corner[..border.width * border.width]);
    }

    /// Adds the condensed equations and the closing conditions to a dense matrix, which must be
    /// zero.
    pub fn place(
        &self,
        Bordered { layout, border, .. }: Bordered,
        size: usize,
        matrix: &mut [f64],
    ) {
        let (n, width) = (self.n, border.width);
        let mut add = |row: usize, column: usize, entry: f64| matrix[column * size + row] += entry;
        for (i, row) in self.chain.reduced().chunks_exact(size).enumerate() {
            let target = if i < n { i } else { n + i };
            row.iter().enumerate().for_each(|(column, entry)| add(target, column, *entry));
        }
        for i in 0..n {
            add(n + i, i, 1.0);
            // Without forcing, time begins at 0.
            if i + 1 < n || layout.forced() {
                add(n + i, n + i, -1.0);
            }
        }
        for c in 0..width {
            if layout.forced() {
                let cycle = border.columns[(c + 1) * layout.dimension - 1];
                add(2 * n - 1, 2 * n + c, cycle);
            }
            (0..width).for_each(|r| add(2 * n + r, 2 * n + c, self.corner[r * width + c]));
        }
    }

    /// Returns the number of equations of all segments.
    pub fn equations_count(&self) -> usize {
        self.count * 2 * self.n
    }

    /// Returns a segment's part of a right-hand side.
    pub fn equations<'a>(&self, right: &'a mut [f64], segment: usize) -> &'a mut [f64] {
        &mut right[segment * 2 * self.n..(segment + 1) * 2 * self.n]
    }

    /// Loads the entries of a right-hand side that belong to the conditions between segments, to
    /// the conditions that close the cycle, and to the border.
    pub fn load(
        &self,
        layout: &UnknownLayout,
        from: &[f64],
        right: &mut [f64],
        closing: &mut [f64],
    ) {
        right.fill(0.0);
        for segment in 0..self.count {
            let (m, next) = (layout.segments[segment].states, layout.after(segment).states);
            for i in 0..=next {
                self.equations(right, segment)[m + i] = from[layout.joint(segment, i)];
            }
        }
        closing[..self.n].fill(0.0);
        if layout.forced() {
            closing[self.n - 1] = from[layout.dimension - 1];
        }
        closing[self.n..].copy_from_slice(&from[layout.dimension..]);
    }

    /// Eliminates the inner unknowns of the chain from a right-hand side.
    pub fn forward(&mut self, right: &mut [f64], dense: &mut [f64]) {
        let n = self.n;
        self.reduced.clear();
        self.reduced.resize(n, 0.0);
        self.reduced.extend_from_slice(&dense[2 * n..]);
        self.chain.forward(right, &mut self.reduced);
        dense[..n].copy_from_slice(&self.reduced[..n]);
        dense[2 * n..].copy_from_slice(&self.reduced[n..]);
    }

    /// Computes the values at all nodes from the values at both ends of the chain and the border's
    /// unknowns.
    pub fn back(&mut self, right: &[f64], dense: &[f64]) {
        let n = self.n;
        let (x_0, x_n, y) = (&dense[..n], &dense[n..2 * n], &dense[2 * n..]);
        self.chain.back(right, x_0, x_n, y, &mut self.nodes);
    }

    /// Returns the states at the ends of a segment, its start time and its duration.
    pub fn segment(&self, segment: usize, states: usize) -> (&[f64], &[f64], [f64; 2]) {
        let nodes = &self.nodes[segment * 2 * self.n..(segment + 1) * 2 * self.n];
        let (left, inner) = nodes.split_at(self.n);
        (&left[..states], &inner[..states], [left[self.n - 1], inner[self.n - 1]])
    }

    /// Returns the extra unknowns, and the border's unknowns `y`.
    pub fn unload(&self, layout: &UnknownLayout, y: &[f64], out: &mut [f64]) {
        let forced = usize::from(layout.forced());
        out[..forced].copy_from_slice(&self.nodes[self.n - 1..][..forced]);
        for segment in 0..self.count {
            out[forced + segment] = self.nodes[(2 * segment + 2) * self.n - 1];
        }
        out[layout.extras..].copy_from_slice(y);
    }

    /// For the transposed system, loads the entries of a right-hand side that belong to the extra
    /// unknowns and to the border.
    pub fn load_transposed(&mut self, layout: &UnknownLayout, right: &[f64], border: &mut [f64]) {
        let forced = usize::from(layout.forced());
        let (extras, rest) = right[layout.values()..].split_at(layout.extras);
        self.nodes.fill(0.0);
        self.nodes[self.n - 1..][..forced].copy_from_slice(&extras[..forced]);
        for segment in 0..self.count {
            self.nodes[(2 * segment + 2) * self.n - 1] = extras[forced + segment];
        }
        border.copy_from_slice(rest);
    }

    /// Adds the entries of a segment's reduced right-hand side that belong to the states at its
    /// ends, to its start time and to its duration.
    pub fn add_transposed(&mut self, segment: usize, ends: &[f64], own: &[f64]) {
        let (n, m) = (self.n, ends.len() / 2);
        for half in 0..2 {
            let node = &mut self.nodes[(2 * segment + half) * n..][..n];
            add(node, &ends[half * m..(half + 1) * m]);
            node[n - 1] += own[half];
        }
    }

    /// Eliminates the inner unknowns of the chain from a right-hand side of the transposed system,
    /// like [`forward`](Self::forward) for the original system.
    pub fn forward_transposed(&mut self, dense: &mut [f64]) {
        dense[2 * self.n..].clone_into(&mut self.reduced);
        self.chain.forward_transposed(&self.nodes, &self.reduced, dense);
    }

    /// Substitutes back like [`back`](Self::back), for the transposed matrix: writes the input for
    /// the back substitution in the segments' chains into `joined`, and the components that belong
    /// to conditions and to the border into `right`.
    pub fn back_transposed(
        &mut self,
        layout: &UnknownLayout,
        joined: &mut [f64],
        dense: &[f64],
        right: &mut [f64],
    ) {
        let n = self.n;
        dense[..n].clone_into(&mut self.reduced);
        self.reduced.extend_from_slice(&dense[2 * n..]);
        self.chain.back_transposed(&self.reduced, joined);
        for segment in 0..self.count {
            let (m, next) = (layout.segments[segment].states, layout.after(segment).states);
            for i in 0..=next {
                right[layout.joint(segment, i)] = self.equations(joined, segment)[m + i];
            }
        }
        if layout.forced() {
            right[layout.dimension - 1] = dense[2 * n - 1];
        }
        right[layout.dimension..].copy_from_slice(&dense[2 * n..]);
    }
}

/// Adds `source` to the first entries of `target`.
fn add(target: &mut [f64], source: &[f64]) {
    target.iter_mut().zip(source).for_each(|(target, source)| *target += source);
}
