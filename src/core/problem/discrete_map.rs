//! Discrete maps as users define them.

use super::forward::forward;
use super::names::Names;
use crate::core::scalar::Scalar;
use std::ops::Deref;

/// A discrete map `x ↦ f(x, p)` with named states and parameters.
pub trait DiscreteMap: Send + Sync {
    /// Returns the names of the states, parameters and monitors.
    fn names(&self) -> Names;

    /// Returns the default values of all parameters, in order; an empty list if the map has no
    /// default values.
    fn defaults(&self) -> Vec<f64> {
        Vec::new()
    }

    /// Returns the typical sizes of the states, in their order; the sizes must be given if states
    /// can be zero and their sizes are far from 1. By default all sizes are 1.
    fn scales(&self, _p: &[f64]) -> Vec<f64> {
        Vec::new()
    }

    /// Computes the image of the state `x` and writes it into `next`, which has the same length as
    /// `x`.
    fn next<T: Scalar>(&self, x: &[T], p: &[T], next: &mut [T]);

    /// Computes a monitor at a state; the monitor is given by its index in the list of names.
    fn monitor<T: Scalar>(&self, _monitor: usize, _x: &[T], _p: &[T]) -> T {
        T::from(f64::NAN)
    }
}

/// Every shared or borrowed discrete map also implements [`DiscreteMap`].
impl<M: Deref<Target: DiscreteMap> + Send + Sync> DiscreteMap for M {
    forward! { |self| (**self);
        fn names() -> Names;
        fn defaults() -> Vec<f64>;
        fn next<T>(x: &[T], p: &[T], next: &mut [T]) -> ();
        fn monitor<T>(monitor: usize, x: &[T], p: &[T]) -> T;
        fn scales(p: &[f64]) -> Vec<f64>;
    }
}
