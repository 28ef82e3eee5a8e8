//! Algebra of the stretching energy as a quartic form,
//! [`MembraneForm`](crate::problems::plate::MembraneForm).
//!
//! For `w = Σ q_i φ_i`, the strains of eq. 2.6 are `Σ q_i q_j ε_ij` plus the strains of the
//! in-plane displacements. These displacements depend linearly on the products `q_i q_j`, so one
//! linear system with the matrix `K_uv` is solved for each pair; its solution gives the total
//! stress `N_ij` of the pair, in equilibrium in the plane. The stretching energy is then
//!
//! ```text
//! U_m = 6α₁² Σ s_P A_PQ s_Q,    A_PQ = ⟨N_P : ε_Q⟩,    s_P = q_i² or 2q_i q_j for the pairs P = (i ≤ j)
//! ```
//!
//! The derivative of the energy with respect to `q_i` is `24α₁² Σ_j (A s)_ij q_j`.

use crate::core::scalar::Scalar;
use crate::problems::plate::tensor::dot;

/// Returns the products `s_P` of two coefficients for all pairs `P = (i, j)` with `i ≤ j`: `q_i²`
/// for `i = j`, otherwise `2q_i q_j`.
pub(super) fn products<T: Scalar>(q: &[T]) -> Vec<T> {
    let mut products = Vec::with_capacity(q.len() * (q.len() + 1) / 2);
    for (i, first) in q.iter().enumerate() {
        products.push(*first * *first);
        let twice = *first * 2.0;
        products.extend(q[i + 1..].iter().map(|second| twice * *second));
    }
    products
}

/// Adds the force `∂U_m/∂q_i = stiffness · Σ_j (A s)_ij q_j`, with `stiffness = 24α₁²`, to `r`.
pub(super) fn add_force<T: Scalar>(form: &[f64], q: &[T], stiffness: T, r: &mut [T]) {
    let pairs = products(q);
    let mut rows = form.chunks_exact(pairs.len());
    for i in 0..q.len() {
        for (j, row) in (i..q.len()).zip(&mut rows) {
            let tension = dot(&pairs, row) * stiffness;
            r[i] += tension * q[j];
            if j > i {
                r[j] += tension * q[i];
            }
        }
    }
}

/// Adds the product `Σ_P row_P ∂s_P/∂q_k` to `out`, for all `k`.
pub(super) fn add_product_slopes(row: &[f64], q: &[f64], out: &mut [f64]) {
    let mut row = row.iter();
    for i in 0..q.len() {
        for (j, entry) in (i..q.len()).zip(&mut row) {
            out[i] += 2.0 * entry * q[j];
            if j > i {
                out[j] += 2.0 * entry * q[i];
            }
        }
    }
}

/// Adds the derivative of [`add_force`] with respect to `q` to `out` (`N × N`, symmetric).
pub(super) fn add_stiffness(form: &[f64], q: &[f64], stiffness: f64, out: &mut [f64]) {
    let n = q.len();
    let pairs = products(q);
    let mut slopes = vec![0.0; n];
    let mut rows = form.chunks_exact(pairs.len());
    for i in 0..n {
        for (j, row) in (i..n).zip(&mut rows) {
            let tension = stiffness * dot(&pairs, row);
            slopes.fill(0.0);
            add_product_slopes(row, q, &mut slopes);
            out[i * n + j] += tension;
            let [qi, qj] = [i, j].map(|k| stiffness * q[k]);
            out[i * n..(i + 1) * n].iter_mut().zip(&slopes).for_each(|(o, s)| *o += qj * s);
            if j > i {
                out[j * n + i] += tension;
                out[j * n..(j + 1) * n].iter_mut().zip(&slopes).for_each(|(o, s)| *o += qi * s);
            }
        }
    }
}
