//! The Rosenbrock method Rodas5P.
//!
//! The method is compiled for all scalar types in which residuals are computed, because
//! work-precision diagrams use it for folds of stiff orbits; the scalar types of second and third
//! order take 0.9 % of the compiled code.
//!
//! With `J = ∂g/∂x` and `ġ = ∂g/∂σ` at the start of the step, each stage solves the following
//! linear system for its increment `u_i`:
//!
//! ```text
//!     (I/(hγ) − J) u_i = g(σ + c_i h, x + Σ_j a_ij u_j) + Σ_j (C_ij/h) u_j + h d_i ġ
//! ```
//!
//! The state at the end of the step is `x + Σ_j m_j u_j`. The increment of the last stage is the
//! error estimate (Hairer and Wanner 1996, section IV.7; coefficients: G. Steinebach, BIT Numer.
//! Math. 63:27, 2023).

use super::motion::Motion;
use super::rodas::{COUPLING, GAMMA, NODES, ROWS, STAGES, TIME};
use super::stages::{Stages, combine};
use crate::core::linalg::refill;
use crate::core::problem::{FieldIn, WIDTH, Wide};
use crate::core::scalar::{Scalar, seeded};

/// The linearisation of the vector field at the start of a step, and the factored matrix of the
/// stages.
pub(super) struct Linearisation<T: Scalar> {
    /// The Jacobian `J`, stored row by row.
    jacobian: Vec<T>,
    /// `ġ`.
    time: Vec<T>,
    matrix: Lu<T>,
    x: Vec<Wide<T>>,
    p: Vec<Wide<T>>,
    f: Vec<Wide<T>>,
}

impl<T: Scalar> Default for Linearisation<T> {
    fn default() -> Self {
        let (jacobian, time, x, p, f) = Default::default();
        let matrix = Lu { n: 0, factors: Vec::new(), pivots: Vec::new() };
        Linearisation { jacobian, time, matrix, x, p, f }
    }
}

impl<T: Scalar> Linearisation<T> {
    /// Linearises the vector field at `x` and `σ`, in chunks of directions: all states, then time.
    pub fn update<F: FieldIn<T>>(&mut self, motion: &Motion<F, T>, sigma: f64, x: &[T]) {
        let n = x.len();
        self.resize(n);
        refill(&mut self.p, motion.p.iter().map(|p| Wide::of(*p)));
        self.f.resize(n, Wide::of(T::zero()));
        for first in (0..=n).step_by(WIDTH) {
            refill(&mut self.x, x.iter().enumerate().map(|(j, x)| seeded(*x, j, first)));
            let time = seeded(motion.time(sigma), n, first);
            motion.count();
            motion.field.wide_slope(time, &self.x, &self.p, &mut self.f);
            for (i, f) in self.f.iter().enumerate() {
                for (j, part) in (first..=n).zip(f.eps) {
                    let part = part * motion.length;
                    match self.jacobian[i * n..(i + 1) * n].get_mut(j) {
                        Some(entry) => *entry = part,
                        None => self.time[i] = part * motion.length,
                    }
                }
            }
        }
    }

    fn resize(&mut self, n: usize) {
        self.jacobian.resize(n * n, T::zero());
        self.time.resize(n, T::zero());
        self.matrix.resize(n);
    }
}

impl<T: Scalar> Stages<T> {
    /// Computes the stages of a step of length `h` from `x` at `σ`, and the state at the end of the
    /// step; returns `false` if the matrix of the stages is singular. The step solves the equation
    /// whose vector field is `fraction` times the linearised vector field.
    pub fn advance_linearised<F: FieldIn<T>>(
        &mut self,
        linear: &mut Linearisation<T>,
        motion: &Motion<F, T>,
        fraction: T,
        (sigma, h): (f64, f64),
        x: &[T],
    ) -> bool {
        let n = x.len();
        let diagonal = T::constant(1.0 / (h * GAMMA));
        linear.matrix.fill(|i, j| {
            let entry = -linear.jacobian[i * n + j] * fraction;
            if i == j { entry + diagonal } else { entry }
        });
        if !linear.matrix.factor() {
            return false;
        }
        for i in 0..STAGES {
            combine(x, 1.0, ROWS[i], &self.slopes, &mut self.argument);
            let (known, new) = self.slopes.split_at_mut(i * n);
            let right = &mut new[..n];
            motion.slope(sigma + NODES[i] * h, &self.argument, right);
            for (c, right) in right.iter_mut().enumerate() {
                for (j, coupling) in COUPLING[i] {
                    *right += known[j * n + c] * (coupling / h);
                }
                *right += linear.time[c] * fraction * fraction * (h * TIME[i]);
            }
            linear.matrix.solve(right);
        }
        combine(x, 1.0, ROWS[STAGES], &self.slopes, &mut self.end);
        true
    }
}

/// The factorisation of a small matrix of dual numbers; pivots are chosen by real parts.
struct Lu<T> {
    n: usize,
    /// The factor `L` below the diagonal (with a unit diagonal) and the factor `U` on and above the
    /// diagonal, stored row by row.
    factors: Vec<T>,
    /// The row exchanges: row `k` was exchanged with row `pivots[k]`.
    pivots: Vec<usize>,
}

impl<T: Scalar> Lu<T> {
    fn resize(&mut self, n: usize) {
        self.n = n;
        self.factors.resize(n * n, T::zero());
        self.pivots.resize(n, 0);
    }

    fn fill(&mut self, entry: impl Fn(usize, usize) -> T) {
        for (k, slot) in self.factors.iter_mut().enumerate() {
            *slot = entry(k / self.n, k % self.n);
        }
    }

    /// Factors the matrix in place; returns `false` if a pivot vanishes or is not finite.
    fn factor(&mut self) -> bool {
        let (n, a) = (self.n, &mut self.factors);
        for k in 0..n {
            let size = |a: &[T], i: usize| a[i * n + k].real().abs();
            let pivot = (k..n).fold(k, |best, i| if size(a, i) > size(a, best) { i } else { best });
            self.pivots[k] = pivot;
            if pivot != k {
                (0..n).for_each(|j| a.swap(k * n + j, pivot * n + j));
            }
            if !(size(a, k) > 0.0 && size(a, k).is_finite()) {
                return false;
            }
            let inverse = a[k * n + k].recip();
            for i in k + 1..n {
                let multiplier = a[i * n + k] * inverse;
                a[i * n + k] = multiplier;
                for j in k + 1..n {
                    let top = a[k * n + j];
                    a[i * n + j] -= multiplier * top;
                }
            }
        }
        true
    }

    /// Solves in place.
    fn solve(&self, right: &mut [T]) {
        let (n, a) = (self.n, &self.factors);
        for k in 0..n {
            right.swap(k, self.pivots[k]);
        }
        for i in 0..n {
            for j in 0..i {
                let known = right[j];
                right[i] -= a[i * n + j] * known;
            }
        }
        for i in (0..n).rev() {
            for j in i + 1..n {
                let known = right[j];
                right[i] -= a[i * n + j] * known;
            }
            right[i] /= a[i * n + i];
        }
    }
}
