//! What is watched while an interval is flowed.

use crate::core::bvp::erased::Watching;
use crate::core::bvp::{Interval, Watchlist};
use crate::core::flow::{Extrema, Extremum, RealStep, Step, UpCrossings};
use crate::core::scalar::Scalar;
use crate::core::scalar_field::FieldIn;
use crate::core::watch::{Observable, WatchIn};
use std::ops::ControlFlow;

/// Scalars that are watched along an interval, what searches for their extrema, and what is told them.
pub(super) struct Lookout<'a> {
    pub watched: Watchlist<'a>,
    pub search: &'a mut Search,
    pub visit: &'a mut dyn FnMut(usize, f64, f64),
}

/// One search for each scalar that is watched.
#[derive(Default)]
pub(super) struct Search {
    extrema: Vec<Extrema<f64>>,
    rises: Vec<UpCrossings>,
    step: RealStep,
}

impl Lookout<'_> {
    /// Begins a new flow.
    pub fn begin(&mut self) {
        let Search { extrema, rises, step } = &mut *self.search;
        // Searches that are not needed now keep their buffers.
        extrema.resize_with(extrema.len().max(self.watched.extrema.len()), Extrema::default);
        rises.resize_with(rises.len().max(self.watched.rises.len()), UpCrossings::default);
        extrema.iter_mut().for_each(Extrema::restart);
        step.restart();
    }

    /// Visits an end of the interval, where the states are `x`.
    pub fn end(&mut self, interval: &Interval<f64>, place: f64, x: &[f64]) {
        for (k, &observable) in self.watched.extrema.iter().enumerate() {
            (self.visit)(k, place, seen(interval, observable, place, x));
        }
    }

    /// Visits what is watched in a step of the flow of real numbers.
    pub fn real<F: FieldIn<f64>>(
        &mut self,
        interval: &Interval<f64>,
        step: &mut Step<F, f64>,
    ) -> ControlFlow<()> {
        let (Search { extrema, rises, .. }, watched) = (&mut *self.search, self.watched);
        for (k, extrema) in extrema.iter_mut().enumerate().take(watched.extrema.len()) {
            let visit = |found: Extremum<f64>| (self.visit)(k, found.place, found.value);
            extrema.search(&extremum(watched, interval, k), step, visit);
        }
        for (k, (rises, &[through, value])) in rises.iter_mut().zip(watched.rises).enumerate() {
            rises.search(&interval.watching(through), step, |place, x| {
                let seen = seen(interval, value, place, x);
                (self.visit)(watched.extrema.len() + k, place, seen);
            });
        }
        ControlFlow::Continue(())
    }

    /// The same in a step of dual numbers of an explicit method, where its ends do not show that there is nothing.
    pub fn dual<F: FieldIn<T>, T: Scalar>(
        &mut self,
        interval: &Interval<f64>,
        step: &Step<F, T>,
    ) -> ControlFlow<()> {
        let (Search { extrema, rises, .. }, watched) = (&mut *self.search, self.watched);
        let mut all = extrema.iter_mut().enumerate().take(watched.extrema.len());
        let mut both = rises.iter_mut().zip(watched.rises);
        if all.any(|(k, extrema)| extrema.may_turn(&extremum(watched, interval, k), step))
            || both.any(|(rises, pair)| rises.may_rise(&interval.watching(pair[0]), step))
        {
            let mut real = std::mem::take(&mut self.search.step);
            step.without_derivatives(&mut real, |step| {
                let _ = self.real(interval, step);
            });
            self.search.step = real;
        }
        ControlFlow::Continue(())
    }
}

/// What is seen of a scalar at a place of an interval, where the states are `x`.
fn seen(interval: &Interval<f64>, observable: Observable, place: f64, x: &[f64]) -> f64 {
    let (start, length) = interval.times();
    interval.watching(observable).value_in(start + place * length, x, interval.q)
}

/// A scalar whose extrema are wanted.
fn extremum<'a>(watched: Watchlist, interval: &Interval<'a, f64>, k: usize) -> Watching<'a> {
    Watching { scale: watched.scales[k], ..interval.watching(watched.extrema[k]) }
}
