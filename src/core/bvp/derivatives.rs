//! Sizes of the derivatives that dual numbers carry.

use crate::core::scalar::{DualChunk, Jet, Scalar};
use num_dual::{Dual, Dual2};

/// A number type that reports the size of a number and, if the number carries derivatives, the size
/// of the derivatives.
pub trait Derivatives {
    /// Returns the absolute value of the largest derivative that the number carries; 0 for a real
    /// number.
    fn largest_derivative(&self) -> f64;

    /// Returns the largest absolute value among the real part and the derivatives of the number.
    fn largest_part(&self) -> f64;
}

fn largest(parts: impl IntoIterator<Item = f64>) -> f64 {
    parts.into_iter().fold(0.0, f64::max)
}

impl Derivatives for f64 {
    fn largest_derivative(&self) -> f64 {
        0.0
    }

    fn largest_part(&self) -> f64 {
        self.abs()
    }
}

/// Implements [`Derivatives`] for dual numbers, which consist of a real part and derivatives.
macro_rules! parts {
    ($([$($generics:tt)*] $number:ty: $own:ident => $re:expr, $others:expr;)*) => {$(
        impl<$($generics)*> Derivatives for $number {
            fn largest_derivative(&self) -> f64 {
                let $own = self;
                largest($others.map(|part| part.largest_part())).max($re.largest_derivative())
            }

            fn largest_part(&self) -> f64 {
                let $own = self;
                self.largest_derivative().max($re.largest_part())
            }
        }
    )*};
}

parts! {
    [T: Scalar + Derivatives] Dual<T>: own => own.re, [&own.eps];
    [T: Scalar + Derivatives] Dual2<T>: own => own.re, [&own.v1, &own.v2];
    [T: Scalar + Derivatives, const W: usize] DualChunk<T, W>: own => own.re, own.eps;
    [const C: usize] Jet<C>: own => own.coefficients()[0], own.coefficients()[1..].iter();
}
