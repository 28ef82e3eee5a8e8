//! The `num_dual` traits for jets, so that equations can be evaluated with jets.

use super::number::Jet;
use super::powers::{by_quotient, by_squares};
use super::space::MOST_ORDER;
use super::{series, taylor};
use crate::core::scalar::number::{number_of_reals, signed_by_reals};
use num_dual::DualNum;
use std::fmt::{Display, Formatter};

number_of_reals!([const C: usize] Jet<C>, real: |x: &Jet<C>| x.c[0], constant: Jet::constant);
signed_by_reals!([const C: usize] Jet<C>);

/// Writes the constant term, followed by the number of the other coefficients.
impl<const C: usize> Display for Jet<C> {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        self.c[0].fmt(f)?;
        match self.coefficients().len() {
            1 => Ok(()),
            count => write!(f, " + {} terms", count - 1),
        }
    }
}

/// Implements functions of a jet by their Taylor series at its constant term.
macro_rules! by_series {
    ($($function:ident)*) => {$(
        fn $function(&self) -> Self {
            self.composed(&series::$function(self.c[0]))
        }
    )*};
}

impl<const C: usize> DualNum for Jet<C> {
    type Primitive = f64;
    type InnerDual = f64;
    const NDERIV: usize = MOST_ORDER;

    by_series! {
        recip sqrt cbrt exp exp2 exp_m1 ln log2 log10 ln_1p sin cos tan asin acos atan sinh cosh tanh asinh acosh atanh
    }

    fn from_re(re: f64) -> Self {
        Jet::constant(re)
    }

    fn scale(self, factor: &f64) -> Self {
        self.scaled(*factor)
    }

    fn powi(&self, n: i32) -> Self {
        by_squares(self, n, DualNum::recip)
    }

    fn powf(&self, n: f64) -> Self {
        self.composed(&taylor::real_power(self.c[0], n))
    }

    fn log(&self, base: f64) -> Self {
        self.ln() / base.ln()
    }

    fn sin_cos(&self) -> (Self, Self) {
        let [sin, cos] = taylor::sin_cos(self.c[0]);
        (self.composed(&sin), self.composed(&cos))
    }

    fn atan2(&self, other: Self) -> Self {
        by_quotient(self, &other, [DualNum::recip, DualNum::atan])
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

impl<const C: usize> Jet<C> {
    /// Computes the spherical Bessel function `j_n`, `n ≤ 2`, by its power series near 0 (DLMF
    /// 10.53.1) and by its closed form otherwise (DLMF 10.49.3).
    fn spherical_bessel(&self, n: i32) -> Self {
        let x = *self;
        if x.c[0].abs() < 1.0 {
            let half = x * x * -0.5;
            let mut sum = Jet::constant(0.0);
            for k in (0..12).rev() {
                // The factors of 1 / (2n + 2k + 1)!! and 1 / k! are applied one by one.
                sum = sum * half / (f64::from(k + 1) * f64::from(2 * n + 2 * k + 3)) + 1.0;
            }
            let first: f64 = (0..=n).map(|k| f64::from(2 * k + 1)).product();
            return sum * x.powi(n) / first;
        }
        let (sin, cos) = x.sin_cos();
        match n {
            0 => sin / x,
            1 => (sin / x - cos) / x,
            _ => ((sin * 3.0 / x - cos * 3.0) / x - sin) / x,
        }
    }
}
