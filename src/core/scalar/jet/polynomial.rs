//! Taylor polynomials and their evaluation.

use super::number::Jet;
use super::space::Space;
use crate::core::scalar::Scalar;

/// A polynomial in the variables of a [`Space`].
///
/// ```
/// use num_dual::DualNum;
/// use tangency::core::scalar::{Jet, Monomials, Polynomial, Space};
/// // The Taylor polynomial of order 3 of eˣ cos y at 0 is 1 + x + x²/2 − y²/2 + x³/6 − xy²/2.
/// let space = Space::of(2, 3)?;
/// let (x, y) = (Jet::<16>::variable(space, 0, 0.0)?, Jet::<16>::variable(space, 1, 0.0)?);
/// let polynomial = Polynomial::of(space, &(x.exp() * y.cos()));
/// assert!((polynomial.coefficient(&[1, 2]) + 0.5).abs() < 1e-15);
/// let monomials = Monomials::at(space, &[0.1, 0.2]);
/// let exact = 0.1_f64.exp() * 0.2_f64.cos();
/// assert!((polynomial.sum_to(3, &monomials) - exact).abs() < 5e-5);
/// // Without the highest order.
/// assert!((polynomial.sum_to(2, &monomials) - (1.1 + 0.005 - 0.02)).abs() < 1e-15);
/// # Ok::<(), tangency::core::scalar::JetError>(())
/// ```
#[derive(Clone, Debug)]
pub struct Polynomial {
    space: &'static Space,
    coefficients: Vec<f64>,
}

impl Polynomial {
    /// Converts a jet to a polynomial in a space with the same variables, and drops the terms above
    /// the order of the space.
    pub fn of<const C: usize>(space: &'static Space, jet: &Jet<C>) -> Self {
        let mut coefficients = jet.coefficients().to_vec();
        coefficients.resize(space.len(), 0.0);
        Polynomial { space, coefficients }
    }

    /// Converts a polynomial in the normalised variables `x/size` to the variables `x`.
    pub fn in_sizes(mut self, sizes: &[f64]) -> Self {
        for (k, coefficient) in self.coefficients.iter_mut().enumerate() {
            let powers = self.space.exponents(k).iter().zip(sizes);
            *coefficient /= powers.map(|(e, size)| size.powi(i32::from(*e))).product::<f64>();
        }
        self
    }

    /// Replaces each coefficient by a function of its exponents and its present value.
    pub(crate) fn with(mut self, coefficient: impl Fn(&[u8], f64) -> f64) -> Self {
        for (k, c) in self.coefficients.iter_mut().enumerate() {
            *c = coefficient(self.space.exponents(k), *c);
        }
        self
    }

    /// The space.
    pub fn space(&self) -> &'static Space {
        self.space
    }

    /// Returns all coefficients, in the order of the monomials.
    pub fn coefficients(&self) -> &[f64] {
        &self.coefficients
    }

    /// Returns the coefficient of the monomial with these powers of the variables; 0 for monomials
    /// above the order of the polynomial.
    pub fn coefficient(&self, exponents: &[u8]) -> f64 {
        self.space.position(exponents).map_or(0.0, |k| self.coefficients[k])
    }

    /// Returns the sum of the terms up to a given order, given the values of the monomials.
    pub fn sum_to<T: Scalar>(&self, order: usize, monomials: &Monomials<T>) -> T {
        let end = self.space.of_degree(order.min(self.space.order())).end;
        let terms = self.coefficients[..end].iter().zip(&monomials.values);
        terms.fold(T::zero(), |sum, (c, value)| sum + *value * *c)
    }
}

/// The values of all monomials of a space at one point, which are used by all polynomials that are
/// evaluated at this point.
#[derive(Clone, Debug)]
pub struct Monomials<T> {
    values: Vec<T>,
}

impl<T> Default for Monomials<T> {
    fn default() -> Self {
        Monomials { values: Vec::new() }
    }
}

impl<T: Scalar> Monomials<T> {
    /// Computes the values of all monomials at a point.
    pub fn at(space: &Space, x: &[T]) -> Self {
        let mut monomials = Monomials::default();
        monomials.update(space, x);
        monomials
    }

    /// Recomputes the values of all monomials at another point; the number of components of the
    /// point is the number of variables of the space.
    pub fn update(&mut self, space: &Space, x: &[T]) {
        self.values.clear();
        self.values.push(T::one());
        for (rest, variable) in &space.factors {
            let value = self.values[usize::from(*rest)] * x[usize::from(*variable)];
            self.values.push(value);
        }
    }
}
