//! The Jacobian extended by a border, condensed to a small matrix.
//!
//! Each segment's chain of intervals is condensed to equations in the states at its ends, the extra
//! unknowns and the border's unknowns; the segments of a cycle are then condensed like intervals.
//! After the condensation, a small dense matrix remains:
//!
//! ```text
//!            x(0)   x(1)   extra unknowns and border
//!     ⎡  reduced equations of all segments  ⎤     Σ n_s rows
//!     ⎢  boundary conditions                ⎥
//!     ⎢  integral and phase conditions      ⎥
//!     ⎣  rows of the border                 ⎦
//! ```

use super::assembly::{AssembledJacobian, Bordered, Form};
use super::joined::Joined;
use super::layout::{Rest, UnknownLayout};
use crate::core::failure::{Failure, SINGULAR};
use crate::core::linalg::{Chain, Condensed, refill};
use std::sync::Arc;

/// The Jacobian extended by a border, condensed to a dense matrix.
#[derive(Default)]
pub(super) struct Condensation {
    pub layout: Arc<UnknownLayout>,
    chains: Vec<Chain>,
    /// The condensed segments of a cycle.
    joined: Joined,
    columns: Vec<f64>,
    rows: Vec<f64>,
    /// The size of the dense matrix.
    side: usize,
    reduced: Vec<f64>,
    /// The values of the solution at all nodes, node by node.
    nodes: Vec<f64>,
    /// The value of the assembly counter for the assembly that was condensed last; 0 after a
    /// failure of the condensation.
    condensed: usize,
}

impl Condensation {
    /// Creates the chains of intervals for the segments of a layout.
    pub fn new(layout: &Arc<UnknownLayout>) -> Self {
        let chain = |s: &super::layout::Segment| Chain::new(s.intervals, layout.degree, s.states);
        Condensation {
            layout: layout.clone(),
            chains: layout.segments.iter().map(chain).collect(),
            joined: Joined::new(layout),
            nodes: vec![0.0; layout.values()],
            ..Default::default()
        }
    }

    /// Fills the border columns of a chain: first the derivatives with respect to the extra
    /// unknowns, then with respect to the border's unknowns.
    fn fill_columns(&mut self, Bordered { layout, assembled, border, .. }: Bordered, s: usize) {
        let segment = &layout.segments[s];
        let (numbers, active) = (&assembled.numbers[s], assembled.active.len());
        self.columns.clear();
        for row in 0..segment.intervals * layout.degree * segment.states {
            self.columns.extend_from_slice(&numbers[row * active..row * active + layout.own()]);
            let equation = segment.equations + row;
            let entry = |c: usize| border.columns[c * layout.dimension + equation];
            self.columns.extend((0..border.width).map(entry));
        }
    }

    /// Fills the rows below a chain: first the integral and phase conditions, then the rows of the
    /// border.
    fn fill_rows(&mut self, Bordered { layout, assembled, border, .. }: Bordered, s: usize) {
        let segment = &layout.segments[s];
        let values = segment.values..segment.values + segment.nodes * segment.states;
        self.rows.clear();
        for row in assembled.closing.chunks_exact(layout.values()) {
            self.rows.extend_from_slice(&row[values.clone()]);
        }
        for row in border.rows.chunks_exact(layout.dimension).take(border.width) {
            self.rows.extend(layout.order[values.clone()].iter().map(|&z| row[z]));
        }
    }

    /// Removes the extra unknowns from a chain's columns, and the integral and phase conditions
    /// from its rows.
    fn untie_extras(&mut self, layout: &UnknownLayout, columns: usize, rows: usize) {
        for row in self.columns.chunks_exact_mut(columns.max(1)) {
            row[..layout.extras].fill(0.0);
        }
        let length = self.rows.len() / rows.max(1);
        self.rows[..layout.closing() * length].fill(0.0);
    }

