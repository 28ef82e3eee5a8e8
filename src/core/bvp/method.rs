//! How the equations of a trajectory are discretised, interval by interval.

use super::erased::{Equations, Number, Watching};
use super::problem::Watched;
use crate::core::scalar::Scalar;
use crate::core::scalar_field::FieldRef;
use crate::core::watch::Observable;
use crate::core::zero::LeftDomain;

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

/// An interval with its data: what its equations are evaluated at.
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

impl<T> Clone for Interval<'_, T> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<T> Copy for Interval<'_, T> {}

impl<'a, T: Number> Interval<'a, T> {
    /// The field of its segment.
    pub fn field(&self) -> FieldRef<'a, T> {
        T::residual(self.problem).on_segment(self.span.segment, self.q)
    }

    /// The duration of its segment.
    pub fn duration(&self) -> T {
        T::residual(self.problem).duration_in(self.span.segment, self.q)
    }
}

impl<'a, T> Interval<'a, T> {
    /// A scalar along its segment.
    pub(super) fn watching(&self, observable: Observable) -> Watching<'a> {
        let watched = Watched { segment: self.span.segment, observable };
        Watching { problem: self.problem, watched }
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

/// What is watched along an interval, numbered from the first extremum to the last rise.
#[derive(Clone, Copy, Debug, Default)]
pub struct Watchlist<'a> {
    /// Scalars whose extrema are wanted.
    pub extrema: &'a [Observable],
    /// Pairs of which the second is wanted where the first one rises through zero.
    pub rises: &'a [[Observable; 2]],
}

impl Watchlist<'_> {
    /// Whether nothing is watched.
    pub fn is_empty(&self) -> bool {
        self.extrema.is_empty() && self.rises.is_empty()
    }
}

/// A discretisation: each interval has values of the `n` states at `m + 1` nodes, the last one shared
/// with the next interval, and `m·n` equations. Collocation and shooting (`m = 1`) are methods.
pub trait Method: Send {
    /// Buffers for evaluations in one scalar type.
    type Work<T: Scalar>: Default + Send;

    /// Whether extrema come from the same work as the residual and its derivatives, so that they are best
    /// asked for together.
    const EXTREMA_WITH_RESIDUAL: bool = false;

    /// The places of the nodes in an interval, from 0 to 1: `m + 1` of them.
    fn places(&self) -> &[f64];

    /// The residual of an interval.
    ///
    /// # Errors
    /// [`LeftDomain`] where the trajectory leaves the domain of the field.
    fn residual<T: Number>(
        &self,
        interval: Interval<T>,
        work: &mut Self::Work<T>,
        r: &mut [T],
    ) -> Result<(), LeftDomain>;

    /// The states at a place in an interval (from 0 to 1).
    ///
    /// # Errors
    /// [`LeftDomain`] where the trajectory leaves the domain of the field.
    fn value<T: Number>(
        &self,
        interval: Interval<T>,
        place: f64,
        work: &mut Self::Work<T>,
        x: &mut [T],
    ) -> Result<(), LeftDomain>;

    /// Calls `visit` with the states at `count` places in an interval, evenly spread from its start on, for
    /// drawing.
    ///
    /// # Errors
    /// [`LeftDomain`] where the trajectory leaves the domain of the field.
    fn trajectory(
        &self,
        interval: Interval<f64>,
        count: usize,
        work: &mut Self::Work<f64>,
        visit: &mut dyn FnMut(f64, &[f64]),
    ) -> Result<(), LeftDomain> {
        let mut x = vec![0.0; interval.nodes.len() / self.places().len()];
        for place in (0..count).map(|k| k as f64 / count as f64) {
            self.value(interval, place, work, &mut x)?;
            visit(place, &x);
        }
        Ok(())
    }

    /// The residual of an interval with its derivatives by the nodes and by the active components
    /// of `q`.
    ///
    /// # Errors
    /// [`LeftDomain`] where the trajectory leaves the domain of the field.
    fn linearise(
        &mut self,
        interval: Interval<f64>,
        active: &[usize],
        block: Block,
    ) -> Result<(), LeftDomain>;

    /// The same with what [`extrema`](Self::extrema) visits, for methods that have both from the same work.
    ///
    /// # Errors
    /// [`LeftDomain`] where the trajectory leaves the domain of the field.
    fn linearise_watching(
        &mut self,
        interval: Interval<f64>,
        active: &[usize],
        block: Block,
        watched: Watchlist,
        visit: &mut dyn FnMut(usize, f64, f64),
    ) -> Result<(), LeftDomain> {
        self.linearise(interval, active, block)?;
        self.extrema(interval, watched, None, visit)
    }

    /// From now on residuals, their derivatives and extrema may err by as much as this: what is asked for is on
    /// the way to a solution. 0 asks for the method's own accuracy. Returns whether what is computed meanwhile
    /// serves on the way only.
    fn allow(&mut self, _error: f64) -> bool {
        false
    }

    /// Calls `visit` with number, place (from 0 to 1) and value of what is watched: at every local extremum inside
    /// an interval and at its ends, and at every rise; and writes the residual, where that is asked for.
    ///
    /// # Errors
    /// [`LeftDomain`] where the trajectory leaves the domain of the field.
    fn extrema(
        &mut self,
        interval: Interval<f64>,
        watched: Watchlist,
        residual: Option<&mut [f64]>,
        visit: &mut dyn FnMut(usize, f64, f64),
    ) -> Result<(), LeftDomain>;

    /// Calls `visit` with weight (in time), time since the segment's beginning and states at the places of a
    /// quadrature over an interval that is as accurate as the trajectory.
    ///
    /// # Errors
    /// [`LeftDomain`] where the trajectory leaves the domain of the field.
    fn quadrature<T: Number>(
        &self,
        interval: Interval<T>,
        work: &mut Self::Work<T>,
        visit: &mut dyn FnMut(T, T, &[T]),
    ) -> Result<(), LeftDomain>;

    /// The constant `C` of a method that replaces the trajectory by the polynomial of degree `m` through the
    /// nodes, so that its error in an interval of length `h` is `C hᵐ⁺¹ |x⁽ᵐ⁺¹⁾|`; `None` where the mesh
    /// causes no error.
    fn error_constant(&self) -> Option<f64> {
        None
    }

    /// The same method, of a smaller error, and by how much the intervals are to be divided; `None`
    /// where there is none finer.
    fn finer(&self) -> Option<(Self, usize)>
    where
        Self: Sized;
}

/// The cause with the segment and the time at which it happened.
pub(super) fn left_domain(cause: LeftDomain, segment: usize, t: f64) -> LeftDomain {
    LeftDomain {
        quantity: format!("{} at t = {t:.6e} on segment {segment}", cause.quantity),
        ..cause
    }
}
