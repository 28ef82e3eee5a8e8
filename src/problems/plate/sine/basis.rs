//! The sines of odd multiples and cosines of even multiples of π, and quadrature on half intervals
//! for plates that are symmetric.

use crate::core::scalar::Scalar;
use crate::problems::plate::tensor::Rule;
use std::f64::consts::PI;

/// The largest number of odd wave numbers `1, 3, …, 2K − 1`; it is also the length of a row of
/// coefficients.
pub(super) const LARGEST: usize = 64;

/// Returns the first `count` pairs of odd wave numbers `(m, n)`, sorted by `m² + n²`, then by `m`;
/// each pair is given as `((m−1)/2, (n−1)/2)`.
pub(super) fn ordered_modes(count: usize) -> Vec<(usize, usize)> {
    // All pairs with m² + n² ≤ (2K+1)² lie in the square m, n ≤ 2K+1, and fill about π/4 of it.
    let side = (count as f64 * 4.0 / PI).sqrt().ceil() as usize + 3;
    let mut modes: Vec<_> = (0..side).flat_map(|k| (0..side).map(move |l| (k, l))).collect();
    modes.sort_by_key(|&(k, l)| ((2 * k + 1).pow(2) + (2 * l + 1).pow(2), k));
    modes.truncate(count);
    modes
}

/// The sines and cosines at Gauss points of the half interval [0, ½]; the integrals are over [0,
/// 1].
#[derive(Clone, Debug)]
pub(super) struct Grid {
    /// The number of odd wave numbers that the model uses.
    pub width: usize,
    /// The Gauss points in (0, ½).
    pub points: Vec<f64>,
    /// The quadrature weights of the Gauss points; their sum is 1 because all integrated functions
    /// are even about ½, and the integrals are over [0, 1].
    pub weights: Vec<f64>,
    /// The values `sin (2k+1)πx` at the Gauss points; the values at one point are stored together.
    sines: Vec<f64>,
    /// `cos (2k+1)πx`.
    cosines: Vec<f64>,
    /// The values `cos 2kπx`, `k < 2·width`.
    even_cosines: Vec<f64>,
    /// The values `sin 2kπx`, `k < 2·width`.
    even_sines: Vec<f64>,
}

impl Grid {
    pub fn new(width: usize, count: usize) -> Self {
        let Rule { nodes, weights } = Rule::halves(count, true);
        let points: Vec<f64> = nodes.iter().map(|node| 0.5 * node).collect();
        let table = |count: usize, function: &dyn Fn(usize, f64) -> f64| -> Vec<f64> {
            points.iter().flat_map(|&x| (0..count).map(move |k| function(k, x))).collect()
        };
        let even = |k: usize, x: f64| 2.0 * PI * k as f64 * x;
        Grid {
            width,
            sines: table(width, &|k, x| (wave(k) * x).sin()),
            cosines: table(width, &|k, x| (wave(k) * x).cos()),
            even_cosines: table(2 * width, &|k, x| even(k, x).cos()),
            even_sines: table(2 * width, &|k, x| even(k, x).sin()),
            weights,
            points,
        }
    }

    pub fn sines(&self, point: usize) -> &[f64] {
        &self.sines[point * self.width..][..self.width]
    }

    pub fn cosines(&self, point: usize) -> &[f64] {
        &self.cosines[point * self.width..][..self.width]
    }

    pub fn even_cosines(&self, point: usize) -> &[f64] {
        &self.even_cosines[2 * point * self.width..][..2 * self.width]
    }

    pub fn even_sines(&self, point: usize) -> &[f64] {
        &self.even_sines[2 * point * self.width..][..2 * self.width]
    }
}

/// Returns the coefficients of the functions of x in the sum `Σ_i z_i φ_{m_i}(x) f(n_i, y)`, for
/// one value of y; `functions` gives the values `f(n, y)`.
pub(super) fn row<T: Scalar>(
    modes: &[(usize, usize)],
    z: &[T],
    functions: impl Fn(usize) -> f64,
) -> [T; LARGEST] {
    let mut row = [T::zero(); LARGEST];
    for (&(k, l), &z) in modes.iter().zip(z) {
        row[k] += z * functions(l);
    }
    row
}

/// Returns the odd multiple `(2k + 1)π` of π.
pub(super) fn wave(k: usize) -> f64 {
    (2 * k + 1) as f64 * PI
}
