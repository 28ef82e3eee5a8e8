//! What is watched while an interval is flowed.

use super::times;
use crate::core::bvp::{BoundaryProblem, Interval, Observable, Watchlist};
use crate::core::field::VectorField;
use crate::core::flow::{Extrema, Extremum, RealStep, Rises, Step};
use crate::core::scalar::Scalar;
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
    pub fn end<P: BoundaryProblem>(&mut self, interval: &Interval<P, f64>, place: f64, x: &[f64]) {
        for (k, &observable) in self.watched.extrema.iter().enumerate() {
            (self.visit)(k, place, seen(interval, observable, place, x));
        }
    }

    /// Visits the extrema in a step of the flow of real numbers.
    pub fn real<P: BoundaryProblem, F: VectorField>(
        &mut self,
        interval: &Interval<P, f64>,
        step: &mut Step<F, f64>,
    ) -> ControlFlow<()> {
        let Search { extrema, rises, .. } = &mut *self.search;
        for (k, (extrema, &observable)) in extrema.iter_mut().zip(self.watched.extrema).enumerate()
        {
            let visit = |found: Extremum<f64>| (self.visit)(k, found.place, found.value);
            extrema.search(&interval.watching(observable), step, visit);
        }
        for (k, (rise, &[through, value])) in rises.iter_mut().zip(self.watched.rises).enumerate() {
            rise.search(&interval.watching(through), step, |place, x| {
                (self.visit)(
                    self.watched.extrema.len() + k,
                    place,
                    seen(interval, value, place, x),
                );
            });
        }
        ControlFlow::Continue(())
    }

    /// The same in a step of dual numbers.
    pub fn dual<P: BoundaryProblem, F: VectorField, T: Scalar>(
        &mut self,
        interval: &Interval<P, f64>,
        step: &Step<F, T>,
    ) -> ControlFlow<()> {
        let Search { extrema, rises, step: real } = &mut *self.search;
        for (k, (extrema, &observable)) in extrema.iter_mut().zip(self.watched.extrema).enumerate()
        {
            let visit = |found: Extremum<f64>| (self.visit)(k, found.place, found.value);
            extrema.search_real(&interval.watching(observable), step, real, visit);
        }
        for (k, (rise, &[through, value])) in rises.iter_mut().zip(self.watched.rises).enumerate() {
            rise.search_real(&interval.watching(through), step, real, |place, x| {
                (self.visit)(
                    self.watched.extrema.len() + k,
                    place,
                    seen(interval, value, place, x),
                );
            });
        }
        ControlFlow::Continue(())
    }
}

/// What is seen of a scalar at a place of an interval, where the states are `x`.
fn seen<P: BoundaryProblem>(
    interval: &Interval<P, f64>,
    observable: Observable,
    place: f64,
    x: &[f64],
) -> f64 {
    let (start, length) = times(interval);
    let Interval { problem, span, q, .. } = *interval;
    problem.observe(observable, span.segment, start + place * length, x, q)
}
