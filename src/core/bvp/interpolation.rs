//! Polynomials through values at nodes.

use crate::core::scalar::Scalar;

/// The Lagrange polynomial `ℓ_j(s) = Π_{i≠j} (s − s_i)/(s_j − s_i)` of these nodes.
pub(super) fn lagrange<T: Scalar>(nodes: &[f64], j: usize, s: T) -> T {
    let others = (0..nodes.len()).filter(|i| *i != j);
    others.fold(T::one(), |product, i| product * ((s - nodes[i]) / (nodes[j] - nodes[i])))
}
