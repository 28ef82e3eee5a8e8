//! Jets as numbers of `num_dual`, which is what equations are written against.

use super::number::Jet;
use super::space::MOST_ORDER;
use crate::core::number::number_of_reals;
use num_dual::DualNum;
use num_traits::Signed;
use std::f64::consts::{LN_2, LN_10};
use std::fmt::{Display, Formatter};

number_of_reals!([const C: usize] Jet<C>, real: |x: &Jet<C>| x.c[0], constant: Jet::constant);

/// The constant term and, after it, the number of others.
impl<const C: usize> Display for Jet<C> {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        self.c[0].fmt(f)?;
        match self.coefficients().len() {
            1 => Ok(()),
            count => write!(f, " + {} terms", count - 1),
        }
    }
}

impl<const C: usize> Signed for Jet<C> {
    fn abs(&self) -> Self {
        if self.c[0] < 0.0 { -*self } else { *self }
    }

    fn abs_sub(&self, other: &Self) -> Self {
        if self.c[0] > other.c[0] { *self - other } else { Jet::constant(0.0) }
    }

    fn signum(&self) -> Self {
        Jet::constant(Signed::signum(&self.c[0]))
    }

    fn is_positive(&self) -> bool {
        self.c[0] > 0.0
    }

    fn is_negative(&self) -> bool {
        self.c[0] < 0.0
    }
}

impl<const C: usize> DualNum for Jet<C> {
    type Primitive = f64;
    type InnerDual = f64;
    const NDERIV: usize = MOST_ORDER;

    fn from_re(re: f64) -> Self {
        Jet::constant(re)
    }

    fn scale(self, factor: &f64) -> Self {
        self.scaled(*factor)
    }

    fn recip(&self) -> Self {
        self.reciprocal()
    }

    fn powi(&self, n: i32) -> Self {
        self.power_integer(n)
    }

    fn powf(&self, n: f64) -> Self {
        self.power_real(n)
    }

    fn sqrt(&self) -> Self {
        self.square_root()
    }

    fn cbrt(&self) -> Self {
        self.cubic_root()
    }

    fn exp(&self) -> Self {
        self.exponential()
    }

    fn exp2(&self) -> Self {
        (*self * LN_2).exponential()
    }

    fn exp_m1(&self) -> Self {
        self.exponential_less_one()
    }

    fn ln(&self) -> Self {
        self.logarithm()
    }

    fn log(&self, base: f64) -> Self {
        self.logarithm() / base.ln()
    }

    fn log2(&self) -> Self {
        self.logarithm() / LN_2
    }

    fn log10(&self) -> Self {
        self.logarithm() / LN_10
    }

    fn ln_1p(&self) -> Self {
        self.logarithm_of_more()
    }

    fn sin(&self) -> Self {
        self.circular().0
    }

    fn cos(&self) -> Self {
        self.circular().1
    }

    fn tan(&self) -> Self {
        self.tangent(self.c[0].tan(), 1.0)
    }

    fn sin_cos(&self) -> (Self, Self) {
        self.circular()
    }

    fn asin(&self) -> Self {
        self.inverse(self.c[0].asin(), 1.0, [1.0, -1.0, -0.5])
    }

    fn acos(&self) -> Self {
        self.inverse(self.c[0].acos(), -1.0, [1.0, -1.0, -0.5])
    }

    fn atan(&self) -> Self {
        self.arctangent()
    }

    fn atan2(&self, other: Self) -> Self {
        self.angle(&other)
    }

    fn sinh(&self) -> Self {
        self.hyperbolic().0
    }

    fn cosh(&self) -> Self {
        self.hyperbolic().1
    }

    fn tanh(&self) -> Self {
        self.tangent(self.c[0].tanh(), -1.0)
    }

    fn asinh(&self) -> Self {
        self.inverse(self.c[0].asinh(), 1.0, [1.0, 1.0, -0.5])
    }

    fn acosh(&self) -> Self {
        self.inverse(self.c[0].acosh(), 1.0, [-1.0, 1.0, -0.5])
    }

    fn atanh(&self) -> Self {
        self.inverse(self.c[0].atanh(), 1.0, [1.0, -1.0, -1.0])
    }

    fn sph_j0(&self) -> Self {
        self.spherical_bessel(0)
    }

    fn sph_j1(&self) -> Self {
        self.spherical_bessel(1)
    }

    fn sph_j2(&self) -> Self {
        self.spherical_bessel(2)
    }
}
