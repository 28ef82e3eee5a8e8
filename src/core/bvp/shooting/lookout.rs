//! What is watched while an interval is flowed.

use crate::core::bvp::erased::Watching;
use crate::core::bvp::{Interval, Watchlist};
use crate::core::flow::{Extrema, Extremum, RealStep, Rises, Step};
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
    rises: Vec<Rises>,
    step: RealStep,
}

impl Lookout<'_> {
    /// Begins a new flow.
    pub fn begin(&mut self) {
        let Search { extrema, rises, step } = &mut *self.search;
        // Searches that are not needed now keep their buffers.
        extrema.resize_with(extrema.len().max(self.watched.extrema.len()), Extrema::default);
        rises.resize_with(rises.len().max(self.watched.rises.len()), Rises::default);
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
        self.each(
            interval,
            step,
            |extrema, watch, step, _, visit| extrema.search(watch, step, visit),
            |rises, watch, step, _, visit| rises.search(watch, step, visit),
        )
    }

    /// The same in a step of dual numbers.
    pub fn dual<F: FieldIn<T>, T: Scalar>(
        &mut self,
        interval: &Interval<f64>,
        step: &Step<F, T>,
    ) -> ControlFlow<()> {
        self.each(
            interval,
            step,
            |extrema, watch, step, real, visit| extrema.search_real(watch, step, real, visit),
            |rises, watch, step, real, visit| rises.search_real(watch, step, real, visit),
        )
    }

    /// Searches a step, of whatever numbers, for each scalar.
    fn each<S>(
        &mut self,
        interval: &Interval<f64>,
        mut step: S,
        extremum: ExtremaIn<S>,
        rise: RisesIn<S>,
    ) -> ControlFlow<()> {
        let (Search { extrema, rises, step: real }, watched) = (&mut *self.search, self.watched);
        for (k, (extrema, &observable)) in extrema.iter_mut().zip(watched.extrema).enumerate() {
            let visit = &mut |found: Extremum<f64>| (self.visit)(k, found.place, found.value);
            extremum(extrema, &interval.watching(observable), &mut step, real, visit);
        }
        for (k, (rises, &[through, value])) in rises.iter_mut().zip(watched.rises).enumerate() {
            let k = watched.extrema.len() + k;
            let visit = &mut |place: f64, x: &[f64]| {
                (self.visit)(k, place, seen(interval, value, place, x));
            };
            rise(rises, &interval.watching(through), &mut step, real, visit);
        }
        ControlFlow::Continue(())
    }
}

/// A search for extrema in a step.
type ExtremaIn<S> =
    fn(&mut Extrema<f64>, &Watching, &mut S, &mut RealStep, &mut dyn FnMut(Extremum<f64>));

/// A search for rises in a step.
type RisesIn<S> = fn(&mut Rises, &Watching, &mut S, &mut RealStep, &mut dyn FnMut(f64, &[f64]));

/// What is seen of a scalar at a place of an interval, where the states are `x`.
fn seen(interval: &Interval<f64>, observable: Observable, place: f64, x: &[f64]) -> f64 {
    let (start, length) = interval.times();
    interval.watching(observable).value_in(start + place * length, x, interval.q)
}
