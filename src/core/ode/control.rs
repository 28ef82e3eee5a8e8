//! Step-size control: the size of an error, and the length of the next step.

use super::settings::Settings;
use super::stages::Stages;
use super::tableau::{Row, Tableau};
use crate::core::scalar::Scalar;
use crate::core::vectors::in_fours;

/// Heuristic: a state counts as small if the relative tolerance adds less than this fraction to the
/// absolute tolerance: the real part of the state then does not show how large its derivatives are.
const SMALL: f64 = 0.01;

/// Heuristic: the factor by which the tolerances of derivatives exceed the tolerances of real parts
/// if all states are small: the derivatives then control the steps.
const ALL_SMALL: f64 = 10.0;

/// Heuristic: the factor by which the tolerances of derivatives exceed the tolerances of real parts
/// if some states are small. The other states usually control the steps; but if a small state
/// decays fast, steps that are too long for stability amplify its derivatives.
const SOME_SMALL: f64 = 1e3;

/// The function that measures numbers in error estimates; by default, the size of a number is the
/// absolute value of its real part.
pub type Size<T> = fn(&T) -> f64;

/// The measure by which the errors of a step are judged, with its tolerances.
#[derive(Clone, Copy)]
pub(super) struct Measure<'a, T> {
    pub relative: f64,
    pub absolute: f64,
    /// The unit of each state's absolute tolerance.
    pub scales: &'a [f64],
    pub size: Option<Size<T>>,
    /// Whether only states that are small throughout the step are measured.
    pub only_small: bool,
}

impl<T: Scalar> Measure<'_, T> {
    /// Returns the tolerated error of a state whose values at the ends of the step are `x` and `y`.
    fn tolerated(&self, scale: f64, x: &T, y: &T) -> f64 {
        let size = |x: &T| self.size.map_or_else(|| x.real().abs(), |size| size(x));
        self.absolute * scale + self.relative * size(x).max(size(y))
    }

    /// Returns the measure for the derivatives of the states that are small throughout a step, with
    /// another definition of the size of a number and larger tolerances; `None` if no state is
    /// small.
    pub fn of_derivatives(self, size: Size<T>, x: &[T], stages: &Stages<T>) -> Option<Self> {
        let states = x.iter().zip(&stages.end).zip(self.scales);
        let small = states.filter(|((x, end), scale)| self.is_small(**scale, x, end)).count();
        if small == 0 {
            return None;
        }
        let factor = if small == x.len() { ALL_SMALL } else { SOME_SMALL };
        let (relative, absolute) = (factor * self.relative, factor * self.absolute);
        Some(Measure { relative, absolute, size: Some(size), only_small: true, ..self })
    }

    /// Whether the absolute tolerance dominates the tolerated error of a state at both ends of a
    /// step.
    fn is_small(&self, scale: f64, x: &T, end: &T) -> bool {
        self.relative * x.real().abs().max(end.real().abs()) < SMALL * self.absolute * scale
    }

    /// Computes `Σ_i (h Σ_j e_j k_ij / tolerated_i)²` for several rows `e` of error weights.
    #[inline(always)]
    fn squares<const R: usize>(
        &self,
        h: f64,
        rows: [Row; R],
        x: &[T],
        stages: &Stages<T>,
    ) -> [f64; R] {
        let (n, slopes) = (x.len(), &stages.slopes);
        let mut squares = [0.0; R];
        for (i, (x, end)) in x.iter().zip(&stages.end).enumerate() {
            if self.only_small && !self.is_small(self.scales[i], x, end) {
                continue;
            }
            let scale = 1.0 / self.tolerated(self.scales[i], x, end);
            for (square, row) in squares.iter_mut().zip(rows) {
                // Written without closures, to be compiled with the instructions of the caller.
                let (mut real, mut whole) = (0.0, T::zero());
                for (j, e) in row {
                    let (k, e) = (&slopes[j * n + i], h * e);
                    match self.size {
                        None => real += k.real() * e,
                        Some(_) => whole += *k * e,
                    }
                }
                let error = self.size.map_or(real, |size| size(&whole));
                *square += (scale * error).powi(2);
            }
        }
        squares
    }

    /// Returns the root mean square of an error estimate in units of the tolerated error; the step
    /// is acceptable if this value is at most 1.
    pub fn error(&self, h: f64, row: Row, x: &[T], stages: &Stages<T>) -> f64 {
        let [square] = self.squares(h, [row], x, stages);
        (square / x.len().max(1) as f64).sqrt()
    }

    /// Returns the error of an explicit step; if the method has two estimates `e₅` and `e₃`, the
    /// error is `e₅² / √(e₅² + e₃²/100)` (Hairer, Nørsett, Wanner 1993, eq. II.10.17).
    #[inline(never)]
    pub fn explicit_error(&self, h: f64, tableau: &Tableau, x: &[T], stages: &Stages<T>) -> f64 {
        if tableau.rough_error.is_empty() {
            return self.error(h, tableau.error, x, stages);
        }
        let [fine, rough] = in_fours(
            #[inline(always)]
            || self.squares(h, [tableau.error, tableau.rough_error], x, stages),
        );
        let together = fine + 0.01 * rough;
        let n = x.len() as f64;
        if together == 0.0 { 0.0 } else { fine / (together * n).sqrt() }
    }

    /// Returns the root mean square of a vector in units of the tolerated error at `x`.
    fn norm(&self, vector: impl Iterator<Item = f64>, x: &[T]) -> f64 {
        let tolerated = x.iter().zip(self.scales).map(|(x, scale)| self.tolerated(*scale, x, x));
        let parts = vector.zip(tolerated).map(|(v, tolerated)| (v / tolerated).powi(2));
        (parts.sum::<f64>() / x.len().max(1) as f64).sqrt()
    }

    /// Returns the length of the Euler step that measures how fast the time derivative changes.
    pub fn euler_step(&self, x: &[T], slope: &[T]) -> f64 {
        let size = self.norm(x.iter().map(T::real), x);
        let speed = self.norm(slope.iter().map(T::real), x);
        if size < 1e-5 || speed < 1e-5 { 1e-6 } else { 0.01 * size / speed }
    }

    /// Returns the length of the first step, from the time derivatives at both ends of an Euler
    /// step of length `h` (Hairer, Nørsett, Wanner 1993, section II.4).
    pub fn first_step(&self, order: usize, h: f64, x: &[T], slopes: (&[T], &[T])) -> f64 {
        let speed = self.norm(slopes.0.iter().map(T::real), x);
        let change = slopes.0.iter().zip(slopes.1).map(|(a, b)| b.real() - a.real());
        let largest = speed.max(self.norm(change, x) / h);
        let step = if largest <= 1e-15 {
            (h * 1e-3).max(1e-6)
        } else {
            (0.01 / largest).powf(1.0 / order as f64)
        };
        step.min(100.0 * h)
    }
}

