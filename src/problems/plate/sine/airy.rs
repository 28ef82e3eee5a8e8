//! The stress function of eqs. 3.18–3.25, whose coefficients are quadratic in the deflection.

use super::basis::wave;
use crate::core::scalar::Scalar;
use std::f64::consts::PI;

/// One term `b w_i w_j`, `i ≤ j`, of a quadratic form.
#[derive(Clone, Copy, Debug)]
struct Term {
    i: u32,
    j: u32,
    b: f64,
}

/// One term `cos mπx cos nπy` of the stress function.
#[derive(Clone, Copy, Debug)]
struct Function {
    m: u32,
    n: u32,
    /// The position of the first term of the quadratic form that gives the coefficient of this term
    /// of the stress function.
    first: u32,
    end: u32,
}

/// The quadratic forms `B_mn(w) = Σ b_rspq w_rs w_pq` of eq. 3.24, where the sum runs over ordered
/// pairs of modes.
///
/// The bracket `Φ` of the deflection with itself is `Φ(w,w) = −(π⁴/4) Σ B_mn cos mπx cos nπy`, and
/// gives the coefficients `f_mn = B_mn / [8 (αm² + n²/α)²]` of the stress function.
#[derive(Clone, Debug)]
pub(super) struct Airy {
    functions: Vec<Function>,
    terms: Vec<Term>,
}

impl Airy {
    /// Creates the quadratic forms for modes with odd wave numbers, given as `((m−1)/2, (n−1)/2)`.
    pub fn new(modes: &[(usize, usize)]) -> Self {
        let mut all: Vec<((u32, u32), Term)> = Vec::new();
        for (j, &(k, l)) in modes.iter().enumerate() {
            let (p, q) = (2 * k as i64 + 1, 2 * l as i64 + 1);
            for (i, &(k, l)) in modes.iter().enumerate().take(j + 1) {
                let (r, s) = (2 * k as i64 + 1, 2 * l as i64 + 1);
                for (m, n, sign) in [
                    ((r - p).abs(), (s - q).abs(), -1),
                    (r + p, s + q, -1),
                    (r + p, (s - q).abs(), 1),
                    ((r - p).abs(), s + q, 1),
                ] {
                    let b = 2 * r * s * p * q + sign * (r * r * q * q + s * s * p * p);
                    if b != 0 {
                        let b = if i == j { b } else { 2 * b } as f64;
                        let term = Term { i: i as u32, j: j as u32, b };
                        all.push(((m as u32, n as u32), term));
                    }
                }
            }
        }
        all.sort_by_key(|&(function, _)| function);
        let mut functions: Vec<Function> = Vec::new();
        for (index, &((m, n), _)) in all.iter().enumerate() {
            let end = index as u32 + 1;
            match functions.last_mut() {
                Some(last) if (last.m, last.n) == (m, n) => last.end = end,
                _ => functions.push(Function { m, n, first: index as u32, end }),
            }
        }
        Airy { functions, terms: all.into_iter().map(|(_, term)| term).collect() }
    }

    fn terms(&self, function: &Function) -> &[Term] {
        &self.terms[function.first as usize..function.end as usize]
    }

    /// Computes the coefficients `f_mn` of the stress function, eq. 3.24 with `c = 1/8`.
    fn coefficient<T: Scalar>(&self, function: &Function, w: &[T], aspect: T) -> T {
        let add = |sum: T, term: &Term| sum + w[term.i as usize] * w[term.j as usize] * term.b;
        let form = self.terms(function).iter().fold(T::zero(), add);
        let (m, n) = (function.m as f64, function.n as f64);
        form / ((aspect * (m * m) + aspect.recip() * (n * n)).powi(2) * 8.0)
    }

    /// Returns all terms of the stress function as `(m, n, f_mn)`.
    pub fn coefficients<T: Scalar>(&self, w: &[T], aspect: T) -> Vec<(usize, usize, T)> {
        let all = self.functions.iter();
        all.map(|f| (f.m as usize, f.n as usize, self.coefficient(f, w, aspect))).collect()
    }

    /// Adds the stretching term `−κ ∫∫ φ_i Φ(w, Σ f_mn ψ_mn)` to component `i` of the residual,
    /// with `κ = 12(1−ν²)α₁²/α²`.
    ///
    /// For these functions, the trilinear form of the bracket `Φ` is symmetric. The integral is
    /// therefore half the derivative of `∫∫ Φ(w,w) ψ_mn` with respect to `w_i`, and can be computed
    /// from the same quadratic form.
    pub fn add_force<T: Scalar>(&self, w: &[T], aspect: T, kappa: T, r: &mut [T]) {
        for function in &self.functions {
            let square = |m: u32| if m == 0 { 1.0 } else { 0.5 };
            let factor = PI.powi(4) / 8.0 * square(function.m) * square(function.n);
            let force = self.coefficient(function, w, aspect) * kappa * factor;
            for term in self.terms(function) {
                let (i, j) = (term.i as usize, term.j as usize);
                let scaled = force * term.b;
                r[i] += scaled * w[j];
                r[j] += scaled * w[i];
            }
        }
    }
}

/// Computes `(κp_x, κp_y)` with `p_x`, `p_y` of eqs. 3.22–3.23, which are the mean forces between
/// immovable edges.
pub(super) fn edge_tension<T: Scalar>(
    modes: &[(usize, usize)],
    w: &[T],
    [gap_ratio, aspect, nu]: [T; 3],
) -> [T; 2] {
    let (mut slope_x, mut slope_y) = (T::zero(), T::zero());
    for (&(k, l), &w) in modes.iter().zip(w) {
        let square = w * w;
        slope_x += square * wave(k).powi(2);
        slope_y += square * wave(l).powi(2);
    }
    let slope_y = slope_y / (aspect * aspect);
    let scale = gap_ratio * gap_ratio * 1.5;
    [scale * (slope_x + nu * slope_y), scale * (nu * slope_x + slope_y) / (aspect * aspect)]
}
