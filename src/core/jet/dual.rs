//! Jets as numbers of `num_dual`, which is what equations are written against.

use super::number::Jet;
use super::space::MOST_ORDER;
use super::taylor;
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

/// Functions of a jet by their Taylor series at its constant term `a`.
macro_rules! by_series {
    ($a:ident: $($function:ident = $series:expr;)*) => {$(
        fn $function(&self) -> Self {
            let $a = self.c[0];
            self.composed(&$series)
        }
    )*};
}

impl<const C: usize> DualNum for Jet<C> {
    type Primitive = f64;
    type InnerDual = f64;
    const NDERIV: usize = MOST_ORDER;

    by_series! { a:
        recip = taylor::power(a.recip(), a, -1.0);
        sqrt = taylor::power(a.sqrt(), a, 0.5);
        cbrt = taylor::power(a.cbrt(), a, 1.0 / 3.0);
        exp = taylor::exp(a);
        exp_m1 = taylor::of_value(a.exp_m1(), taylor::exp(a));
        ln = taylor::ln(a.ln(), a);
        ln_1p = taylor::ln(a.ln_1p(), 1.0 + a);
        sin = taylor::sin_cos(a)[0];
        cos = taylor::sin_cos(a)[1];
        tan = taylor::tangent(a.tan(), 1.0);
        asin = taylor::inverse(a.asin(), a, 1.0, [1.0, -1.0, -0.5]);
        acos = taylor::inverse(a.acos(), a, -1.0, [1.0, -1.0, -0.5]);
        atan = taylor::inverse(a.atan(), a, 1.0, [1.0, 1.0, -1.0]);
        sinh = taylor::sinh_cosh(a)[0];
        cosh = taylor::sinh_cosh(a)[1];
        tanh = taylor::tangent(a.tanh(), -1.0);
        asinh = taylor::inverse(a.asinh(), a, 1.0, [1.0, 1.0, -0.5]);
        acosh = taylor::inverse(a.acosh(), a, 1.0, [-1.0, 1.0, -0.5]);
        atanh = taylor::inverse(a.atanh(), a, 1.0, [1.0, -1.0, -1.0]);
    }

    fn from_re(re: f64) -> Self {
        Jet::constant(re)
    }

    fn scale(self, factor: &f64) -> Self {
        self.scaled(*factor)
    }

    /// By repeated squares, so that nothing is divided by.
    fn powi(&self, n: i32) -> Self {
        let (mut rest, mut square, mut power) = (n.unsigned_abs(), *self, Jet::constant(1.0));
        while rest > 0 {
            if rest % 2 == 1 {
                power *= &square;
            }
            rest /= 2;
            if rest > 0 {
                square *= square;
            }
        }
        if n < 0 { power.recip() } else { power }
    }

    fn powf(&self, n: f64) -> Self {
        let a = self.c[0];
        self.composed(&taylor::power(a.powf(n), a, n))
    }

    fn exp2(&self) -> Self {
        (*self * LN_2).exp()
    }

    fn log(&self, base: f64) -> Self {
        self.ln() / base.ln()
    }

    fn log2(&self) -> Self {
        self.ln() / LN_2
    }

    fn log10(&self) -> Self {
        self.ln() / LN_10
    }

    fn sin_cos(&self) -> (Self, Self) {
        let [sin, cos] = taylor::sin_cos(self.c[0]);
        (self.composed(&sin), self.composed(&cos))
    }

    /// By the quotient that is at most 1 in size.
    fn atan2(&self, other: Self) -> Self {
        let mut angle = match self.c[0].abs() <= other.c[0].abs() {
            true => (*self / other).atan(),
            false => -(other / *self).atan(),
        };
        angle.c[0] = self.c[0].atan2(other.c[0]);
        angle
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
    /// The spherical Bessel function `j_n`, `n ≤ 2`: by its power series near 0 (DLMF 10.53.1), in closed
    /// form elsewhere (DLMF 10.49.3).
    fn spherical_bessel(&self, n: i32) -> Self {
        let x = *self;
        if x.c[0].abs() < 1.0 {
            let half = x * x * -0.5;
            let mut sum = Jet::constant(0.0);
            for k in (0..12).rev() {
                // 1 / (2n + 2k + 1)!! and 1 / k!, one factor at a time.
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
