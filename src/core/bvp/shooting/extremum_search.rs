//! Extrema and upward crossings of monitored functions along an interval.

use crate::core::bvp::erased::Watching;
use crate::core::bvp::interval::{Interval, MonitoredFunctions};
use crate::core::ode::{Extrema, Extremum, RealStep, Roots, Step};
use crate::core::problem::{FieldIn, Observable, Opposite, WatchIn};
use crate::core::scalar::Scalar;
use std::ops::ControlFlow;

/// The search for extrema of monitored functions along an interval; calls `visit` with the
/// function's number, the position in the interval, and the function's value.
pub(super) struct ExtremumSearch<'a> {
    pub functions: MonitoredFunctions<'a>,
    pub observers: &'a mut Observers,
    pub visit: &'a mut dyn FnMut(usize, f64, f64),
}

/// One observer of extrema for each monitored function.
#[derive(Default)]
pub(super) struct Observers {
    extrema: Vec<Extrema<f64>>,
    rises: Vec<Roots<f64>>,
    step: RealStep,
    /// The states at an upward zero crossing of a monitored function.
    x: Vec<f64>,
}

impl ExtremumSearch<'_> {
    /// Begins the search along a new flow.
    pub fn begin(&mut self) {
        let Observers { extrema, rises, step, .. } = &mut *self.observers;
        // Unused observers keep their buffers.
        extrema.resize_with(extrema.len().max(self.functions.extrema.len()), Extrema::default);
        rises.resize_with(rises.len().max(self.functions.rises.len()), Roots::default);
        extrema.iter_mut().for_each(Extrema::restart);
        rises.iter_mut().for_each(Roots::restart);
        step.restart();
    }

    /// Visits the monitored functions at an end of the interval with the states `x`.
    pub fn end(&mut self, interval: &Interval<f64>, place: f64, x: &[f64]) {
        for (k, &observable) in self.functions.extrema.iter().enumerate() {
            (self.visit)(k, place, value_at(interval, observable, place, x));
        }
    }

    /// Visits the extrema and upward zero crossings of the monitored functions in one step of a
    /// flow of real numbers.
    pub fn real<F: FieldIn<f64>>(
        &mut self,
        interval: &Interval<f64>,
        step: &mut Step<F, f64>,
    ) -> ControlFlow<()> {
        let (Observers { extrema, rises, x, .. }, functions) =
            (&mut *self.observers, self.functions);
        for (k, extrema) in extrema.iter_mut().enumerate().take(functions.extrema.len()) {
            let visit = |found: Extremum<f64>| (self.visit)(k, found.place, found.value);
            extrema.search(&extremum(functions, interval, k), step, visit);
        }
        for (k, (rises, &[through, value])) in rises.iter_mut().zip(functions.rises).enumerate() {
            let _ = rises.search(&Opposite(&interval.watching(through)), step, |step, root| {
                x.resize(step.start().len(), 0.0);
                step.state(root.fraction, x);
                let place = step.place(root.fraction);
                (self.visit)(
                    functions.extrema.len() + k,
                    place,
                    value_at(interval, value, place, x),
                );
                ControlFlow::Continue(())
            });
        }
        ControlFlow::Continue(())
    }

    /// Visits the extrema and upward crossings in one step of an explicit method for dual numbers;
    /// the search is skipped if the values at the ends of the step exclude both.
    pub fn dual<F: FieldIn<T>, T: Scalar>(
        &mut self,
        interval: &Interval<f64>,
        step: &Step<F, T>,
    ) -> ControlFlow<()> {
        let (Observers { extrema, rises, .. }, functions) = (&mut *self.observers, self.functions);
        let mut all = extrema.iter_mut().enumerate().take(functions.extrema.len());
        let mut both = rises.iter_mut().zip(functions.rises);
        if all.any(|(k, extrema)| extrema.may_turn(&extremum(functions, interval, k), step))
            || both
                .any(|(rises, pair)| rises.may_fall(&Opposite(&interval.watching(pair[0])), step))
        {
            let mut real = std::mem::take(&mut self.observers.step);
            step.without_derivatives(&mut real, |step| {
                let _ = self.real(interval, step);
            });
            self.observers.step = real;
        }
        ControlFlow::Continue(())
    }
}

/// Computes the value of a monitored function at a point of an interval with the states `x`.
fn value_at(interval: &Interval<f64>, observable: Observable, place: f64, x: &[f64]) -> f64 {
    let (start, length) = interval.times();
    interval.watching(observable).value_in(start + place * length, x, interval.q)
}

/// Returns the `k`-th function whose extrema are monitored.
fn extremum<'a>(
    functions: MonitoredFunctions,
    interval: &Interval<'a, f64>,
    k: usize,
) -> Watching<'a> {
    Watching { scale: functions.scales[k], ..interval.watching(functions.extrema[k]) }
}
