//! Stages of a step, and the explicit step.

use super::motion::Motion;
use super::tableau::Tableau;
use crate::core::field::VectorField;
use crate::core::scalar::Scalar;

/// The stages of one step.
pub(super) struct Stages<T> {
    /// The slopes `k_0, k_1, …`, one stage after the other (increments `u_j` of a Rosenbrock method).
    pub slopes: Vec<T>,
    /// The argument of the last stage.
    pub argument: Vec<T>,
    /// The state at the end of the step.
    pub end: Vec<T>,
}

impl<T> Default for Stages<T> {
    fn default() -> Self {
        Stages { slopes: Vec::new(), argument: Vec::new(), end: Vec::new() }
    }
}

/// The largest number of stages of a method, dense output included.
const MOST: usize = 16;

impl<T: Scalar> Stages<T> {
    /// Makes room for `n` states.
    pub fn resize(&mut self, n: usize) {
        self.slopes.resize(MOST * n, T::zero());
        self.argument.resize(n, T::zero());
        self.end.resize(n, T::zero());
    }

    /// The slope of one stage.
    pub fn slope(&self, stage: usize) -> &[T] {
        let n = self.end.len();
        &self.slopes[stage * n..(stage + 1) * n]
    }

    /// The slope of one stage, to be written.
    pub fn slope_mut(&mut self, stage: usize) -> &mut [T] {
        let n = self.end.len();
        &mut self.slopes[stage * n..(stage + 1) * n]
    }

    /// The stages of an explicit step of length `h` from `x` at `σ`, the first of which is known, and the
    /// state at its end.
    pub fn advance<F: VectorField>(
        &mut self,
        tableau: &Tableau,
        motion: &Motion<F, T>,
        (sigma, h): (f64, f64),
        x: &[T],
    ) {
        for (i, (row, node)) in tableau.rows.iter().zip(tableau.nodes).enumerate() {
            combine(x, h, row, &self.slopes, &mut self.argument);
            let n = x.len();
            let slope = &mut self.slopes[(i + 1) * n..(i + 2) * n];
            motion.slope(sigma + node * h, &self.argument, slope);
        }
        combine(x, h, tableau.weights, &self.slopes, &mut self.end);
    }

    /// The slope at the end of the step.
    pub fn end_slope<F: VectorField>(&mut self, stage: usize, motion: &Motion<F, T>, sigma: f64) {
        let n = self.end.len();
        motion.slope(sigma, &self.end, &mut self.slopes[stage * n..(stage + 1) * n]);
    }
}

/// `x + h Σ_j a_j k_j` into `out`, with the `k_j` one after the other.
#[inline]
pub(super) fn combine<T: Scalar>(
    x: &[T],
    h: f64,
    row: &[(usize, f64)],
    slopes: &[T],
    out: &mut [T],
) {
    match row.len() {
        1 => unrolled::<T, 1>(x, h, row, slopes, out),
        2 => unrolled::<T, 2>(x, h, row, slopes, out),
        3 => unrolled::<T, 3>(x, h, row, slopes, out),
        4 => unrolled::<T, 4>(x, h, row, slopes, out),
        5 => unrolled::<T, 5>(x, h, row, slopes, out),
        6 => unrolled::<T, 6>(x, h, row, slopes, out),
        7 => unrolled::<T, 7>(x, h, row, slopes, out),
        8 => unrolled::<T, 8>(x, h, row, slopes, out),
        9 => unrolled::<T, 9>(x, h, row, slopes, out),
        10 => unrolled::<T, 10>(x, h, row, slopes, out),
        _ => {
            out.copy_from_slice(x);
            for (stage, a) in row {
                let slope = &slopes[stage * x.len()..];
                out.iter_mut().zip(slope).for_each(|(out, k)| *out += *k * (h * a));
            }
        }
    }
}

/// [`combine`] for a row of known length, whose inner loop the compiler unrolls.
#[inline]
fn unrolled<T: Scalar, const M: usize>(
    x: &[T],
    h: f64,
    row: &[(usize, f64)],
    slopes: &[T],
    out: &mut [T],
) {
    let n = x.len();
    let terms: [(&[T], f64); M] =
        std::array::from_fn(|m| (&slopes[row[m].0 * n..(row[m].0 + 1) * n], h * row[m].1));
    for (i, (out, x)) in out.iter_mut().zip(x).enumerate() {
        let mut sum = terms[0].0[i] * terms[0].1;
        for (slope, a) in &terms[1..] {
            sum += slope[i] * *a;
        }
        *out = *x + sum;
    }
}
