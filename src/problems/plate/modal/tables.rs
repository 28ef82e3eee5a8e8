//! Modes and their slopes at the nodes of tensor rules.

use crate::core::scalar::Scalar;
use crate::problems::plate::basis::Table;
use crate::problems::plate::model::Model;
use crate::problems::plate::tensor::{Product, Rule};

/// Modes at nodes, all modes of one node together.
pub(super) struct Nodes {
    /// Of the mean over the plate.
    pub weights: Vec<f64>,
    /// `φ_i` at node `k`: entry `k·N + i`.
    pub values: Vec<f64>,
}

impl Nodes {
    pub fn new(model: &Model, shapes: &[Vec<f64>], rules: &[Rule; 2]) -> Nodes {
        let values = by_node(&fields(model, shapes, rules, [0, 0]));
        Nodes { weights: weights(rules), values }
    }
}

/// The derivative of the given orders by `ξ`, `ζ` of each shape (coefficients in the unknowns of `model`).
pub(super) fn fields(
    model: &Model,
    shapes: &[Vec<f64>],
    rules: &[Rule; 2],
    orders: [usize; 2],
) -> Vec<Vec<f64>> {
    let tables = [0, 1].map(|axis| model.transverse[axis].table(&rules[axis].nodes));
    let product = product(&tables, orders);
    let mut half = vec![0.0; tables[0].functions * product.points[1]];
    let expand = |shape: &Vec<f64>| {
        let scaled: Vec<f64> = shape.iter().zip(&model.scale).map(|(c, scale)| c * scale).collect();
        let mut field = vec![0.0; product.points[0] * product.points[1]];
        product.expand(&scaled, &mut half, &mut field);
        field
    };
    shapes.iter().map(expand).collect()
}

/// The product of tables, each differentiated 0 or 1 times.
pub(super) fn product(tables: &[Table; 2], orders: [usize; 2]) -> Product<'_> {
    let pick = |axis: usize| match orders[axis] {
        0 => &tables[axis].values[..],
        _ => &tables[axis].slopes[..],
    };
    Product { x: pick(0), y: pick(1), points: [tables[0].points, tables[1].points] }
}

/// Weights of the mean over the plate, node by node.
pub(super) fn weights(rules: &[Rule; 2]) -> Vec<f64> {
    let [x, y] = rules;
    x.weights.iter().flat_map(|wx| y.weights.iter().map(move |wy| wx * wy)).collect()
}

/// Fields, one after the other, as values of all fields at one node after the other.
pub(super) fn by_node(fields: &[Vec<f64>]) -> Vec<f64> {
    let nodes = fields.first().map_or(0, Vec::len);
    (0..nodes).flat_map(|node| fields.iter().map(move |field| field[node])).collect()
}

/// `Σ q_i t_i`.
#[inline]
pub(super) fn sum<T: Scalar>(q: &[T], table: &[f64]) -> T {
    q.iter().zip(table).fold(T::zero(), |sum, (q, t)| sum + *q * *t)
}
