//! One object-safe trait for all boundary-value problems.
//!
//! Users write a [`BoundaryProblem`](super::problem::BoundaryProblem) as generic code over the
//! scalar type. Discretisations evaluate a problem through [`Equations`], one scalar type at a
//! time, and are therefore compiled only once for all problems. The trait [`Number`] is implemented
//! for the scalar types in which residuals are evaluated, and [`WatchNumber`] for the scalar types
//! in which watched scalars are evaluated.

use super::derivatives::Derivatives;
use super::itineraries::{Guess, Itineraries};
use super::terms::{Ends, Monitor, Shape, Watched};
use crate::core::problem::{FieldRef, ROOM, WatchIn, Watchable, erased};
use crate::core::scalar::{Chunk, Jet, Narrow, Scalar};
use num_dual::{Dual, Dual2, Dual2_64, Dual64};
use std::any::Any;
use std::sync::Arc;

/// The residual of a boundary-value problem in one scalar type.
pub trait Residual<T: Scalar> {
    /// Returns the vector field of a segment for a vector `q` of parameters and extra unknowns,
    /// with time counted from the start of the segment; also returns the number of entries of `q`
    /// on which the field depends.
    fn on_segment<'a>(&'a self, segment: usize, q: &'a [T]) -> FieldRef<'a, T>;

    /// Returns the duration of a segment.
    fn duration_in(&self, segment: usize, q: &[T]) -> T;

    /// Computes the left-hand sides of the boundary conditions and writes them into `b`; by default
    /// these are the conditions of a closed orbit. (Segments of the shape [`Shape::Cycle`] use
    /// [`segment_end_in`](Self::segment_end_in) instead.)
    fn boundary_in(&self, ends: Ends<T>, _q: &[T], b: &mut [T]) {
        ends.close(b);
    }

    /// Maps the end of a segment, given by its start time, duration and states `x`, to the initial
    /// states `after` of the next segment, for problems of the shape [`Shape::Cycle`]. Returns the
    /// residual of the segment's end condition, which vanishes for a solution.
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

    /// Returns the total duration of all segments of a periodically forced problem.
    fn cycle_in(&self, _p: &[T]) -> T {
        T::zero()
    }

    /// Computes the integrands of the integral conditions and writes them into `g`.
    fn integrand_in(&self, _segment: usize, _t: T, _x: &[T], _q: &[T], _g: &mut [T]) {}
}

/// Evaluates the watched scalars along segments, for the number type `T`.
pub trait Watches<T> {
    /// Computes the value of a watched scalar at time `t`, counted from the start of the segment.
    fn watch_in(&self, watched: Watched, t: T, x: &[T], q: &[T]) -> T;
}

/// Functions of the states at the ends of segments, in one number type.
pub trait EndFunctions<T> {
    /// Computes one function of the states at the ends of segments and of the vector `q` of
    /// parameters and extra unknowns.
    fn of_ends_in(&self, function: usize, ends: Ends<T>, q: &[T]) -> T;
}

/// A scalar type in which the residual of every problem can be evaluated.
pub trait Number: Scalar + Derivatives {
    /// Returns the residual of a problem in this scalar type.
    fn residual(problem: &dyn Equations) -> &dyn Residual<Self>;
}

/// A scalar type in which watched scalars can be evaluated.
pub trait WatchNumber: Scalar {
    /// Returns the watched scalars of a problem in this scalar type.
    fn watches(problem: &dyn Equations) -> &dyn Watches<Self>;
}

