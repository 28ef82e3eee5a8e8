//! The local map as a discrete map.

use super::map::LocalMap;
use crate::core::problem::{DiscreteMap, Names};
use crate::core::scalar::Scalar;

/// The states and the parameters of the discrete map are deviations from the grazing orbit. The
/// derivative of the map at a point is the one-sided derivative on the side of the grazing (with or
/// without the event) on which the point lies.
impl DiscreteMap for LocalMap {
    fn names(&self) -> Names {
        Names::new(self.coordinates().iter().map(String::as_str), self.parameters().to_vec())
    }

    fn defaults(&self) -> Vec<f64> {
        vec![0.0; self.parameters().len()]
    }

    fn scales(&self, _p: &[f64]) -> Vec<f64> {
        self.scales.clone()
    }

    fn next<T: Scalar>(&self, x: &[T], p: &[T], next: &mut [T]) {
        next.copy_from_slice(x);
        self.iteration::<T>().apply(next, p);
    }
}
