//! Jets and their arithmetic.

use super::space::{JetError, Space};
use crate::core::scalar::number::operations;
use num_dual::DualNum;
use std::ops::Neg;

/// A truncated Taylor series with a capacity of `C` coefficients; it is a
/// [`Scalar`](crate::core::scalar::Scalar) and is compared by its constant term.
///
/// A jet converted from a real number is a constant without variables; the result of an operation
/// with another jet has the variables of that jet. All jets of an expression must belong to one
/// [`Space`].
///
/// ```
/// use num_dual::DualNum;
/// use tangency::core::scalar::{Jet, Space};
/// // sin(xy)/x about (1, 2), to third order.
/// let space = Space::of(2, 3)?;
/// let x = Jet::<16>::variable(space, 0, 1.0)?;
/// let y = Jet::<16>::variable(space, 1, 2.0)?;
/// let f = (x * y).sin() / x;
/// // ∂f/∂y = cos(xy), ∂²f/∂x∂y = −y sin(xy), ∂³f/∂y³ = −x² cos(xy).
/// assert!((f.coefficient(&[0, 1]) - 2.0_f64.cos()).abs() < 1e-15);
/// assert!((f.coefficient(&[1, 1]) + 2.0 * 2.0_f64.sin()).abs() < 1e-15);
/// assert!((f.coefficient(&[0, 3]) + 2.0_f64.cos() / 6.0).abs() < 1e-15);
/// # Ok::<(), tangency::core::scalar::JetError>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Jet<const C: usize> {
    /// The coefficients; entries after the last coefficient of the space are zero.
    pub(super) c: [f64; C],
    /// The space of the jet's monomials; `None` for a constant.
    pub(super) space: Option<&'static Space>,
}

impl<const C: usize> Jet<C> {
    /// Creates a constant.
    pub const fn constant(value: f64) -> Self {
        let mut c = [0.0; C];
        c[0] = value;
        Jet { c, space: None }
    }

    /// Creates the variable `value + ε_k`.
    ///
    /// # Errors
    /// [`JetError`] if the space has more coefficients than the capacity, or if the variable `k`
    /// does not exist.
    pub fn variable(space: &'static Space, k: usize, value: f64) -> Result<Self, JetError> {
        let (variables, order, coefficients) = (space.variables(), space.order(), space.len());
        if coefficients > C {
            return Err(JetError::TooLarge { variables, order, coefficients, most: C });
        }
        if k >= variables {
            return Err(JetError::NoVariable { variables, variable: k });
        }
        let mut jet = Jet { space: Some(space), ..Jet::constant(value) };
        if order > 0 {
            jet.c[1 + k] = 1.0;
        }
        Ok(jet)
    }

    /// Returns the coefficients, in the order of the monomials of the space; a constant has a
    /// single coefficient.
    pub fn coefficients(&self) -> &[f64] {
        &self.c[..self.space.map_or(1, Space::len)]
    }

    /// Returns the coefficient of the monomial with these powers of the variables; 0 for monomials
    /// above the order of the jet.
    pub fn coefficient(&self, exponents: &[u8]) -> f64 {
        let Some(space) = self.space else {
            return if exponents.iter().all(|power| *power == 0) { self.c[0] } else { 0.0 };
        };
        space.position(exponents).map_or(0.0, |k| self.c[k])
    }

    /// Returns the largest absolute value of the coefficients.
    pub fn size(&self) -> f64 {
        self.coefficients().iter().fold(0.0, |most, c| c.abs().max(most))
    }

    /// Divides the jet by one of its variables. Terms without the variable are dropped; the
    /// quotient's terms of the highest degree are unknown and are set to zero.
    pub fn divided_by(&self, variable: usize) -> Self {
        let Some(space) = self.space else { return Jet::constant(0.0) };
        let mut quotient = Jet { space: self.space, ..Jet::constant(0.0) };
        for [i, j, k] in &space.products {
            if usize::from(*i) == 1 + variable {
                quotient.c[usize::from(*j)] = self.c[usize::from(*k)];
            }
        }
        quotient
    }

    /// Returns the common space of two jets; a constant belongs to every space.
    fn joined(&self, other: &Self) -> Option<&'static Space> {
        debug_assert!(
            self.space.is_none()
                || other.space.is_none()
                || self.space.map(Space::len) == other.space.map(Space::len),
            "jets of different spaces"
        );
        self.space.or(other.space)
    }

    /// Adds a multiple of another jet.
    fn add_multiple(&mut self, factor: f64, other: &Self) {
        self.space = self.joined(other);
        let count = other.coefficients().len();
        self.c[..count].iter_mut().zip(&other.c[..count]).for_each(|(a, b)| *a += factor * b);
    }

    pub(super) fn scaled(mut self, factor: f64) -> Self {
        let count = self.coefficients().len();
        self.c[..count].iter_mut().for_each(|c| *c *= factor);
        self
    }

    /// `self · other`.
    fn product(&self, other: &Self) -> Self {
        let space = match (self.space, other.space) {
            (None, _) => return other.scaled(self.c[0]),
            (_, None) => return self.scaled(other.c[0]),
            (Some(space), Some(_)) => space,
        };
        let mut product = Jet { space: self.joined(other), ..Jet::constant(0.0) };
        for [i, j, k] in &space.products {
            product.c[usize::from(*k)] += self.c[usize::from(*i)] * other.c[usize::from(*j)];
        }
        product
    }

    /// `self / other`.
    fn quotient(&self, other: &Self) -> Self {
        match other.space {
            None => self.scaled(other.c[0].recip()),
            Some(_) => self.product(&other.recip()),
        }
    }

    /// Computes `Σ_k f_k hᵏ` by Horner's rule, where `h` is the jet without its constant term.
    pub(super) fn composed(&self, f: &[f64]) -> Self {
        let Some(space) = self.space else { return Jet::constant(f[0]) };
        let (mut h, order) = (*self, space.order());
        h.c[0] = 0.0;
        let mut sum = Jet { space: self.space, ..Jet::constant(f[order]) };
        for f in f[..order].iter().rev() {
            sum = sum.product(&h);
            sum.c[0] += f;
        }
        sum
    }
}

/// Creates the jet with the given coefficients.
///
/// # Errors
/// [`JetError`] if the space has more coefficients than the capacity.
pub(crate) fn jet_of<const C: usize>(
    space: &'static Space,
    coefficient: impl Fn(usize) -> f64,
) -> Result<Jet<C>, JetError> {
    let (variables, order, coefficients) = (space.variables(), space.order(), space.len());
    if coefficients > C {
        return Err(JetError::TooLarge { variables, order, coefficients, most: C });
    }
    let mut jet = Jet { space: Some(space), ..Jet::constant(0.0) };
    jet.c[..coefficients].iter_mut().enumerate().for_each(|(k, c)| *c = coefficient(k));
    Ok(jet)
}

impl<const C: usize> Neg for Jet<C> {
    type Output = Self;
    fn neg(self) -> Self {
        self.scaled(-1.0)
    }
}

// The remainder of a division uses the quotient truncated by its real part.
operations! { [const C: usize] Jet<C>, |a, b|
    += a.add_multiple(1.0, b), a.c[0] += b;
    -= a.add_multiple(-1.0, b), a.c[0] -= b;
    *= *a = a.product(b), *a = a.scaled(b);
    /= *a = a.quotient(b), *a = a.scaled(b.recip());
    %= a.add_multiple(-(a.c[0] / b.c[0]).trunc(), b), a.c[0] %= b;
}
