//! Polynomials through values at nodes.

/// The Lagrange polynomial `ℓ_j(s) = Π_{i≠j} (s − s_i)/(s_j − s_i)` of these nodes.
pub(super) fn lagrange(nodes: &[f64], j: usize, s: f64) -> f64 {
    let others = (0..nodes.len()).filter(|i| *i != j);
    others.map(|i| (s - nodes[i]) / (nodes[j] - nodes[i])).product()
}
