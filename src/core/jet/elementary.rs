//! Elementary functions of numbers of any depth, by their Taylor series where numbers are nested.
//!
//! `x = x₀ + h` with a real number `x₀`, and `h` has a vanishing power `h^{N+1}` where `N` is the number of derivatives, so that
//! `f(x) = Σ_{k ≤ N} f⁽ᵏ⁾(x₀)/k! hᵏ`. Interpreted formulas call some thirty functions in some forty scalars: one composition for each
//! scalar takes a tenth of the compiled text that the chain rule takes, function by function and layer by layer.

use super::series;
use super::space::MOST_ORDER;
use super::taylor::{self, Series};
use crate::core::scalar::Scalar;

/// Whether functions of this scalar are compositions: the chain rule is faster for one derivative, which numbers in lanes have at
/// most, and jets compose by themselves, to the order that they have.
const fn composes<T: Scalar>() -> bool {
    T::NDERIV > 1 && T::NDERIV < MOST_ORDER
}

/// `Σ_k f_k hᵏ` by Horner's rule.
#[inline(never)]
fn composed<T: Scalar>(x: &T, f: &Series) -> T {
    let h = *x - x.real();
    let mut sum = h * f[T::NDERIV] + f[T::NDERIV - 1];
    for f in f[..T::NDERIV - 1].iter().rev() {
        sum = sum * h + *f;
    }
    sum
}

macro_rules! functions {
    ($($function:ident)*) => {$(
        #[inline]
        pub(crate) fn $function<T: Scalar>(a: &T) -> T {
            if composes::<T>() { composed(a, &series::$function(a.real())) } else { a.$function() }
        }
    )*};
}

functions! {
    recip sqrt cbrt exp exp2 exp_m1 ln log2 log10 ln_1p sin cos tan asin acos atan sinh cosh tanh asinh acosh atanh
}

#[inline]
pub(crate) fn sin_cos<T: Scalar>(a: &T) -> (T, T) {
    if !composes::<T>() {
        return a.sin_cos();
    }
    let [sin, cos] = taylor::sin_cos(a.real());
    (composed(a, &sin), composed(a, &cos))
}

#[inline]
pub(crate) fn powi<T: Scalar>(a: &T, n: i32) -> T {
    if composes::<T>() { by_squares(a, n) } else { a.powi(n) }
}

/// `aⁿ` by repeated squares, so that nothing is divided by.
#[inline(never)]
pub(super) fn by_squares<T: Scalar>(a: &T, n: i32) -> T {
    let (mut rest, mut square, mut power) = (n.unsigned_abs(), *a, T::one());
    while rest > 0 {
        if rest % 2 == 1 {
            power *= square;
        }
        rest /= 2;
        if rest > 0 {
            square *= square;
        }
    }
    if n < 0 { recip(&power) } else { power }
}

#[inline]
pub(crate) fn powf<T: Scalar>(a: &T, n: f64) -> T {
    if composes::<T>() { composed(a, &taylor::real_power(a.real(), n)) } else { a.powf(n) }
}

#[inline]
pub(crate) fn atan2<T: Scalar>(y: &T, x: &T) -> T {
    if composes::<T>() { by_quotient(y, x) } else { y.atan2(*x) }
}

/// The angle of `(x, y)` by the quotient that is at most 1 in size.
#[inline(never)]
pub(super) fn by_quotient<T: Scalar>(y: &T, x: &T) -> T {
    let near = match y.real().abs() <= x.real().abs() {
        true => atan(&(*y * recip(x))),
        false => -atan(&(*x * recip(y))),
    };
    near - near.real() + y.real().atan2(x.real())
}
