//! Boundary-value problems behind one object-safe face.
//!
//! Users write a [`BoundaryProblem`](super::problem::BoundaryProblem) generically. Discretisations
//! see it through [`Equations`], one scalar at a time, so that they are compiled once and not for
//! every problem. [`Number`] lists the scalars in which residuals are evaluated, [`WatchNumber`]
//! those of watched scalars.

use super::derivatives::Derivatives;
use super::itineraries::{Guess, Itineraries};
use super::terms::{Ends, Monitor, Shape, Watched};
use crate::core::problem::{FieldRef, ROOM, WatchIn, Watchable, erased};
use crate::core::scalar::{Chunk, Jet, Narrow, Scalar};
use num_dual::{Dual, Dual2, Dual2_64, Dual64};
use std::any::Any;
use std::sync::Arc;

/// The residual of a problem in one scalar.
pub trait Residual<T: Scalar> {
    /// The field of a segment, whose numbers are `q`, at time `t` from its beginning, and how many
    /// of them it depends on.
    fn on_segment<'a>(&'a self, segment: usize, q: &'a [T]) -> FieldRef<'a, T>;

    /// The duration of a segment.
    fn duration_in(&self, segment: usize, q: &[T]) -> T;

    /// The left sides of the boundary conditions, written into `b`: by default those of an orbit
    /// that closes. (Segments of the shape [`Shape::Cycle`] have
    /// [`segment_end_in`](Self::segment_end_in).)
    fn boundary_in(&self, ends: Ends<T>, _q: &[T], b: &mut [T]) {
        ends.close(b);
    }

    /// Where a segment that begins at a time, and ends after another with the states `x`, leads,
    /// for problems of the shape [`Shape::Cycle`]: the states with which the next one begins are
    /// written into `after`; what is returned vanishes.
    fn segment_end_in(
        &self,
        _segment: usize,
        _times: (T, T),
        _x: &[T],
        _p: &[T],
        _after: &mut [T],
    ) -> T {
        T::zero()
    }

    /// How long all segments last together under forcing.
    fn cycle_in(&self, _p: &[T]) -> T {
        T::zero()
    }

    /// The integrands of the integral conditions, written into `g`.
    fn integrand_in(&self, _segment: usize, _t: T, _x: &[T], _q: &[T], _g: &mut [T]) {}
}

/// The scalars along segments in one number type.
pub trait Watches<T> {
    /// A scalar at time `t` from the beginning of its segment.
    fn watch_in(&self, watched: Watched, t: T, x: &[T], q: &[T]) -> T;
}

/// The functions of the states at the ends in one number type.
pub trait EndFunctions<T> {
    /// A function of the states at the ends and the numbers.
    fn of_ends_in(&self, function: usize, ends: Ends<T>, q: &[T]) -> T;
}

/// A scalar in which the residual of any problem can be evaluated.
pub trait Number: Scalar + Derivatives {
    /// The residual of a problem in this scalar.
    fn residual(problem: &dyn Equations) -> &dyn Residual<Self>;
}

/// A scalar in which watched scalars can be evaluated.
pub trait WatchNumber: Scalar {
    /// The watched scalars of a problem in this scalar.
    fn watches(problem: &dyn Equations) -> &dyn Watches<Self>;
}

erased! {
    /// The functions of a boundary-value problem in each scalar in which generic code needs them.
    pub trait InScalars;

    impl Number by Residual for [
        f64, Dual64, Jet<ROOM>, Narrow, Chunk, Dual<Chunk>, Dual2<Chunk>
    ] {
        fn residual(problem: &dyn Equations) -> &dyn Residual<Self> { problem }
    }
    impl WatchNumber by Watches for [f64, Dual64, Dual2_64, Chunk] {
        fn watches(problem: &dyn Equations) -> &dyn Watches<Self> { problem }
    }
}