    /// Adds the chains' condensed equations, and their contributions to the rows below them, to the
    /// dense matrix.
    fn place_reduced(&self, Bordered { layout, border, .. }: Bordered, dense: &mut [f64]) {
        let (all, width, size) = (layout.states, layout.extras + border.width, self.side);
        for (s, chain) in layout.segments.iter().zip(&self.chains) {
            let n = s.states;
            for (i, row) in chain.reduced().chunks_exact(2 * n + width).enumerate() {
                let target = if i < n { s.ends + i } else { all + layout.boundary + i - n };
                for (j, entry) in row.iter().enumerate() {
                    let column = match j / n {
                        0 => s.ends + j,
                        1 => all + s.ends + j - n,
                        _ => 2 * all + j - 2 * n,
                    };
                    dense[column * size + target] += entry;
                }
            }
        }
    }

    /// Adds the rows of the boundary conditions to the dense matrix.
    fn place_boundary(&self, of: Bordered, dense: &mut [f64]) {
        let Bordered { layout, assembled, border, .. } = of;
        let (all, size) = (layout.states, self.side);
        let by_states = 2 * all + assembled.active.len();
        for i in 0..layout.boundary {
            let row = &assembled.boundary[i * by_states..(i + 1) * by_states];
            for (j, entry) in row[..2 * all + layout.extras].iter().enumerate() {
                dense[j * size + all + i] = *entry;
            }
        }
        for c in 0..border.width {
            let column = &border.columns[c * layout.dimension..(c + 1) * layout.dimension];
            let start = (2 * all + layout.extras + c) * size + all;
            let target = &mut dense[start..start + layout.boundary];
            target.copy_from_slice(
                &column[layout.conditions()..layout.conditions() + layout.boundary],
            );
        }
    }

    /// Adds the lower right block of the dense matrix: the derivatives of the integral, phase and
    /// border rows with respect to the extra unknowns and the border's unknowns.
    fn place_closing(&self, of: Bordered, dense: &mut [f64]) {
        let Bordered { layout, assembled, form, border } = of;
        let (size, extras, active) = (self.side, layout.extras, assembled.active.len());
        let (closing, below) = (layout.closing(), layout.conditions() + layout.boundary);
        let (first_row, first_column) = (layout.states + layout.boundary, 2 * layout.states);
        let mut add = |row: usize, column: usize, entry: f64| {
            dense[(first_column + column) * size + first_row + row] += entry;
        };
        for i in 0..closing {
            match form {
                Form::Jacobian => {
                    (0..extras).for_each(|e| add(i, e, assembled.closing_numbers[i * active + e]))
                }
                Form::Twisted => add(i, i, 1.0),
            }
            (0..border.width)
                .for_each(|c| add(i, extras + c, border.columns[c * layout.dimension + below + i]));
        }
        for i in 0..border.width {
            let row = &border.rows[i * layout.dimension + layout.values()..];
            (0..extras).for_each(|e| add(closing + i, e, row[e]));
            (0..border.width)
                .for_each(|c| add(closing + i, extras + c, border.corner[i * border.width + c]));
        }
    }

    /// Writes the condensed equations of the first segment, `P x(0) + Q x(1) + … = 0`, into two
    /// matrices, stored row by row; returns false if another assembly was factored last.
    pub fn pencil(&self, assembled: &AssembledJacobian, out: &mut [Vec<f64>; 2]) -> bool {
        let (Some(chain), true) = (self.chains.first(), self.condensed == assembled.count) else {
            return false;
        };
        let (n, rest) = (self.layout.segments[0].states, self.layout.rest());
        let border = self.side - 2 * rest.states - rest.extras;
        let width = 2 * n + self.layout.own() + border;
        out.iter_mut().for_each(Vec::clear);
        for row in chain.reduced().chunks_exact(width).take(n) {
            out[0].extend_from_slice(&row[..n]);
            out[1].extend_from_slice(&row[n..2 * n]);
        }
        true
    }
}

impl Condensed for Condensation {
    type Matrix<'a> = Bordered<'a>;

