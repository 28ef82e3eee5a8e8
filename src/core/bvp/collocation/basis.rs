//! Gauss–Legendre points, Lobatto nodes and the Lagrange polynomials through them.

use crate::core::numerics::{Limits, bracketed_zero, gauss_legendre, lagrange};
use crate::core::scalar::Scalar;
use num_dual::Dual64;

/// The largest number of Lobatto nodes in an interval.
const MOST: usize = 8;
/// The largest number of iterations in the search for a root of a polynomial.
const ROUNDS: usize = 60;

/// The coefficients of collocation at `m` Gauss points, for an interval scaled to length 1.
#[derive(Clone, Debug)]
pub(super) struct Basis {
    /// The Gauss points `ρ_c`.
    pub gauss: Vec<f64>,
    /// The quadrature weights of the Gauss points.
    pub weights: Vec<f64>,
    /// The Lobatto nodes.
    pub nodes: Vec<f64>,
    /// The values `ℓ_j(ρ_c)` of the Lagrange polynomials, one row for each Gauss point.
    pub values: Vec<f64>,
    /// The derivatives `ℓ_j'(ρ_c)` of the Lagrange polynomials, one row for each Gauss point.
    pub slopes: Vec<f64>,
    /// The coefficients of the Lagrange polynomials `ℓ_j` in powers of `y = 2s − 1`, one row for
    /// each node.
    powers: Vec<f64>,
    /// The values `ℓ_j(s)`, with their derivatives, at [`SAMPLES`](Self::SAMPLES) uniform places for
    /// each node, from 0 to 1; one row for each place.
    samples: Vec<Dual64>,
    /// The error constant of collocation: the maximum over `s` of `|P(s)|`, with `P(s) = ∫₀ˢ Π_c (t
    /// − ρ_c) dt / m!`.
    pub error_constant: f64,
}

impl Basis {
    /// Heuristic: the number of samples per node, in each interval, in the search for extrema of
    /// functions of the states.
    const SAMPLES: usize = 4;

    pub fn new(points: usize) -> Self {
        let (places, weights) = gauss_legendre(points);
        let gauss: Vec<f64> = places.iter().map(|y| 0.5 * (1.0 + y)).collect();
        let weights = weights.iter().map(|w| 0.5 * w).collect();
        let nodes = lobatto(&gauss);
        let (mut values, mut slopes) = (Vec::new(), Vec::new());
        for &s in &gauss {
            for j in 0..=points {
                let value = lagrange(&nodes, j, s);
                let others = (0..=points).filter(|i| *i != j);
                values.push(value);
                slopes.push(value * others.map(|i| 1.0 / (s - nodes[i])).sum::<f64>());
            }
        }
        let powers = (0..=points).flat_map(|j| powers_of_lagrange(&nodes, j)).collect();
        let error_constant = error_constant(&gauss);
        let samples = Vec::new();
        let mut basis =
            Basis { gauss, weights, nodes, values, slopes, powers, samples, error_constant };
        let places = basis.sampled_places();
        let weights = places.map(|place| basis.weights_at(Dual64::new(place, 1.0)));
        basis.samples = weights.flat_map(Iterator::collect::<Vec<_>>).collect();
        basis
    }

    /// Iterates over the uniform places at which functions of the states are sampled.
    pub fn sampled_places(&self) -> impl Iterator<Item = f64> + use<> {
        let count = Self::SAMPLES * self.nodes.len();
        (0..=count).map(move |c| c as f64 / count as f64)
    }

    /// Iterates over the weights of the nodes at the sampled place number `c`, with their
    /// derivatives.
    pub fn sampled_weights(&self, c: usize) -> impl ExactSizeIterator<Item = Dual64> {
        self.samples[c * self.nodes.len()..][..self.nodes.len()].iter().copied()
    }

    /// Iterates over the weights of the nodes at a place.
    pub fn weights_at<T: Scalar>(&self, place: T) -> impl ExactSizeIterator<Item = T> {
        (0..self.nodes.len()).map(move |j| lagrange(&self.nodes, j, place))
    }

    /// Returns the row for the Gauss point `c` in a table with one row for each Gauss point.
    #[inline]
    pub fn row<'a>(&self, table: &'a [f64], c: usize) -> &'a [f64] {
        &table[c * self.nodes.len()..(c + 1) * self.nodes.len()]
    }

    /// Visits the zeros in (0, 1) of the derivative of a polynomial that is given by its values at
    /// the nodes.
    pub fn stationary(&self, values: impl Fn(usize) -> f64, mut visit: impl FnMut(f64)) {
        let m = self.gauss.len();
        let mut slope = [0.0; MOST];
        for j in 0..=m {
            for k in 1..=m {
                slope[k - 1] += k as f64 * self.powers[j * (m + 1) + k] * values(j);
            }
        }
        let (roots, count) = roots_inside(&slope[..m]);
        roots[..count].iter().for_each(|y| visit(0.5 * (1.0 + y)));
    }
}