erased! {
    /// The functions of a boundary-value problem in each scalar type that generic code needs.
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

/// A boundary-value problem that can be evaluated in all scalar types that discretisations need.
/// This trait is implemented by every [`BoundaryProblem`](super::problem::BoundaryProblem), which
/// documents the methods of both traits.
pub trait Equations:
    InScalars + EndFunctions<f64> + EndFunctions<Chunk> + Any + Send + Sync
{
    /// Returns the names of the states of each segment.
    fn segments(&self) -> Vec<Vec<String>>;

    /// Returns the names of the parameters.
    fn parameters(&self) -> Vec<String>;

    /// Returns the default values of all parameters, in order; empty if the parameters do not have
    /// default values.
    fn defaults(&self) -> Vec<f64> {
        Vec::new()
    }

    /// Returns the shape of solutions: whether they are periodic, and how one period leads to the
    /// next.
    fn shape(&self) -> Shape;

    /// Returns the names of the extra unknowns, such as the duration of a segment.
    fn extras(&self) -> Vec<String> {
        Vec::new()
    }

    /// Returns the number of integral conditions.
    fn integrals(&self) -> usize {
        0
    }

    /// Returns the monitors that are recorded along a branch, with their names.
    fn monitors(&self) -> Vec<(String, Monitor)> {
        Vec::new()
    }

    /// Returns the itineraries of solutions; `None` if all solutions follow the same itinerary.
    fn itineraries(&self) -> Option<&dyn Itineraries<ErasedProblem>> {
        None
    }

    /// Determines the properties that stay fixed along a whole branch, from the first solution (or
    /// guess of a solution) at which the equations are evaluated. Returns false if the properties of
    /// the branch cannot be determined from the first solution.
    fn refer(&self, _ends: Ends<f64>, _q: &[f64]) -> bool {
        true
    }

    /// Returns typical sizes of the states of a segment, used as units of tolerances; empty if all
    /// sizes are 1.
    fn scales(&self, _segment: usize, _q: &[f64]) -> Vec<f64> {
        Vec::new()
    }

    /// Returns the typical size of a watched function on a segment
    /// ([`BoundaryProblem::watch`](super::problem::BoundaryProblem::watch)), used as the unit of
    /// tolerances.
    fn function_scale(&self, _segment: usize, _function: usize, _q: &[f64]) -> f64 {
        1.0
    }

    /// Returns typical sizes of the extra unknowns, used as units of tolerances; empty if all sizes
    /// are 1.
    fn extra_scales(&self, _p: &[f64]) -> Vec<f64> {
        Vec::new()
    }

    /// Returns the size of the motion near a state, in units of the scales, used as the unit of the
    /// mesh error; `None` if the unit of the mesh error is the largest size on the segment.
    fn size_near(&self, _segment: usize, _x: &[f64], _q: &[f64]) -> Option<f64> {
        None
    }

    /// Returns the time that has elapsed at a mesh point of a segment; mesh points and times are in
    /// units of the segment's duration.
    fn passed(&self, _segment: usize, place: f64, _q: &[f64]) -> f64 {
        place
    }

    /// Returns the longest time step of a flow along a segment such that all watched functions
    /// change little within one step.
    fn longest_step(&self, _segment: usize) -> f64 {
        f64::INFINITY
    }
}

/// A boundary-value problem as a trait object.
pub type ErasedProblem = Arc<dyn Equations>;

/// A problem that can be discretised: either a [`BoundaryProblem`](super::problem::BoundaryProblem)
/// or an erased problem.
pub trait IntoEquations {
    /// Converts the problem to its erased form.
    fn into_equations(self) -> ErasedProblem;
}

impl IntoEquations for ErasedProblem {
    fn into_equations(self) -> ErasedProblem {
        self
    }
}

impl<P: IntoEquations> Guess<P> {
    /// Converts a guess for this problem into a guess for the erased problem.
    pub fn erased(self) -> Guess<ErasedProblem> {
        let Guess { problem, trajectories, extras, beside } = self;
        Guess { problem: problem.into_equations(), trajectories, extras, beside }
    }
}

/// A scalar of a boundary-value problem on one segment, evaluated as a watched function.
pub(in crate::core) struct Watching<'a> {
    pub problem: &'a dyn Equations,
    pub watched: Watched,
    /// Returns the typical size of the scalar.
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
