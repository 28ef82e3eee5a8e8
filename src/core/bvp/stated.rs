//! Implementations of the object-safe trait [`Equations`](super::erased::Equations) for
//! user-defined boundary-value problems.

use super::erased::{EndFunctions, Equations, ErasedProblem, IntoEquations, Residual, Watches};
use super::itineraries::Itineraries;
use super::problem::BoundaryProblem;
use super::terms::{Ends, Monitor, Shape, Watched};
use crate::core::failure::OutOfDomain;
use crate::core::problem::{Domains, FieldRef, Fields, Observable, Wide, change_by, forward};
use crate::core::scalar::Scalar;
use std::sync::Arc;

impl<P: BoundaryProblem + 'static> IntoEquations for P {
    fn into_equations(self) -> ErasedProblem {
        Arc::new(Stated(self))
    }
}

/// A user-defined problem.
struct Stated<P>(P);

impl<P: BoundaryProblem> Domains for Stated<P> {
    fn domain_of(&self, index: usize, x: &[f64], q: &[f64]) -> Result<(), OutOfDomain> {
        self.0.domain(index, x, q)
    }

    fn scales_of(&self, index: usize, q: &[f64]) -> Vec<f64> {
        self.0.scales(index, q)
    }

    fn states_of(&self, index: usize) -> Vec<String> {
        self.0.segments().swap_remove(index)
    }
}

impl<P: BoundaryProblem, T: Scalar> Fields<T> for Stated<P> {
    #[inline]
    fn field_of(&self, index: usize, t: T, x: &[T], q: &[T], f: &mut [T]) {
        self.0.field(index, t, x, q, f);
    }
}

impl<P: BoundaryProblem, T: Scalar> Residual<T> for Stated<P> {
    fn on_segment<'a>(&'a self, segment: usize, q: &'a [T]) -> FieldRef<'a, T> {
        let (fields, wide, start) = (self, Some(self as &dyn Fields<Wide<T>>), T::zero());
        FieldRef {
            fields,
            wide,
            real: self,
            index: segment,
            start,
            numbers: q.len(),
            attraction: None,
            pace: None,
        }
    }

    fn duration_in(&self, segment: usize, q: &[T]) -> T {
        self.0.duration(segment, q)
    }

    fn boundary_in(&self, ends: Ends<T>, q: &[T], b: &mut [T]) {
        self.0.boundary(ends, q, b);
    }

    fn integrand_in(&self, segment: usize, t: T, x: &[T], q: &[T], g: &mut [T]) {
        self.0.integrand(segment, t, x, q, g);
    }
}

impl<P: BoundaryProblem, T: Scalar> Watches<T> for Stated<P> {
    fn watch_in(&self, Watched { segment, observable, .. }: Watched, t: T, x: &[T], q: &[T]) -> T {
        match observable {
            Observable::State(i) => x[i],
            Observable::Function(k) => self.0.watch(k, segment, t, x, q),
        }
    }
}

impl<P: BoundaryProblem, T: Scalar> EndFunctions<T> for Stated<P> {
    fn of_ends_in(&self, function: usize, ends: Ends<T>, q: &[T]) -> T {
        self.0.of_ends(function, ends, q)
    }
}

impl<P: BoundaryProblem + 'static> Equations for Stated<P> {
    forward! { |self| self.0;
        fn segments() -> Vec<Vec<String>>;
        fn parameters() -> Vec<String>;
        fn defaults() -> Vec<f64>;
        fn shape() -> Shape;
        fn extras() -> Vec<String>;
        fn integrals() -> usize;
        fn monitors() -> Vec<(String, Monitor)>;
        fn itineraries() -> Option<&dyn Itineraries<ErasedProblem>>;
        fn scales(segment: usize, q: &[f64]) -> Vec<f64>;
    }

    /// Computes the change of a function when time changes by the segment's duration and the states
    /// change by their scales, starting from states at half their scales; 1 if the problem defines
    /// no scales.
    fn function_scale(&self, segment: usize, function: usize, q: &[f64]) -> f64 {
        let sizes = self.0.scales(segment, q);
        if sizes.is_empty() {
            return 1.0;
        }
        let half: Vec<f64> = sizes.iter().map(|size| 0.5 * size).collect();
        let value = |t, x: &[_], q: &[_]| self.0.watch(function, segment, t, x, q);
        change_by((self.0.duration(segment, q), &sizes), (0.0, &half), q, value)
    }
}