/// Heuristic: the usual safety factor by which a step is shorter than the predicted step, so that
/// few steps are rejected.
const SAFETY: f64 = 0.8;

/// Heuristic: the usual lower bound of the error that the step control stores: an accidentally
/// small error must not restrict the following step.
const LEAST_ERROR: f64 = 1e-4;

/// The step control: it computes step ratios from the current error and, for methods with memory,
/// from the previous error (Gustafsson's proportional-integral control; Hairer and Wanner 1996,
/// section IV.2).
pub(super) struct Control {
    exponent: f64,
    memory: f64,
    ratios: (f64, f64),
    /// The logarithm of the error of the previous step.
    previous: f64,
    rejected: bool,
}

impl Control {
    pub fn new(settings: &Settings) -> Self {
        let order = settings.scheme.order() as f64;
        // Steinebach (2023) recommends control without memory for Rodas5P.
        let (memory, ratios) = settings
            .scheme
            .tableau()
            .map_or((0.0, (0.2, 6.0)), |tableau| (tableau.memory, tableau.ratios));
        let exponent = 1.0 / order - 0.75 * memory;
        Control { exponent, memory, ratios, previous: LEAST_ERROR.ln(), rejected: false }
    }

    /// Returns the ratio of the next step to the accepted step, whose error is given.
    pub fn accepted(&mut self, error: f64) -> f64 {
        let logarithm = error.ln();
        let ratio = SAFETY * (self.memory * self.previous - self.exponent * logarithm).exp();
        let largest = if self.rejected { 1.0 } else { self.ratios.1 };
        self.rejected = false;
        self.previous = logarithm.max(LEAST_ERROR.ln());
        ratio.clamp(self.ratios.0, largest)
    }

    /// Returns the ratio of the next trial step to the rejected step, whose error is given and can
    /// be infinite or NaN.
    pub fn rejected(&mut self, error: f64) -> f64 {
        self.rejected = true;
        if error.is_finite() {
            (SAFETY / error.powf(self.exponent)).max(self.ratios.0)
        } else {
            0.1
        }
    }
}
