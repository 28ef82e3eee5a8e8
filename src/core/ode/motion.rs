//! The differential equation in scaled time.

use crate::core::problem::FieldIn;
use crate::core::scalar::Scalar;
use std::cell::Cell;

/// The differential equation `dx/dσ = g(σ, x) = L f(t₀ + σ L, x, p)`, with the vector field `f` and
/// the duration `L`.
pub(super) struct Motion<'a, F, T> {
    /// The field `f`.
    pub field: &'a F,
    /// The time `t₀` at `σ = 0`.
    pub start: T,
    /// The duration `L`.
    pub length: T,
    /// The parameters `p`.
    pub p: &'a [T],
    /// The number of evaluations of the vector field so far.
    pub evaluations: &'a Cell<usize>,
}

impl<F: FieldIn<T>, T: Scalar> Motion<'_, F, T> {
    /// Returns the time at the position `σ` in the flow.
    #[inline(always)]
    pub fn time(&self, sigma: f64) -> T {
        self.start + self.length * sigma
    }

    /// Counts one evaluation of the vector field.
    pub fn count(&self) {
        self.evaluations.set(self.evaluations.get() + 1);
    }

    /// Computes `g(σ, x)` and writes it into `slope`.
    #[inline(always)]
    pub fn slope(&self, sigma: f64, x: &[T], slope: &mut [T]) {
        self.slope_at(self.time(sigma), x, slope);
    }

    /// Computes the right-hand side `g` at a given time and writes it into `slope`.
    #[inline(always)]
    pub fn slope_at(&self, time: T, x: &[T], slope: &mut [T]) {
        self.count();
        self.field.slope(time, x, self.p, slope);
        for slope in slope {
            *slope *= self.length;
        }
    }

    /// Returns the motion that is slowed down by the factor `fraction` from `σ` on: between `σ` and
    /// `σ + h`, the slowed motion passes the same states as the original motion between `σ` and `σ
    /// + h·fraction`.
    pub fn slowed(&self, sigma: f64, fraction: T) -> Self {
        Motion { start: self.time(sigma), length: self.length * fraction, ..*self }
    }
}
