//! Numbers side by side as numbers of `num_dual`, which is what equations are written against.

use super::Lanes;
use num_dual::{DualNum, DualStruct, Mappable};
use num_traits::{FromPrimitive, Inv, Num, One, Signed, Zero};
use std::cmp::Ordering;
use std::iter::{Product, Sum};

impl PartialEq for Lanes {
    fn eq(&self, other: &Self) -> bool {
        self.first() == other.first()
    }
}

impl PartialOrd for Lanes {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        self.first().partial_cmp(&other.first())
    }
}

impl PartialEq<f64> for Lanes {
    fn eq(&self, other: &f64) -> bool {
        self.first() == *other
    }
}

impl PartialOrd<f64> for Lanes {
    fn partial_cmp(&self, other: &f64) -> Option<Ordering> {
        self.first().partial_cmp(other)
    }
}

impl From<f64> for Lanes {
    #[inline(always)]
    fn from(value: f64) -> Self {
        Lanes::splat(value)
    }
}

impl Zero for Lanes {
    #[inline(always)]
    fn zero() -> Self {
        Lanes::splat(0.0)
    }

    fn is_zero(&self) -> bool {
        self.first() == 0.0
    }
}

impl One for Lanes {
    #[inline(always)]
    fn one() -> Self {
        Lanes::splat(1.0)
    }
}

impl Num for Lanes {
    type FromStrRadixErr = <f64 as Num>::FromStrRadixErr;

    fn from_str_radix(text: &str, radix: u32) -> Result<Self, Self::FromStrRadixErr> {
        f64::from_str_radix(text, radix).map(Lanes::splat)
    }
}

impl Signed for Lanes {
    fn abs(&self) -> Self {
        self.size()
    }

    fn abs_sub(&self, other: &Self) -> Self {
        (*self - other).most(Lanes::zero())
    }

    fn signum(&self) -> Self {
        self.map(f64::signum)
    }

    fn is_positive(&self) -> bool {
        self.first() > 0.0
    }

    fn is_negative(&self) -> bool {
        self.first() < 0.0
    }
}

impl Inv for Lanes {
    type Output = Self;
    fn inv(self) -> Self {
        self.recip()
    }
}

impl Sum for Lanes {
    fn sum<I: Iterator<Item = Self>>(terms: I) -> Self {
        terms.fold(Lanes::zero(), |sum, term| sum + term)
    }
}

impl Product for Lanes {
    fn product<I: Iterator<Item = Self>>(factors: I) -> Self {
        factors.fold(Lanes::one(), |product, factor| product * factor)
    }
}

impl FromPrimitive for Lanes {
    fn from_i64(n: i64) -> Option<Self> {
        f64::from_i64(n).map(Lanes::splat)
    }

    fn from_u64(n: u64) -> Option<Self> {
        f64::from_u64(n).map(Lanes::splat)
    }

    fn from_f64(n: f64) -> Option<Self> {
        Some(Lanes::splat(n))
    }
}

impl DualStruct for Lanes {
    type Real = f64;
    type Inner = f64;

    fn re(&self) -> f64 {
        self.first()
    }

    fn from_inner(inner: &f64) -> Self {
        Lanes::splat(*inner)
    }
}

impl Mappable<Self> for Lanes {
    type Output<O> = O;

    fn map_dual<M: Fn(Self) -> O, O>(self, f: M) -> O {
        f(self)
    }
}

/// Functions that are those of real numbers in each lane.
macro_rules! by_lane {
    ($($function:ident $(($argument:ident: $kind:ty))?),* $(,)?) => {$(
        fn $function(&self $(, $argument: $kind)?) -> Self {
            self.map(|x| DualNum::$function(&x $(, $argument)?))
        }
    )*};
}

impl DualNum for Lanes {
    type Primitive = f64;
    type InnerDual = f64;
    const NDERIV: usize = 0;

    fn from_re(re: f64) -> Self {
        Lanes::splat(re)
    }

    #[inline(always)]
    fn scale(self, factor: &f64) -> Self {
        self * *factor
    }

    #[inline(always)]
    fn recip(&self) -> Self {
        Lanes::splat(1.0) / *self
    }

    #[inline(always)]
    fn sqrt(&self) -> Self {
        self.root()
    }

    #[inline(always)]
    fn sin(&self) -> Self {
        self.circular().0
    }

    #[inline(always)]
    fn cos(&self) -> Self {
        self.circular().1
    }

    #[inline(always)]
    fn sin_cos(&self) -> (Self, Self) {
        self.circular()
    }

    fn atan2(&self, other: Self) -> Self {
        let (y, x) = (self.each(), other.each());
        Lanes::from(std::array::from_fn(|i| y[i].atan2(x[i])))
    }

    by_lane! {
        powi(n: i32), powf(n: f64), cbrt, exp, exp2, exp_m1, ln, log(base: f64), log2, log10, ln_1p, tan, asin, acos,
        atan, sinh, cosh, tanh, asinh, acosh, atanh, sph_j0, sph_j1, sph_j2,
    }
}
