//! Evaluates deflections at points of the plate, and finds the largest deflection.

use super::basis::{AtPoint, Table};
use super::discretisation::Discretisation;
use super::tensor::Product;

/// The number of nodes along half a side of the plate in the search for the largest deflection.
const NODES: usize = 17;

/// Returns the deflection and its first and second derivatives with respect to `ξ`, `ζ` at a point:
/// `[w, w_ξ, w_ζ, w_ξξ, w_ζζ, w_ξζ]`.
pub(super) fn local(
    model: &Discretisation,
    q: &[f64],
    at: [f64; 2],
    memory: &mut [AtPoint; 2],
) -> [f64; 6] {
    let [f, g] = evaluate(model, at, memory);
    let mut sums = [0.0; 6];
    let products = f.iter().flat_map(|f| g.iter().map(move |g| (f, g)));
    for ((f, g), (q, scale)) in products.zip(q.iter().zip(&model.scale)) {
        let orders = [[0, 0], [1, 0], [0, 1], [2, 0], [0, 2], [1, 1]];
        for (sum, [a, b]) in sums.iter_mut().zip(orders) {
            *sum += q * scale * f[a] * g[b];
        }
    }
    sums
}

/// Returns the values of all products of two basis functions of the deflection at a point of the
/// plate.
pub(super) fn products(
    model: &Discretisation,
    at: [f64; 2],
    memory: &mut [AtPoint; 2],
    out: &mut [f64],
) {
    let [f, g] = evaluate(model, at, memory);
    let values = f.iter().flat_map(|f| g.iter().map(move |g| f[0] * g[0]));
    for ((out, value), scale) in out.iter_mut().zip(values).zip(&model.scale) {
        *out = value * scale;
    }
}

/// Evaluates the basis functions of the deflection in each direction at a point of the plate.
fn evaluate<'a>(
    model: &Discretisation,
    at: [f64; 2],
    memory: &'a mut [AtPoint; 2],
) -> [&'a [[f64; 3]]; 2] {
    for axis in 0..2 {
        model.transverse[axis].evaluate(at[axis], &mut memory[axis]);
    }
    [&memory[0].values, &memory[1].values]
}

/// Returns equidistant nodes in `ξ` for the search for the largest deflection: from the middle to
/// one end if the plate is symmetric, otherwise from one end to the other end.
pub(super) fn search_nodes(symmetric: bool) -> Vec<f64> {
    let last = NODES as i32 - 1;
    let first = if symmetric { 0 } else { -last };
    (first..=last).map(|i| f64::from(i) / f64::from(last)).collect()
}

/// Returns the position of the largest number in a list, and the number; if the list contains NaN,
/// the position of the first NaN.
pub(super) fn highest(values: impl Iterator<Item = f64>) -> (usize, f64) {
    let mut best = (0, f64::NEG_INFINITY);
    for (k, value) in values.enumerate() {
        if value.is_nan() {
            return (k, value);
        }
        if value > best.1 {
            best = (k, value);
        }
    }
    best
}

/// A grid of nodes, with tables of the basis functions at the nodes, for the search for the largest
/// deflection.
pub(super) struct Search {
    nodes: [Vec<f64>; 2],
    tables: [Table; 2],
    /// The values of the basis functions at one point.
    pub point: [AtPoint; 2],
    coefficients: Vec<f64>,
    half: Vec<f64>,
    field: Vec<f64>,
}

impl Search {
    pub fn new(model: &Discretisation) -> Search {
        let nodes = model.symmetric.map(search_nodes);
        let tables = [0, 1].map(|axis| model.transverse[axis].table(&nodes[axis]));
        Search {
            point: Default::default(),
            coefficients: vec![0.0; model.unknowns()],
            half: Vec::new(),
            field: vec![0.0; nodes[0].len() * nodes[1].len()],
            tables,
            nodes,
        }
    }

    /// Returns the largest deflection on the grid and its position, as `(w, ξ, ζ)`; NaN if any
    /// deflection is NaN.
    pub fn on_grid(&mut self, model: &Discretisation, q: &[f64]) -> (f64, f64, f64) {
        for ((out, q), scale) in self.coefficients.iter_mut().zip(q).zip(&model.scale) {
            *out = q * scale;
        }
        let points = [self.nodes[0].len(), self.nodes[1].len()];
        let [x, y] = self.tables.each_ref().map(|table| &table.values[..]);
        let product = Product { x, y, points };
        product.expand(&self.coefficients, &mut self.half, &mut self.field);
        let (k, largest) = highest(self.field.iter().copied());
        (largest, self.nodes[0][k / points[1]], self.nodes[1][k % points[1]])
    }

    /// Returns the largest deflection and its position, as `(w, ξ, ζ)`, by Newton's iteration from
    /// the node of the grid with the largest deflection. A coordinate is varied unless the node is
    /// at an end of the range of this coordinate and the deflection still increases towards this
    /// end.
    pub fn largest(&mut self, model: &Discretisation, q: &[f64]) -> (f64, f64, f64) {
        let (best, xi, zeta) = self.on_grid(model, q);
        let held = |axis: usize| model.symmetric[axis];
        if best.is_nan() || (held(0) && held(1) && xi == 0.0 && zeta == 0.0) {
            return (best, xi, zeta);
        }
        let mut at = [xi, zeta];
        let reach = 1.0 / (NODES - 1) as f64;
        for _ in 0..20 {
            let [_, wx, wy, wxx, wyy, wxy] = local(model, q, at, &mut self.point);
            let moves = [0, 1].map(|axis| {
                let slope = [wx, wy][axis];
                let at_end = at[axis].abs() == 1.0 && slope * at[axis] >= 0.0;
                !(at_end || (held(axis) && at[axis] == 0.0))
            });
            let determinant = wxx * wyy - wxy * wxy;
            let step = match moves {
                [true, true] if determinant > 0.0 => {
                    [(wxy * wy - wyy * wx) / determinant, (wxy * wx - wxx * wy) / determinant]
                }
                _ => [
                    if moves[0] && wxx < 0.0 { -wx / wxx } else { 0.0 },
                    if moves[1] && wyy < 0.0 { -wy / wyy } else { 0.0 },
                ],
            };
            let step = step.map(|s| s.clamp(-reach, reach));
            for axis in 0..2 {
                at[axis] = (at[axis] + step[axis]).clamp(-1.0, 1.0);
            }
            if step[0].abs() + step[1].abs() < 1e-14 {
                break;
            }
        }
        let refined = local(model, q, at, &mut self.point)[0];
        if refined >= best { (refined, at[0], at[1]) } else { (best, xi, zeta) }
    }
}