    fn condense(&mut self, of: Bordered) -> Result<(), Failure> {
        let Bordered { layout, assembled, form, border } = of;
        let (k, l) = (layout.own() + border.width, layout.closing() + border.width);
        self.condensed = 0;
        for s in 0..layout.segments.len() {
            self.fill_columns(of, s);
            self.fill_rows(of, s);
            if form == Form::Twisted {
                self.untie_extras(layout, k, l);
            }
            self.chains[s].cancel.clone_from(&assembled.cancel);
            self.chains[s].factor(&assembled.blocks[s], &self.columns, k, &self.rows, l)?;
        }
        if layout.cycle.is_some() {
            self.joined.condense(of, &self.chains)?;
        }
        self.condensed = assembled.count;
        let Rest { states, extras, .. } = layout.rest();
        self.side = 2 * states + extras + border.width;
        Ok(())
    }

    fn side(&self) -> usize {
        self.side
    }

    fn place(&self, of: Bordered, dense: &mut [f64]) {
        if of.layout.cycle.is_some() {
            return self.joined.place(of, self.side, dense);
        }
        self.place_reduced(of, dense);
        self.place_boundary(of, dense);
        self.place_closing(of, dense);
    }

    fn visit_returns(&self, visit: &mut dyn FnMut([usize; 2], [usize; 2])) {
        let layout = &*self.layout;
        for r in &layout.returns {
            let (row, column) = layout.place(r);
            let equation = layout.conditions() + r.condition;
            visit([row, column], [equation, layout.position(r.unknown)]);
        }
    }

    /// In the condensed right-hand side, the entries for the rows of the dense matrix come first,
    /// followed by the entries for the rows that remain from a cycle's segments.
    fn forward(&mut self, right: &mut [f64], left: &mut Vec<f64>) {
        let layout = &*self.layout;
        let Rest { states, boundary, .. } = layout.rest();
        let (below, cycle) = (states + boundary, layout.cycle.is_some());
        left.resize(self.side + self.joined.equations_count(), 0.0);
        let (dense, joined) = left.split_at_mut(self.side);
        match cycle {
            true => self.joined.load(layout, right, joined, &mut dense[states..]),
            false => dense[states..].copy_from_slice(&right[layout.conditions()..]),
        }
        for (k, (s, chain)) in layout.segments.iter().zip(&mut self.chains).enumerate() {
            let equations = &mut right[s.equations..s.equations + (s.nodes - 1) * s.states];
            self.reduced.clear();
            self.reduced.resize(s.states, 0.0);
            self.reduced.extend_from_slice(&dense[below..]);
            chain.forward(equations, &mut self.reduced);
            let (left, rows) = self.reduced.split_at(s.states);
            match cycle {
                true => self.joined.equations(joined, k)[..s.states].copy_from_slice(left),
                false => dense[s.ends..s.ends + s.states].copy_from_slice(left),
            }
            dense[below..].copy_from_slice(rows);
        }
        if cycle {
            self.joined.forward(joined, dense);
        }
    }

    fn back(&mut self, right: &mut [f64], left: &mut Vec<f64>) {
        let layout = &*self.layout;
        let all = layout.rest().states;
        let (dense, joined) = left.split_at_mut(self.side);
        if layout.cycle.is_some() {
            self.joined.back(joined, dense);
        }
        let y = &dense[2 * all..];
        for (k, (s, chain)) in layout.segments.iter().zip(&mut self.chains).enumerate() {
            let equations = &right[s.equations..s.equations + (s.nodes - 1) * s.states];
            let nodes = &mut self.nodes[s.values..s.values + s.nodes * s.states];
            if layout.cycle.is_some() {
                let (x_0, x_n, own) = self.joined.segment(k, s.states);
                refill(&mut self.reduced, own);
                self.reduced.extend_from_slice(y);
                chain.back(equations, x_0, x_n, &self.reduced, nodes);
                continue;
            }
            let (x_0, x_n) = (&dense[s.ends..], &dense[all + s.ends..]);
            chain.back(equations, &x_0[..s.states], &x_n[..s.states], y, nodes);
        }
        self.nodes.iter().zip(&layout.order).for_each(|(value, &z)| right[z] = *value);
        match layout.cycle {
            Some(_) => self.joined.unload(layout, y, &mut right[layout.values()..]),
            None => right[layout.values()..].copy_from_slice(y),
        }
    }

