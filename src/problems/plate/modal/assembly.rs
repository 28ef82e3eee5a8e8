//! The derivative `∂r/∂q` of the residual with respect to the coefficients of the modes, for each
//! of the two projections; it is assembled from tables.
//!
//! If the residual were differentiated by dual numbers, every sum would carry eight derivatives.
//! Most sums in the residual are linear in the coefficients `q` or in products of these
//! coefficients, so their derivatives are known tables. Tests compare the assembled derivative with
//! the same derivative, computed with dual numbers.

use super::membrane;
use super::projection::{Direct, Linear, Multiplied, integrand};
use super::tables::at;
use crate::core::scalar::DualChunk;
use crate::problems::plate::parameters::Parameters;
use crate::problems::plate::tensor::dot;

impl Direct {
    /// Computes the Hessian of the potential `Π` into `out` (`N × N`).
    pub fn stiffness(
        &self,
        linear: &Linear,
        q: &[f64],
        plate: &Parameters<f64>,
        largest: f64,
        out: &mut [f64],
    ) {
        let n = q.len();
        out.fill(0.0);
        let nodes = self.load_nodes(largest);
        for (values, weight) in nodes.values.chunks_exact(n).zip(&nodes.weights) {
            let closeness = 1.0 / (1.0 - dot(q, values));
            let slope = -2.0 * plate.load * weight * closeness.powi(3);
            for (i, value) in values.iter().enumerate() {
                let factor = slope * value;
                let row = out[i * n..=i * n + i].iter_mut();
                row.zip(values).for_each(|(entry, value)| *entry += factor * value);
            }
        }
        for i in 0..n {
            for k in 0..i {
                out[k * n + i] = out[i * n + k];
            }
            out[i * n + i] += linear.squares[i];
        }
        for (force, matrix) in linear.forces(plate).iter().zip(&linear.slopes) {
            out.iter_mut().zip(matrix).for_each(|(entry, slopes)| *entry -= force * slopes);
        }
        if let Some(form) = &self.form {
            membrane::add_stiffness(form, q, 24.0 * plate.gap_ratio * plate.gap_ratio, out);
        }
    }
}

impl Multiplied {
    /// Computes `∂r_i/∂q_k` into `out` at position `k·N + i`. At each node, dual numbers give the
    /// derivatives of the integrand with respect to its arguments, and the tables give the
    /// derivatives of these arguments with respect to `q`.
    pub fn stiffness(&self, linear: &Linear, q: &[f64], plate: &Parameters<f64>, out: &mut [f64]) {
        let n = q.len();
        out.fill(0.0);
        let forces = linear.forces(plate).map(DualChunk::<f64, 7>::from);
        let stiffness = 12.0 * plate.gap_ratio * plate.gap_ratio;
        let pairs = membrane::products(q);
        let scaled: Vec<f64> = q.iter().map(|q| stiffness * q).collect();
        let bending: Vec<f64> =
            q.iter().zip(&linear.squares).map(|(q, square)| q * square).collect();
        let mut of_stress = [vec![0.0; n], vec![0.0; n], vec![0.0; n]];
        for (node, weight) in self.nodes.weights.iter().enumerate() {
            let [values, slopes_x, slopes_y] = self.modes_at(node, n);
            let mut local = [0.0; 7];
            local[0] = dot(q, values);
            local[1] = dot(q, slopes_x);
            local[2] = dot(q, slopes_y);
            local[3] = dot(&bending, values);
            if let Some(stress) = &self.stress {
                for (k, rows) in stress.iter().enumerate() {
                    let row = at(rows, node, pairs.len());
                    local[4 + k] = stiffness * dot(&pairs, row);
                    of_stress[k].fill(0.0);
                    membrane::add_product_slopes(row, &scaled, &mut of_stress[k]);
                }
            }
            let seeded = std::array::from_fn(|k| DualChunk::seeded(local[k], k));
            let parts = integrand(seeded, forces, plate.pressure.into());
            for (k, column) in out.chunks_exact_mut(n).enumerate() {
                let of_local = [
                    values[k],
                    slopes_x[k],
                    slopes_y[k],
                    linear.squares[k] * values[k],
                    of_stress[0][k],
                    of_stress[1][k],
                    of_stress[2][k],
                ];
                let [plain, in_x, in_y] = parts.map(|part| weight * dot(&part.eps, &of_local));
                for (i, entry) in column.iter_mut().enumerate() {
                    *entry += plain * values[i] + in_x * slopes_x[i] + in_y * slopes_y[i];
                }
            }
        }
    }
}
