//! The stages of a step, and the explicit step.

use super::motion::Motion;
use super::tableau::Tableau;
use crate::core::problem::FieldIn;
use crate::core::scalar::Scalar;
use crate::core::vectors::in_fours;

/// The stages of one step of an integration method.
#[derive(Clone, Debug)]
pub(super) struct Stages<T> {
    /// The derivatives `k_0, k_1, …` of the stages, one stage after another (for a Rosenbrock
    /// method, the increments `u_j`).
    pub slopes: Vec<T>,
    /// The state at which the last stage is evaluated.
    pub argument: Vec<T>,
    /// The state at the end of the step.
    pub end: Vec<T>,
}

impl<T> Default for Stages<T> {
    fn default() -> Self {
        Stages { slopes: Vec::new(), argument: Vec::new(), end: Vec::new() }
    }
}

/// Heuristic: the largest size, in bytes, of a number for which intermediate values stay in
/// registers: for such numbers, steps of systems with few states are unrolled. This threshold
/// affects only the run time.
const IN_REGISTERS: usize = 72;

/// Returns the number of states for which a step is unrolled; 0 for numbers that do not stay in
/// registers.
const fn few<T>(states: usize) -> usize {
    if size_of::<T>() > IN_REGISTERS { 0 } else { states }
}

/// The largest number of stages of a method, including the stages of dense output.
const MOST: usize = 16;

impl<T: Scalar> Stages<T> {
    /// Allocates memory for `n` states.
    pub fn resize(&mut self, n: usize) {
        self.slopes.resize(MOST * n, T::zero());
        self.argument.resize(n, T::zero());
        self.end.resize(n, T::zero());
    }

    /// Returns the derivative `k_j` of one stage.
    pub fn slope(&self, stage: usize) -> &[T] {
        let n = self.end.len();
        &self.slopes[stage * n..(stage + 1) * n]
    }

    /// Returns the derivative `k_j` of one stage, as a mutable slice into which the caller writes
    /// it.
    pub fn slope_mut(&mut self, stage: usize) -> &mut [T] {
        let n = self.end.len();
        &mut self.slopes[stage * n..(stage + 1) * n]
    }

    /// Computes the state at the end of an explicit step of length `h` from `x` at `σ`, and all
    /// stages of the step except the first stage, which must be known.
    pub fn advance<F: FieldIn<T>>(
        &mut self,
        tableau: &Tableau,
        motion: &Motion<F, T>,
        step: (f64, f64),
        x: &[T],
    ) {
        in_fours(
            #[inline(always)]
            || self.advance_inline(tableau, motion, step, x),
        );
    }

    /// The inlined form of [`advance`](Self::advance), which is compiled with the processor
    /// instructions of the caller.
    #[inline(always)]
    pub fn advance_inline<F: FieldIn<T>>(
        &mut self,
        tableau: &Tableau,
        motion: &Motion<F, T>,
        step: (f64, f64),
        x: &[T],
    ) {
        match few::<T>(x.len()) {
            1 => self.advance_all::<F, 1>(tableau, motion, step, x),
            2 => self.advance_all::<F, 2>(tableau, motion, step, x),
            3 => self.advance_all::<F, 3>(tableau, motion, step, x),
            4 => self.advance_all::<F, 4>(tableau, motion, step, x),
            _ => self.advance_any(tableau, motion, step, x),
        }
    }