    fn forward_transposed(&mut self, right: &[f64], left: &mut Vec<f64>) {
        let layout = &*self.layout;
        let (all, cycle) = (layout.rest().states, layout.cycle.is_some());
        left.resize(self.side + self.joined.equations_count(), 0.0);
        let dense = &mut left[..self.side];
        self.nodes.iter_mut().zip(&layout.order).for_each(|(value, &z)| *value = right[z]);
        match cycle {
            true => self.joined.load_transposed(layout, right, &mut dense[2 * all..]),
            false => dense[2 * all..].copy_from_slice(&right[layout.values()..]),
        }
        let own = if cycle { 2 } else { 0 };
        for (k, (s, chain)) in layout.segments.iter().zip(&mut self.chains).enumerate() {
            let (nodes, n) = (&self.nodes[s.values..s.values + s.nodes * s.states], s.states);
            self.columns.clear();
            self.columns.resize(own, 0.0);
            self.columns.extend_from_slice(&dense[2 * all..]);
            self.reduced.clear();
            self.reduced.resize(2 * n + self.columns.len(), 0.0);
            chain.forward_transposed(nodes, &self.columns, &mut self.reduced);
            let (ends, columns) = self.reduced.split_at(2 * n);
            dense[2 * all..].copy_from_slice(&columns[own..]);
            if cycle {
                self.joined.add_transposed(k, ends, &columns[..own]);
                continue;
            }
            dense[s.ends..s.ends + n].copy_from_slice(&ends[..n]);
            dense[all + s.ends..all + s.ends + n].copy_from_slice(&ends[n..]);
        }
        if cycle {
            self.joined.forward_transposed(dense);
        }
    }

    fn back_transposed(&mut self, right: &mut [f64], left: &mut Vec<f64>) {
        let layout = &*self.layout;
        let Rest { states, boundary, .. } = layout.rest();
        let (dense, joined) = left.split_at_mut(self.side);
        match layout.cycle {
            Some(_) => self.joined.back_transposed(layout, joined, dense, right),
            None => right[layout.conditions()..].copy_from_slice(&dense[states..]),
        }
        for (k, (s, chain)) in layout.segments.iter().zip(&mut self.chains).enumerate() {
            self.reduced.clear();
            match layout.cycle {
                Some(_) => self.reduced.extend(&self.joined.equations(joined, k)[..s.states]),
                None => self.reduced.extend(&dense[s.ends..s.ends + s.states]),
            }
            self.reduced.extend_from_slice(&dense[states + boundary..]);
            let equations = &mut right[s.equations..s.equations + (s.nodes - 1) * s.states];
            chain.back_transposed(&self.reduced, equations);
        }
    }

    fn determinant_sign(&self) -> f64 {
        let chains: f64 = self.chains.iter().map(Chain::determinant_sign).product();
        chains * self.joined.determinant_sign()
    }
}

/// Returns the form of the linearisation from which Floquet multipliers are computed; in problems
/// with the return conditions `x(0) = x(1)`, the equations "extra unknown = 0" also replace the
/// integral and phase conditions.
pub(super) fn form_of(layout: &UnknownLayout) -> Form {
    if layout.closes() { Form::Twisted } else { Form::Jacobian }
}

/// Converts the error for a singular matrix to the error for excessive growth of deviations, if
/// this growth explains the singularity. If deviations grow by the factor `G` over an interval,
/// regular matrices have pivots of size `1/G²` for the states at the interval's end and for the
/// border. If pivots as small as `1/G²` count as zero, the factorisation cannot detect singular
/// matrices.
pub(super) fn singular_by_growth(growth: f64, cause: Failure) -> Failure {
    match cause {
        Failure::Singular { .. } if growth * growth * SINGULAR >= 1.0 => Failure::Growth(growth),
        cause => cause,
    }
}
