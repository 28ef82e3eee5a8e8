//! Scratch space for evaluations of a zero problem.

use crate::core::problem::{Names, ZeroEquations, ZeroNumber};

/// The arguments and the residual in one scalar type, kept to avoid repeated allocation.
pub(super) struct Work<T> {
    x: Vec<T>,
    r: Vec<T>,
    rates: Vec<T>,
}

impl<T: ZeroNumber> Work<T> {
    pub fn new(names: &Names) -> Self {
        let (x, r) = (vec![T::zero(); names.length()], vec![T::zero(); names.dimension()]);
        Work { x, r, rates: Vec::new() }
    }

    /// Sets the unknowns and parameters component by component, and returns them with space for the
    /// residual.
    pub fn arguments(&mut self, argument: impl Fn(usize) -> T) -> (&[T], &[T], &mut [T]) {
        self.x.iter_mut().enumerate().for_each(|(i, x)| *x = argument(i));
        let (z, p) = self.x.split_at(self.r.len());
        (z, p, &mut self.r)
    }

    /// Returns the residual that was evaluated last, or the products that were computed last.
    pub fn results(&self) -> &[T] {
        &self.r
    }

    /// Evaluates the residual at arguments that are given component by component.
    pub fn evaluate(&mut self, problem: &dyn ZeroEquations, argument: impl Fn(usize) -> T) -> &[T] {
        let (z, p, r) = self.arguments(argument);
        problem.residual(z, p, r);
        r
    }

    /// Computes the products of the mass matrix with rates, at arguments that are given component
    /// by component.
    pub fn products(
        &mut self,
        problem: &dyn ZeroEquations,
        argument: impl Fn(usize) -> T,
        rate: impl Fn(usize) -> T,
    ) -> &[T] {
        let n = self.r.len();
        self.rates.clear();
        self.rates.extend((0..n).map(rate));
        self.x.iter_mut().enumerate().for_each(|(i, x)| *x = argument(i));
        let (z, p) = self.x.split_at(n);
        problem.mass_product(z, p, &self.rates, &mut self.r);
        &self.r
    }

    /// Evaluates `F`, or `F − M z'` for motions; the rates `z'` then follow the unknowns and
    /// parameters among the arguments.
    pub fn left(
        &mut self,
        problem: &dyn ZeroEquations,
        moves: bool,
        argument: impl Fn(usize) -> T,
    ) -> &[T] {
        if !moves {
            return self.evaluate(problem, argument);
        }
        let length = self.x.len();
        let products = self.products(problem, &argument, |i| argument(length + i)).to_vec();
        self.evaluate(problem, argument);
        self.r.iter_mut().zip(products).for_each(|(r, product)| *r -= product);
        &self.r
    }
}
