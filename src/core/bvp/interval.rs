//! Mesh intervals with their data, equations and watched scalars.

use super::erased::{Equations, Number, Watching};
use super::terms::Watched;
use crate::core::failure::Failure;
use crate::core::problem::{FieldRef, Observable};
use crate::core::scalar::Scalar;

/// One interval of the mesh of a segment, in units of the segment's duration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Span {
    /// The segment.
    pub segment: usize,
    /// The start of the interval.
    pub start: f64,
    /// The end of the interval.
    pub end: f64,
}

impl Span {
    /// Returns the position in the mesh of a point that is given by its position in the interval,
    /// from 0 (start) to 1 (end).
    pub(super) fn at(&self, place: f64) -> f64 {
        self.start + (self.end - self.start) * place
    }
}

/// A mesh interval with the data at which its equations are evaluated.
#[derive(Clone, Copy)]
pub struct Interval<'a, T> {
    /// The problem.
    pub problem: &'a dyn Equations,
    /// The position of the interval in the mesh of its segment.
    pub span: Span,
    /// The states at the interval's nodes: `n` states at the first node, then `n` states at the
    /// second node, and so on.
    pub nodes: &'a [T],
    /// The vector `q = (p, e)` of parameters and extra unknowns.
    pub q: &'a [T],
}

impl<'a, T: Number> Interval<'a, T> {
    /// Returns the vector field of the interval's segment.
    pub fn field(&self) -> FieldRef<'a, T> {
        T::residual(self.problem).on_segment(self.span.segment, self.q)
    }

    /// Returns the duration of the interval's segment.
    pub fn duration(&self) -> T {
        T::residual(self.problem).duration_in(self.span.segment, self.q)
    }

    /// Returns the time at a point of the interval, given by its position from 0 to 1.
    pub(super) fn time(&self, place: f64) -> T {
        self.duration() * (self.span.start + self.length() * place)
    }

    /// Returns the start time of the interval, and its duration.
    pub(super) fn times(&self) -> (T, T) {
        let duration = self.duration();
        (duration * self.span.start, duration * self.length())
    }
}

impl<'a, T> Interval<'a, T> {
    /// Returns a scalar along the interval's segment, as a watched function.
    pub(super) fn watching(&self, observable: Observable) -> Watching<'a> {
        let watched = Watched::new(self.span.segment, observable);
        Watching { problem: self.problem, watched, scale: 1.0 }
    }

    /// Returns the length of the interval, as a fraction of the segment's duration.
    pub fn length(&self) -> f64 {
        self.span.end - self.span.start
    }
}

/// The linearised equations of one interval: `m·n` rows.
pub struct Block<'a> {
    /// The residual.
    pub residual: &'a mut [f64],
    /// Derivatives with respect to the `(m + 1)·n` values at the interval's nodes, row by row.
    pub nodes: &'a mut [f64],
    /// Derivatives with respect to the active entries of `q`, row by row.
    pub numbers: &'a mut [f64],
}

/// The functions that are monitored along an interval: first the functions whose extrema are
/// monitored, then pairs of functions. In each pair, the second function is evaluated where the
/// first function crosses zero upwards.
#[derive(Clone, Copy, Debug, Default)]
pub struct MonitoredFunctions<'a> {
    /// The scalars whose extrema are monitored.
    pub extrema: &'a [Observable],
    /// The typical sizes of the scalars whose extrema are monitored.
    pub scales: &'a [f64],
    /// Pairs of scalars: the second scalar is evaluated at the upward zero crossings of the first.
    pub rises: &'a [[Observable; 2]],
}

impl MonitoredFunctions<'_> {
    /// Whether no functions are monitored.
    pub fn is_empty(&self) -> bool {
        self.extrema.is_empty() && self.rises.is_empty()
    }
}

/// Computes the linear combination `Σ w_i x_i`.
pub(super) fn weighted<T: Scalar>(x: &[T], weights: &[f64]) -> T {
    let mut sum = T::zero();
    x.iter().zip(weights).for_each(|(x, weight)| sum += *x * *weight);
    sum
}

/// Converts the cause of a failure to an error that also states the segment and the time of the
/// failure.
pub(super) fn placed(cause: impl Into<Failure>, segment: usize, t: f64) -> Failure {
    cause.into().at(format_args!("at t = {t:.6e} on segment {segment}"))
}