/// A boundary-value problem in the scalars that discretisations need. Every
/// [`BoundaryProblem`](super::problem::BoundaryProblem) is one; its documentation says what the
/// methods that both traits have mean.
pub trait Equations:
    InScalars + EndFunctions<f64> + EndFunctions<Chunk> + Any + Send + Sync
{
    /// The names of the states of each segment.
    fn segments(&self) -> Vec<Vec<String>>;

    /// The names of the parameters.
    fn parameters(&self) -> Vec<String>;

    /// Whether solutions are periodic, and how a period leads to the next.
    fn shape(&self) -> Shape;

    /// The names of the further unknown numbers.
    fn extras(&self) -> Vec<String> {
        Vec::new()
    }

    /// The number of integral conditions.
    fn integrals(&self) -> usize {
        0
    }

    /// What is recorded along a branch, by name.
    fn monitors(&self) -> Vec<(String, Monitor)> {
        Vec::new()
    }

    /// The itineraries of solutions; `None` if all solutions follow the same one.
    fn itineraries(&self) -> Option<&dyn Itineraries<ErasedProblem>> {
        None
    }

    /// Determines properties that hold along a whole branch from the first solution, or guess of
    /// one, at which the equations are evaluated. False if they cannot be determined there.
    fn refer(&self, _ends: Ends<f64>, _q: &[f64]) -> bool {
        true
    }

    /// Typical sizes of the states of a segment, which tolerances are relative to; empty if all are
    /// 1.
    fn scales(&self, _segment: usize, _q: &[f64]) -> Vec<f64> {
        Vec::new()
    }

    /// The typical size of a function on a segment
    /// ([`BoundaryProblem::watch`](super::problem::BoundaryProblem::watch)), which tolerances are
    /// relative to.
    fn function_scale(&self, _segment: usize, _function: usize, _q: &[f64]) -> f64 {
        1.0
    }

    /// The typical sizes of the further unknowns, which tolerances are relative to; empty if all are
    /// 1.
    fn extra_scales(&self, _p: &[f64]) -> Vec<f64> {
        Vec::new()
    }

    /// The size of the motion near a state, in units of the scales, in relation to which a mesh is to
    /// resolve it; `None` where that is the largest size on the segment.
    fn size_near(&self, _segment: usize, _x: &[f64], _q: &[f64]) -> Option<f64> {
        None
    }

    /// The longest step in time, of a flow along a segment, in which nothing that is watched there
    /// changes much.
    fn longest_step(&self, _segment: usize) -> f64 {
        f64::INFINITY
    }
}

/// A boundary-value problem behind its object-safe face.
pub type ErasedProblem = Arc<dyn Equations>;

/// Statements that can be discretised: a [`BoundaryProblem`](super::problem::BoundaryProblem), or
/// equations that are behind their face already.
pub trait IntoEquations {
    /// The equations behind their object-safe face.
    fn into_equations(self) -> ErasedProblem;
}

impl IntoEquations for ErasedProblem {
    fn into_equations(self) -> ErasedProblem {
        self
    }
}

impl<P: IntoEquations> Guess<P> {
    /// The same with the problem behind its object-safe face.
    pub fn erased(self) -> Guess<ErasedProblem> {
        let Guess { problem, trajectories, extras, beside } = self;
        Guess { problem: problem.into_equations(), trajectories, extras, beside }
    }
}

/// A scalar of a problem on one segment, as flows watch it.
pub(in crate::core) struct Watching<'a> {
    pub problem: &'a dyn Equations,
    pub watched: Watched,
    /// Its typical size.
    pub scale: f64,
}

impl<T: WatchNumber> WatchIn<T> for Watching<'_> {
    fn value_in(&self, t: T, x: &[T], q: &[T]) -> T {
        T::watches(self.problem).watch_in(self.watched, t, x, q)
    }
}

impl Watchable<f64> for Watching<'_> {
    fn size(&self) -> f64 {
        self.scale
    }

    fn state_index(&self) -> Option<usize> {
        self.watched.observable.state()
    }
}
