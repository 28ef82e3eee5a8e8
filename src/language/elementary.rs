//! Elementary functions of nested dual numbers and jets, by their Taylor series.
//!
//! The argument of a function is `x = x₀ + h` with a real number `x₀` and a nilpotent part `h`: the
//! power `h^{N+1}` vanishes, where `N` is the number of derivatives, so that `f(x) = Σ_{k ≤ N}
//! f⁽ᵏ⁾(x₀)/k! hᵏ`. Interpreted formulas call about thirty functions for about forty scalar types:
//! one Taylor composition is compiled for each type, instead of a chain rule for each function and
//! each level of nesting.

use crate::core::scalar::Scalar;
use crate::core::scalar::jet::powers::{by_quotient, by_squares};
use crate::core::scalar::jet::series;
use crate::core::scalar::jet::taylor::{self, MOST_ORDER, Series};

/// Returns whether functions of this scalar type are evaluated by Taylor composition. The chain
/// rule is faster for first derivatives, and batched numbers contain first derivatives only; jets
/// have their own Taylor composition.
const fn composes<T: Scalar>() -> bool {
    T::NDERIV > 1 && T::NDERIV < MOST_ORDER
}

/// Evaluates the Taylor series `Σ_k f_k hᵏ` by Horner's rule.
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
        pub(super) fn $function<T: Scalar>(a: &T) -> T {
            if composes::<T>() { composed(a, &series::$function(a.real())) } else { a.$function() }
        }
    )*};
}

functions! {
    recip sqrt cbrt exp exp2 exp_m1 ln log2 log10 ln_1p sin cos tan asin acos atan sinh cosh tanh asinh acosh atanh
}

#[inline]
pub(super) fn sin_cos<T: Scalar>(a: &T) -> (T, T) {
    if !composes::<T>() {
        return a.sin_cos();
    }
    let [sin, cos] = taylor::sin_cos(a.real());
    (composed(a, &sin), composed(a, &cos))
}

#[inline]
pub(super) fn powi<T: Scalar>(a: &T, n: i32) -> T {
    if composes::<T>() { by_squares(a, n, recip) } else { a.powi(n) }
}

#[inline]
pub(super) fn powf<T: Scalar>(a: &T, n: f64) -> T {
    if composes::<T>() { composed(a, &taylor::real_power(a.real(), n)) } else { a.powf(n) }
}

#[inline]
pub(super) fn atan2<T: Scalar>(y: &T, x: &T) -> T {
    if composes::<T>() { by_quotient(y, x, [recip, atan]) } else { y.atan2(*x) }
}
