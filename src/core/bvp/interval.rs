//! Intervals of meshes with their data, and the equations and scalars that belong to them.

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
    /// Where the interval begins.
    pub start: f64,
    /// Where it ends.
    pub end: f64,
}

impl Span {
    /// A place between its ends, from 0 to 1.
    pub(super) fn at(&self, place: f64) -> f64 {
        self.start + (self.end - self.start) * place
    }
}

/// An interval with its data: what its equations are evaluated at.
#[derive(Clone, Copy)]
pub struct Interval<'a, T> {
    /// The problem.
    pub problem: &'a dyn Equations,
    /// The place of the interval.
    pub span: Span,
    /// Values at its nodes, point by point: `n` states at the first node, then at the second.
    pub nodes: &'a [T],
    /// All numbers `q = (p, e)`.
    pub q: &'a [T],
}

impl<'a, T: Number> Interval<'a, T> {
    /// The field of its segment.
    pub fn field(&self) -> FieldRef<'a, T> {
        T::residual(self.problem).on_segment(self.span.segment, self.q)
    }

    /// The duration of its segment.
    pub fn duration(&self) -> T {
        T::residual(self.problem).duration_in(self.span.segment, self.q)
    }

    /// The time at a place of it, from 0 to 1.
    pub(super) fn time(&self, place: f64) -> T {
        self.duration() * (self.span.start + self.length() * place)
    }

    /// The time at which it starts, and its length in time.
    pub(super) fn times(&self) -> (T, T) {
        let duration = self.duration();
        (duration * self.span.start, duration * self.length())
    }
}

impl<'a, T> Interval<'a, T> {
    /// A scalar along its segment.
    pub(super) fn watching(&self, observable: Observable) -> Watching<'a> {
        let watched = Watched::new(self.span.segment, observable);
        Watching { problem: self.problem, watched, scale: 1.0 }
    }

    /// Its length, as a part of the segment's duration.
    pub fn length(&self) -> f64 {
        self.span.end - self.span.start
    }
}

/// The equations of one interval, linearised: `m·n` rows.
pub struct Block<'a> {
    /// The residual.
    pub residual: &'a mut [f64],
    /// Derivatives by the `(m + 1)·n` values at the interval's nodes, one row after the other.
    pub nodes: &'a mut [f64],
    /// Derivatives by the active components of `q`, one row after the other.
    pub numbers: &'a mut [f64],
}

/// Functions monitored along an interval, numbered from the first extremum to the last upward
/// crossing.
#[derive(Clone, Copy, Debug, Default)]
pub struct MonitoredFunctions<'a> {
    /// Scalars whose extrema are wanted.
    pub extrema: &'a [Observable],
    /// Their typical sizes.
    pub scales: &'a [f64],
    /// Pairs of which the second is wanted where the first one rises through zero.
    pub rises: &'a [[Observable; 2]],
}

impl MonitoredFunctions<'_> {
    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.extrema.is_empty() && self.rises.is_empty()
    }
}

/// `Σ w_i x_i`.
pub(super) fn weighted<T: Scalar>(x: &[T], weights: &[f64]) -> T {
    let mut sum = T::zero();
    x.iter().zip(weights).for_each(|(x, weight)| sum += *x * *weight);
    sum
}

/// The cause with the segment and the time at which it happened.
pub(super) fn placed(cause: impl Into<Failure>, segment: usize, t: f64) -> Failure {
    cause.into().at(format_args!("at t = {t:.6e} on segment {segment}"))
}
