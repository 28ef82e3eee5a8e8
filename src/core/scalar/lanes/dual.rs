//! The `num_dual` traits for numbers with one value in each lane of a vector register, so that
//! equations can be evaluated with such numbers.

use super::Lanes;
use super::register::Register;
use crate::core::scalar::number::number_of_reals;
use fearless_simd::{SimdBase, SimdFloat};
use num_dual::DualNum;
use num_traits::{Signed, Zero};

number_of_reals!([R: Register] Lanes<R>, real: |x: &Self| x.first(), constant: Lanes::splat);

impl<R: Register> Signed for Lanes<R> {
    fn abs(&self) -> Self {
        Lanes(self.0.abs())
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

/// Implements functions of numbers in lanes, by applying the same function of real numbers to each
/// lane.
macro_rules! by_lane {
    ($($function:ident $(($argument:ident: $kind:ty))?),* $(,)?) => {$(
        fn $function(&self $(, $argument: $kind)?) -> Self {
            self.map(|x| DualNum::$function(&x $(, $argument)?))
        }
    )*};
}

impl<R: Register> DualNum for Lanes<R> {
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
        Lanes(self.0.sqrt())
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
        self.map_lanes(|lane, y| y.atan2(other.0[lane]))
    }

    by_lane! {
        powi(n: i32), powf(n: f64), cbrt, exp, exp2, exp_m1, ln, log(base: f64), log2, log10, ln_1p, tan, asin, acos,
        atan, sinh, cosh, tanh, asinh, acosh, atanh, sph_j0, sph_j1, sph_j2,
    }
}
