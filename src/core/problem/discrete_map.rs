//! Discrete maps as users define them.

use super::forward::forward;
use super::names::Names;
use crate::core::scalar::Scalar;
use std::ops::Deref;

/// A map `x ↦ f(x, p)` with named states and parameters.
pub trait DiscreteMap: Send + Sync {
    /// The names of states, parameters and monitors.
    fn names(&self) -> Names;

    /// The default values of all parameters, in order; empty without default values.
    fn defaults(&self) -> Vec<f64> {
        Vec::new()
    }

    /// Typical sizes of the states, in their order; needed if states can be zero and their sizes are
    /// far from 1. By default all sizes are 1.
    fn scales(&self, _p: &[f64]) -> Vec<f64> {
        Vec::new()
    }

    /// Computes the next state and writes it into `next` (of the same length as `x`).
    fn next<T: Scalar>(&self, x: &[T], p: &[T], next: &mut [T]);

    /// Computes a monitor of a state, by its position among the names of monitors.
    fn monitor<T: Scalar>(&self, _monitor: usize, _x: &[T], _p: &[T]) -> T {
        T::from(f64::NAN)
    }
}

/// Every shared or borrowed map is a map.
impl<M: Deref<Target: DiscreteMap> + Send + Sync> DiscreteMap for M {
    forward! { |self| (**self);
        fn names() -> Names;
        fn defaults() -> Vec<f64>;
        fn next<T>(x: &[T], p: &[T], next: &mut [T]) -> ();
        fn monitor<T>(monitor: usize, x: &[T], p: &[T]) -> T;
        fn scales(p: &[f64]) -> Vec<f64>;
    }
}
