//! Lagrange polynomials through values at nodes.

use super::quadrature::gauss_legendre;
use crate::core::scalar::Scalar;

/// Evaluates the Lagrange polynomial `ℓ_j(s) = Π_{i≠j} (s − s_i)/(s_j − s_i)` of the given nodes
/// `s_i`.
pub(crate) fn lagrange<T: Scalar>(nodes: &[f64], j: usize, s: T) -> T {
    let others = (0..nodes.len()).filter(|i| *i != j);
    others.fold(T::one(), |product, i| product * ((s - nodes[i]) / (nodes[j] - nodes[i])))
}

/// `m! / Π_{i≠j} (s_j − s_i)`: the weights of the values at the nodes in the `m`-th derivative of
/// the interpolating polynomial.
pub(crate) fn highest_derivative(places: &[f64]) -> Vec<f64> {
    let factorial: f64 = (1..places.len()).map(|k| k as f64).product();
    let product = |j: usize| -> f64 {
        (0..places.len()).filter(|i| *i != j).map(|i| places[j] - places[i]).product()
    };
    (0..places.len()).map(|j| factorial / product(j)).collect()
}

/// The weights of the interpolatory quadrature with nodes between 0 and 1: the integrals of the
/// Lagrange polynomials.
pub(crate) fn node_weights(places: &[f64]) -> Vec<f64> {
    let (points, weights) = gauss_legendre(places.len());
    let integral = |j: usize| -> f64 {
        let rule = points.iter().zip(&weights);
        rule.map(|(y, w)| 0.5 * w * lagrange(places, j, 0.5 * (1.0 + y))).sum()
    };
    (0..places.len()).map(integral).collect()
}

/// The position and value of the extremum of the parabola through three samples.
pub(crate) fn extremum(samples: &[(f64, f64)]) -> Option<(f64, f64)> {
    let slope = |i: usize, j: usize| {
        let ((a, fa), (b, fb)) = (samples[i], samples[j]);
        (fb - fa) / (b - a)
    };
    let curvature = (slope(1, 2) - slope(0, 1)) / (samples[2].0 - samples[0].0);
    let middle = slope(0, 1) + curvature * (samples[1].0 - samples[0].0);
    let offset = -0.5 * middle / curvature;
    offset.is_finite().then(|| (samples[1].0 + offset, samples[1].1 + 0.5 * middle * offset))
}
