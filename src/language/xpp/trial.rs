//! Random trials that decide whether the motion crosses the surface of a `global` condition at its
//! event.

use super::super::Hybrid;
use crate::core::hybrid::HybridSystem;
use std::collections::BTreeSet;

/// A `global` condition whose behaviour is decided by random trials.
pub(super) struct Trial<'m> {
    pub system: &'m Hybrid,
    pub guard: usize,
    pub start: f64,
    pub x: Vec<f64>,
}

/// The number of random trials for a condition, each at another state on the surface of the
/// condition.
pub(super) const TRIALS: usize = 24;
/// The relative size below which the function of a guard and its rate of change count as zero.
const ZERO: f64 = 1e-7;

impl Trial<'_> {
    fn value(&self, t: f64, x: &[f64]) -> f64 {
        self.system.guard(self.guard, 0, t, x, &self.system.defaults())
    }

    /// Returns the rate of change of the guard's function along the motion.
    fn speed(&self, t: f64, x: &[f64]) -> f64 {
        let mut f = vec![0.0; x.len()];
        self.system.field(0, t, x, &self.system.defaults(), &mut f);
        let size = 1.0 + f.iter().fold(0.0, |most: f64, rate| most.max(rate.abs()));
        let step = 1e-6 / size;
        let at = |step: f64| {
            let x: Vec<f64> = x.iter().zip(&f).map(|(x, f)| x + step * f).collect();
            self.value(t + step, &x)
        };
        (at(step) - at(-step)) / (2.0 * step)
    }

    /// Returns whether the `global` condition is already met at the initial state.
    pub fn begins_beyond(&self) -> bool {
        let value = self.value(self.start, &self.x);
        value < 0.0 || (value == 0.0 && self.speed(self.start, &self.x) < 0.0)
    }

    /// Returns whether, for at least one of the tried states, the motion crosses the surface of the
    /// condition after its event.
    pub fn goes_on(&self, depends: &BTreeSet<usize>) -> bool {
        if depends.is_empty() {
            return true;
        }
        let mut seed = 1u64;
        let mut random = || {
            seed = seed.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (seed >> 11) as f64 / (1u64 << 53) as f64
        };
        (0..TRIALS).any(|_| {
            let t = self.start + 10.0 * random();
            let spread = |x: &f64| x + (1.0 + x.abs()) * (2.0 * random() - 1.0);
            let x: Vec<f64> = self.x.iter().map(spread).collect();
            self.on_condition(t, x, depends).is_some_and(|x| self.goes_on_at(t, &x))
        })
    }

    /// Returns a state on the surface of the condition, close to a given state.
    fn on_condition(&self, t: f64, mut x: Vec<f64>, depends: &BTreeSet<usize>) -> Option<Vec<f64>> {
        for _ in 0..30 {
            let value = self.value(t, &x);
            if value.abs() < 1e-12 {
                return Some(x);
            }
            let slopes: Vec<(usize, f64)> = depends
                .iter()
                .map(|&k| {
                    let (mut near, h) = (x.clone(), 1e-7 * (1.0 + x[k].abs()));
                    near[k] += h;
                    (k, (self.value(t, &near) - value) / h)
                })
                .collect();
            let square: f64 = slopes.iter().map(|(_, slope)| slope * slope).sum();
            if !(square > 0.0 && square.is_finite()) {
                return None;
            }
            for (k, slope) in slopes {
                x[k] -= value * slope / square;
            }
        }
        (self.value(t, &x).abs() < 1e-9).then_some(x)
    }

    fn goes_on_at(&self, t: f64, x: &[f64]) -> bool {
        if self.speed(t, x) >= -ZERO {
            return false;
        }
        let mut after = vec![0.0; x.len()];
        self.system.reset(self.guard, (0, 0), t, x, &self.system.defaults(), &mut after);
        let value = self.value(t, &after);
        value < -ZERO || (value < ZERO && self.speed(t, &after) < -ZERO)
    }
}
