//! A step as an observer sees it: its ends, and every state between them.

use super::motion::Motion;
use super::rodas;
use super::rosenbrock::Linearisation;
use super::settings::Scheme;
use super::stages::{Stages, combine};
use crate::core::field::VectorField;
use crate::core::scalar::Scalar;

/// What a step is computed in.
pub(super) struct Buffers<T: Scalar> {
    /// The state at the start of the step.
    pub x: Vec<T>,
    /// The step.
    pub stages: Stages<T>,
    /// A part of the step, taken again.
    pub partial: Stages<T>,
    /// The field linearised at the start of the step (Rosenbrock methods).
    pub linear: Linearisation<T>,
    /// Coefficients of dense output: `n` numbers for each power.
    pub dense: Vec<T>,
}

impl<T: Scalar> Default for Buffers<T> {
    fn default() -> Self {
        Buffers {
            x: Vec::new(),
            stages: Stages::default(),
            partial: Stages::default(),
            linear: Linearisation::default(),
            dense: Vec::new(),
        }
    }
}

/// One accepted step of a flow, from `σ` to `σ + h`.
///
/// A fraction of the step is a number from 0 (its start) to 1 (its end); it may carry derivatives, for
/// instance those of the time of an event by parameters.
pub struct Step<'a, F, T: Scalar> {
    pub(super) motion: &'a Motion<'a, F, T>,
    pub(super) scheme: Scheme,
    pub(super) sigma: f64,
    pub(super) h: f64,
    pub(super) buffers: &'a mut Buffers<T>,
    pub(super) interpolant: bool,
}

/// `F₀ θ + F₁ θ (1 − θ) + F₂ θ² (1 − θ) + F₃ θ² (1 − θ)² + …`: dense output in the form of Hairer, Nørsett
/// and Wanner (1993), section II.6, given the coefficients from the last one to the first.
fn nested<S: Scalar>(coefficients: impl Iterator<Item = (usize, S)>, theta: S) -> S {
    coefficients.fold(S::zero(), |sum, (power, coefficient)| {
        let factor = if power % 2 == 0 { theta } else { S::one() - theta };
        (sum + coefficient) * factor
    })
}

impl<F: VectorField, T: Scalar> Step<'_, F, T> {
    /// Where the step begins and ends, as parts of the whole flow.
    pub fn span(&self) -> (f64, f64) {
        (self.sigma, self.sigma + self.h)
    }

    /// How long the step is, as a part of the whole flow.
    pub fn length(&self) -> f64 {
        self.h
    }

    /// The place in the whole flow (from 0 to 1) of a fraction of the step.
    pub fn place(&self, fraction: T) -> T {
        fraction * self.h + self.sigma
    }

    /// The time of a fraction of the step.
    pub fn time(&self, fraction: T) -> T {
        self.motion.start + self.motion.length * self.place(fraction)
    }

    /// The state at the start of the step.
    pub fn start(&self) -> &[T] {
        &self.buffers.x
    }

    /// The state at the end of the step.
    pub fn end(&self) -> &[T] {
        &self.buffers.stages.end
    }

    /// The state at a fraction of the step by dense output: of order 7 for the method of order 8, of order 4
    /// for those of order 5. Costs three evaluations of the field a step with the former, none with the
    /// latter.
    pub fn interpolate(&mut self, fraction: T, x: &mut [T]) {
        self.prepare();
        for (i, x) in x.iter_mut().enumerate() {
            *x = self.interpolated(i, fraction, |coefficient| coefficient);
        }
    }

    /// The state at a fraction of the step by a shorter step of the same method: exact to the method's
    /// order, at the cost of a step.
    pub fn state(&mut self, fraction: T, x: &mut [T]) {
        let (sigma, h) = (self.sigma, self.h);
        let motion = self.motion.slowed(sigma, fraction);
        let Buffers { x: start, stages, partial, linear, .. } = &mut *self.buffers;
        match self.scheme.tableau() {
            Some(tableau) => {
                for (slow, k) in partial.slope_mut(0).iter_mut().zip(stages.slope(0)) {
                    *slow = *k * fraction;
                }
                partial.advance(tableau, &motion, (0.0, h), start);
            }
            None => {
                // The matrix of a shorter step is farther from singular than that of the step.
                partial.advance_linearised(linear, &motion, fraction, (0.0, h), start);
            }
        }
        x.copy_from_slice(&partial.end);
    }

    /// The slope `dx/dσ = L f(t, x, p)` of the flow in a state at a fraction of the step.
    pub fn slope(&self, fraction: T, x: &[T], slope: &mut [T]) {
        self.motion.slope_at(self.time(fraction), x, slope);
    }

    /// State `i` at a fraction of the step by dense output, in any scalar type that the coefficients can be
    /// lifted to. [`prepare`](Self::prepare) comes first.
    pub(super) fn interpolated<S: Scalar>(&self, i: usize, theta: S, lift: impl Fn(T) -> S) -> S {
        let n = self.buffers.x.len();
        let powers = self.buffers.dense.len() / n;
        let coefficients =
            (0..powers).rev().map(|power| (power, lift(self.buffers.dense[power * n + i])));
        nested(coefficients, theta) + lift(self.buffers.x[i])
    }

    /// Computes the coefficients of dense output, once.
    pub(super) fn prepare(&mut self) {
        if !self.interpolant {
            match self.scheme.tableau() {
                Some(_) => self.prepare_explicit(),
                None => self.prepare_linearised(),
            }
            self.interpolant = true;
        }
    }

    fn prepare_explicit(&mut self) {
        let Some(tableau) = self.scheme.tableau() else { return };
        let (sigma, h) = (self.sigma, self.h);
        let Buffers { x, stages, partial, dense, .. } = &mut *self.buffers;
        let n = x.len();
        let rows = tableau.extra_rows.iter().zip(tableau.extra_nodes);
        for (i, (row, node)) in rows.enumerate() {
            combine(x, h, row, &stages.slopes, &mut partial.argument);
            let slope = stages.slope_mut(tableau.end() + 1 + i);
            self.motion.slope(sigma + node * h, &partial.argument, slope);
        }
        dense.resize((3 + tableau.dense.len()) * n, T::zero());
        for i in 0..n {
            let change = stages.end[i] - x[i];
            let hermite = stages.slope(0)[i] * h - change;
            dense[i] = change;
            dense[n + i] = hermite;
            dense[2 * n + i] = change - stages.slope(tableau.end())[i] * h - hermite;
            for (power, row) in tableau.dense.iter().enumerate() {
                let terms = row.iter().map(|(j, d)| stages.slope(*j)[i] * (h * d));
                dense[(3 + power) * n + i] = terms.fold(T::zero(), |sum, term| sum + term);
            }
        }
    }

    fn prepare_linearised(&mut self) {
        let Buffers { x, stages, dense, .. } = &mut *self.buffers;
        let n = x.len();
        dense.resize(4 * n, T::zero());
        for i in 0..n {
            let sum = |row: &[f64]| {
                let terms = row.iter().enumerate().map(|(j, h)| stages.slope(j)[i] * *h);
                terms.fold(T::zero(), |sum, term| sum + term)
            };
            let [first, second, third] = [0, 1, 2].map(|power| sum(&rodas::DENSE[power]));
            dense[i] = stages.end[i] - x[i];
            dense[n + i] = first;
            dense[2 * n + i] = second + third;
            dense[3 * n + i] = -third;
        }
    }
}