/// Computes the states `Σ_j ℓ_j x_j` of the interpolating polynomial at a point of an interval.
#[inline(always)]
pub(super) fn combine<T: Scalar>(coefficients: &[f64], nodes: &[T], x: &mut [T]) {
    let n = x.len();
    for (i, x) in x.iter_mut().enumerate() {
        let (mut k, mut sum) = (i, nodes[i] * coefficients[0]);
        for coefficient in &coefficients[1..] {
            k += n;
            sum += nodes[k] * *coefficient;
        }
        *x = sum;
    }
}

/// Returns the Lobatto nodes: both ends of the interval, and the stationary points of `p(s) = Π (s
/// − ρ_c)`, which lie between the Gauss points and satisfy `p'/p = Σ 1/(s − ρ_c) = 0`.
fn lobatto(gauss: &[f64]) -> Vec<f64> {
    let mut nodes = vec![0.0];
    for pair in gauss.windows(2) {
        let mut s = 0.5 * (pair[0] + pair[1]);
        for _ in 0..12 {
            let sum: f64 = gauss.iter().map(|c| 1.0 / (s - c)).sum();
            let slope: f64 = gauss.iter().map(|c| -1.0 / ((s - c) * (s - c))).sum();
            s -= sum / slope;
        }
        nodes.push(s);
    }
    nodes.push(1.0);
    nodes
}

fn powers_of_lagrange(nodes: &[f64], j: usize) -> Vec<f64> {
    let mut powers = vec![0.0; nodes.len()];
    powers[0] = 1.0;
    for (degree, i) in (0..nodes.len()).filter(|i| *i != j).enumerate() {
        let (root, scale) = (2.0 * nodes[i] - 1.0, 0.5 / (nodes[j] - nodes[i]));
        for k in (0..=degree + 1).rev() {
            let below = if k > 0 { powers[k - 1] } else { 0.0 };
            powers[k] = scale * (below - root * powers[k]);
        }
    }
    powers
}

/// Returns the largest value of `|P|`, which occurs at a Gauss point because the derivative of `P`
/// vanishes at the Gauss points. The Gauss quadrature rule with `m` points is exact for the
/// integral that defines `P`.
fn error_constant(gauss: &[f64]) -> f64 {
    let (places, weights) = gauss_legendre(gauss.len());
    let factorial: f64 = (1..=gauss.len()).map(|k| k as f64).product();
    let product = |t: f64| gauss.iter().map(|c| t - c).product::<f64>();
    let integral = |s: f64| -> f64 {
        let at = |y: &f64| product(0.5 * s * (1.0 + y));
        places.iter().zip(&weights).map(|(y, w)| 0.5 * s * w * at(y)).sum()
    };
    gauss.iter().map(|&s| integral(s).abs()).fold(0.0, f64::max) / factorial
}

fn horner(coefficients: &[f64], y: f64) -> f64 {
    coefficients.iter().rev().fold(0.0, |sum, c| sum * y + c)
}

/// Returns all points of (−1, 1) at which a polynomial changes sign, in ascending order; the
/// polynomial is given by its coefficients in ascending powers. The polynomial is monotone between
/// its stationary points, so the search brackets each sign change between two of these points,
/// which are found recursively.
fn roots_inside(coefficients: &[f64]) -> ([f64; MOST], usize) {
    let (mut roots, mut count) = ([0.0; MOST], 0);
    let rest: f64 = coefficients.iter().skip(1).map(|c| c.abs()).sum();
    if coefficients.len() < 2 || coefficients[0].abs() > rest {
        return (roots, count);
    }
    let mut slope = [0.0; MOST];
    for (k, c) in coefficients.iter().enumerate().skip(1) {
        slope[k - 1] = k as f64 * c;
    }
    let slope = &slope[..coefficients.len() - 1];
    let (turns, turn_count) = roots_inside(slope);
    let mut left = -1.0;
    for right in turns[..turn_count].iter().copied().chain([1.0]) {
        let ends = [horner(coefficients, left), horner(coefficients, right)];
        if (ends[0] < 0.0) != (ends[1] < 0.0) {
            let sign = if ends[0] < 0.0 { -1.0 } else { 1.0 };
            let limits = Limits { rounds: ROUNDS, moved: 1e-15 };
            roots[count] = bracketed_zero([left, right], sign, 0.5 * (left + right), limits, |y| {
                [horner(coefficients, y), horner(slope, y)]
            });
            count += 1;
        }
        left = right;
    }
    (roots, count)
}
