//! Scratch space for evaluations of a zero problem.

use crate::core::problem::{Names, ZeroEquations, ZeroNumber};

/// The arguments and the residual in one scalar type, kept to avoid repeated allocation.
pub(super) struct Work<T> {
    x: Vec<T>,
    r: Vec<T>,
}

impl<T: ZeroNumber> Work<T> {
    pub fn new(names: &Names) -> Self {
        Work { x: vec![T::zero(); names.length()], r: vec![T::zero(); names.dimension()] }
    }

    /// Sets the unknowns and parameters component by component, and returns them with space for the
    /// residual.
    pub fn arguments(&mut self, argument: impl Fn(usize) -> T) -> (&[T], &[T], &mut [T]) {
        self.x.iter_mut().enumerate().for_each(|(i, x)| *x = argument(i));
        let (z, p) = self.x.split_at(self.r.len());
        (z, p, &mut self.r)
    }

    /// Evaluates the residual at arguments that are given component by component.
    pub fn evaluate(&mut self, problem: &dyn ZeroEquations, argument: impl Fn(usize) -> T) -> &[T] {
        let (z, p, r) = self.arguments(argument);
        problem.residual(z, p, r);
        r
    }
}
