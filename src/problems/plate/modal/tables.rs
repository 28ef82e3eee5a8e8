//! Values of the modes at the nodes of tensor-product quadrature rules.

use crate::problems::plate::ritz::Ritz;
use crate::problems::plate::tensor::{Rule, weights};

/// The values of the modes at quadrature nodes; the values of all modes at one node are stored
/// together.
pub(super) struct Nodes {
    /// The quadrature weights, which give the mean over the plate.
    pub weights: Vec<f64>,
    /// The values `φ_i` of the modes: the value of mode `i` at node `k` has the position `k·N + i`.
    pub values: Vec<f64>,
    /// The slopes `φ_ix`, `φ_iy` of the modes, stored in the same order as the values, with lengths
    /// in units of the side `a`.
    pub slopes: [Vec<f64>; 2],
}

impl Nodes {
    /// Tabulates all modes at the nodes of a quadrature rule.
    pub fn new(plate: &Ritz, shapes: &[Vec<f64>], rules: &[Rule; 2], aspect: f64) -> Nodes {
        let fields: Vec<_> = (shapes.iter())
            .map(|shape| plate.field(shape, [&rules[0].nodes, &rules[1].nodes]))
            .collect();
        let nodes = rules[0].len() * rules[1].len();
        let by_node = |value: &dyn Fn(usize, usize) -> f64| -> Vec<f64> {
            (0..nodes * shapes.len()).map(|e| value(e % shapes.len(), e / shapes.len())).collect()
        };
        Nodes {
            weights: weights(rules).collect(),
            values: by_node(&|mode, node| fields[mode].value[node]),
            slopes: [
                by_node(&|mode, node| fields[mode].slopes[0][node] * 2.0),
                by_node(&|mode, node| fields[mode].slopes[1][node] * (2.0 / aspect)),
            ],
        }
    }

    /// Returns the means of all products of a function from one table and a function from another
    /// table; the pair `(i, k)` has the position `i·n + k`.
    pub fn gram(&self, first: &[f64], second: &[f64]) -> Vec<f64> {
        let modes = first.len() / self.weights.len();
        let mut matrix = vec![0.0; modes * modes];
        let rows = first.chunks_exact(modes).zip(second.chunks_exact(modes)).zip(&self.weights);
        for ((first, second), weight) in rows {
            for (row, first) in matrix.chunks_exact_mut(modes).zip(first) {
                row.iter_mut().zip(second).for_each(|(entry, b)| *entry += weight * first * b);
            }
        }
        matrix
    }
}

/// Returns the row of a table that contains the values at a `node`.
pub(super) fn at(rows: &[f64], node: usize, width: usize) -> &[f64] {
    &rows[node * width..(node + 1) * width]
}
