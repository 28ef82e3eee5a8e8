//! The zero vector field, for legs on which the states are constant.

use crate::core::failure::OutOfDomain;
use crate::core::problem::{Domains, Fields};
use crate::core::scalar::Scalar;

/// The vector field that is zero everywhere.
pub(super) struct Still;

impl Domains for Still {
    fn domain_of(&self, _index: usize, _x: &[f64], _p: &[f64]) -> Result<(), OutOfDomain> {
        Ok(())
    }

    fn scales_of(&self, _index: usize, _p: &[f64]) -> Vec<f64> {
        Vec::new()
    }

    fn states_of(&self, _index: usize) -> Vec<String> {
        Vec::new()
    }
}

impl<T: Scalar> Fields<T> for Still {
    fn field_of(&self, _index: usize, _t: T, _x: &[T], _p: &[T], f: &mut [T]) {
        f.fill(T::zero());
    }
}