    #[inline(always)]
    fn advance_any<F: FieldIn<T>>(
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

    /// Computes the step for `N` states, which stay in registers.
    #[inline(always)]
    fn advance_all<F: FieldIn<T>, const N: usize>(
        &mut self,
        tableau: &Tableau,
        motion: &Motion<F, T>,
        (sigma, h): (f64, f64),
        x: &[T],
    ) {
        let (slopes, _) = self.slopes.as_chunks_mut::<N>();
        let Some(x) = x.first_chunk::<N>() else { return };
        let mut argument = *x;
        for (i, (row, node)) in tableau.rows.iter().zip(tableau.nodes).enumerate() {
            argument = combination(x, h, row, slopes);
            motion.slope(sigma + node * h, &argument, &mut slopes[i + 1]);
        }
        let end = combination(x, h, tableau.weights, slopes);
        for (to, from) in [(&mut self.argument, argument), (&mut self.end, end)] {
            if let Some(to) = to.first_chunk_mut::<N>() {
                *to = from;
            }
        }
    }

    /// Computes the time derivative at the end of the step.
    #[inline(always)]
    pub fn end_slope<F: FieldIn<T>>(&mut self, stage: usize, motion: &Motion<F, T>, sigma: f64) {
        let n = self.end.len();
        motion.slope(sigma, &self.end, &mut self.slopes[stage * n..(stage + 1) * n]);
    }
}

/// Computes `x + h Σ_j a_j k_j` and writes it into `out`; the vectors `k_j` are stored one after
/// another.
#[inline(always)]
pub(super) fn combine<T: Scalar>(
    x: &[T],
    h: f64,
    row: &[(usize, f64)],
    slopes: &[T],
    out: &mut [T],
) {
    match few::<T>(x.len()) {
        1 => combine_all::<T, 1>(x, h, row, slopes, out),
        2 => combine_all::<T, 2>(x, h, row, slopes, out),
        3 => combine_all::<T, 3>(x, h, row, slopes, out),
        4 => combine_all::<T, 4>(x, h, row, slopes, out),
        // Two components at a time, so that sums stay in registers.
        _ => {
            let n = x.len();
            for i in (0..n - n % 2).step_by(2) {
                let [first, second] = sums::<T, 2>(i, n, h, row, slopes);
                (out[i], out[i + 1]) = (x[i] + first, x[i + 1] + second);
            }
            if n % 2 == 1 {
                let [last] = sums::<T, 1>(n - 1, n, h, row, slopes);
                out[n - 1] = x[n - 1] + last;
            }
        }
    }
}

/// Computes the linear combination for `N` states, whose sums stay in registers.
#[inline(always)]
fn combine_all<T: Scalar, const N: usize>(
    x: &[T],
    h: f64,
    row: &[(usize, f64)],
    slopes: &[T],
    out: &mut [T],
) {
    let (slopes, _) = slopes.as_chunks::<N>();
    if let (Some(x), Some(out)) = (x.first_chunk::<N>(), out.first_chunk_mut::<N>()) {
        *out = combination(x, h, row, slopes);
    }
}

#[inline(always)]
fn combination<T: Scalar, const N: usize>(
    x: &[T; N],
    h: f64,
    row: &[(usize, f64)],
    slopes: &[[T; N]],
) -> [T; N] {
    let Some(((first, a), rest)) = row.split_first() else { return *x };
    // Written without closures, to be compiled with the instructions of the caller.
    let mut sums = slopes[*first];
    for sum in &mut sums {
        *sum *= h * a;
    }
    for (j, a) in rest {
        let a = h * a;
        for (sum, k) in sums.iter_mut().zip(&slopes[*j]) {
            *sum += *k * a;
        }
    }
    for (sum, x) in sums.iter_mut().zip(x) {
        *sum = *x + *sum;
    }
    sums
}

/// Returns the components `i … i + N − 1` of the sum `h Σ_j a_j k_j`.
#[inline(always)]
fn sums<T: Scalar, const N: usize>(
    i: usize,
    n: usize,
    h: f64,
    row: &[(usize, f64)],
    slopes: &[T],
) -> [T; N] {
    let mut sums = [T::zero(); N];
    for (j, a) in row {
        let a = h * a;
        for (sum, k) in sums.iter_mut().zip(&slopes[j * n + i..j * n + i + N]) {
            *sum += *k * a;
        }
    }
    sums
}
