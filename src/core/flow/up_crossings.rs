//! UpCrossings along a flow of real numbers: where a watched function goes up through zero.

use super::step::Step;
use super::watch_sampler::{Sample, WatchSampler};
use crate::core::scalar::Scalar;
use crate::core::scalar_field::FieldIn;
use crate::core::watch::Watchable;

/// How many times the place of a rise is improved at most.
const ROUNDS: usize = 12;
/// A place that changes by less than this part of a step is found.
const SETTLED: f64 = 1e-12;

/// The search for places where a watched function is zero or less at the beginning of a step, and
/// positive at its end. A function that is positive for less than a step is not seen.
#[derive(Clone, Debug, Default)]
pub(in crate::core) struct UpCrossings {
    sampler: WatchSampler<f64>,
}

impl UpCrossings {
    /// Whether the function rises in a step, of whatever numbers, as far as its ends are known.
    pub fn may_rise<F: FieldIn<T>, T: Scalar, W: Watchable<f64>>(
        &mut self,
        watch: &W,
        step: &Step<F, T>,
    ) -> bool {
        self.sampler.ends(step, watch, None).is_none_or(|ends| rises(&ends))
    }

    /// Calls `visit` with the place in the flow (from 0 to 1) and the state there, if the function
    /// rises in a step.
    pub fn search<F: FieldIn<f64>, W: Watchable<f64>>(
        &mut self,
        watch: &W,
        step: &mut Step<F, f64>,
        visit: impl FnOnce(f64, &[f64]),
    ) {
        if !self.may_rise(watch, step) {
            return;
        }
        step.prepare();
        let ends = [0.0, 1.0].map(|fraction| self.sampler.sample(step, watch, fraction));
        if !rises(&ends) {
            return;
        }
        // From the root of dense output, Newton's method on shorter steps.
        let mut theta = self.sampler.root(step, watch, ends, Sample::crossing).fraction;
        for _ in 0..ROUNDS {
            let (value, slope) = self.sampler.exact(step, watch, theta);
            let change = value / slope;
            if !(0.0..=1.0).contains(&(theta - change)) || change.abs() < SETTLED {
                break;
            }
            theta -= change;
        }
        let place = step.place(theta);
        visit(place, step.exact(theta).0);
    }
}

fn rises([first, last]: &[Sample; 2]) -> bool {
    first.value <= 0.0 && last.value > 0.0
}
