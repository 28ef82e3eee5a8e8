//! One mode as a vector field, and one guard as a watched function.

use super::system::HybridSystem;
use crate::core::field::VectorField;
use crate::core::scalar::Scalar;
use crate::core::watch::Watch;
use crate::core::zero::{LeftDomain, Names};

/// The vector field of one mode.
pub struct InMode<'a, S> {
    /// The hybrid system.
    pub system: &'a S,
    /// The mode.
    pub mode: usize,
}

impl<S: HybridSystem> VectorField for InMode<'_, S> {
    fn names(&self) -> Names {
        let mode = self.system.modes().swap_remove(self.mode);
        Names::new(mode.states.iter().map(String::as_str), self.system.parameters())
    }

    fn field<T: Scalar>(&self, t: T, x: &[T], p: &[T], f: &mut [T]) {
        self.system.field(self.mode, t, x, p, f);
    }

    fn period<T: Scalar>(&self, p: &[T]) -> Option<T> {
        self.system.period(p)
    }

    fn domain(&self, x: &[f64], p: &[f64]) -> Result<(), LeftDomain> {
        self.system.domain(self.mode, x, p)
    }
}

/// One guard as a function to be watched along the flow of its mode.
pub struct GuardOf<'a, S> {
    /// The hybrid system.
    pub system: &'a S,
    /// The guard.
    pub guard: usize,
}

impl<S: HybridSystem> Watch for GuardOf<'_, S> {
    fn value<T: Scalar>(&self, t: T, x: &[T], p: &[T]) -> T {
        self.system.guard(self.guard, t, x, p)
    }
}
