//! Macros for the `num_dual` and `num_traits` operations that all scalars of this crate share.

/// Implements comparison by real parts, constants, sums, products and conversions for a scalar
/// type.
///
/// The macro argument `real` is a function that returns the real part of a number, for comparisons;
/// the macro argument `constant` is a function that converts a real number to the scalar type.
macro_rules! number_of_reals {
    ([$($generics:tt)*] $type:ty, real: $real:expr, constant: $constant:expr) => {
        impl<$($generics)*> PartialEq for $type {
            fn eq(&self, other: &Self) -> bool {
                $real(self) == $real(other)
            }
        }

        impl<$($generics)*> PartialOrd for $type {
            fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
                $real(self).partial_cmp(&$real(other))
            }
        }

        impl<$($generics)*> PartialEq<f64> for $type {
            fn eq(&self, other: &f64) -> bool {
                $real(self) == *other
            }
        }

        impl<$($generics)*> PartialOrd<f64> for $type {
            fn partial_cmp(&self, other: &f64) -> Option<std::cmp::Ordering> {
                $real(self).partial_cmp(other)
            }
        }

        impl<$($generics)*> From<f64> for $type {
            #[inline(always)]
            fn from(value: f64) -> Self {
                $constant(value)
            }
        }

        impl<$($generics)*> num_traits::Zero for $type {
            #[inline(always)]
            fn zero() -> Self {
                $constant(0.0)
            }

            fn is_zero(&self) -> bool {
                $real(self) == 0.0
            }
        }

        impl<$($generics)*> num_traits::One for $type {
            #[inline(always)]
            fn one() -> Self {
                $constant(1.0)
            }
        }

        impl<$($generics)*> num_traits::Num for $type {
            type FromStrRadixErr = <f64 as num_traits::Num>::FromStrRadixErr;

            fn from_str_radix(text: &str, radix: u32) -> Result<Self, Self::FromStrRadixErr> {
                <f64 as num_traits::Num>::from_str_radix(text, radix).map($constant)
            }
        }

        impl<$($generics)*> num_traits::Inv for $type {
            type Output = Self;
            fn inv(self) -> Self {
                num_dual::DualNum::recip(&self)
            }
        }

        impl<$($generics)*> std::iter::Sum for $type {
            fn sum<I: Iterator<Item = Self>>(terms: I) -> Self {
                terms.fold($constant(0.0), |sum, term| sum + term)
            }
        }

        impl<$($generics)*> std::iter::Product for $type {
            fn product<I: Iterator<Item = Self>>(factors: I) -> Self {
                factors.fold($constant(1.0), |product, factor| product * factor)
            }
        }

        impl<$($generics)*> num_traits::FromPrimitive for $type {
            fn from_i64(n: i64) -> Option<Self> {
                <f64 as num_traits::FromPrimitive>::from_i64(n).map($constant)
            }

            fn from_u64(n: u64) -> Option<Self> {
                <f64 as num_traits::FromPrimitive>::from_u64(n).map($constant)
            }

            fn from_f64(n: f64) -> Option<Self> {
                Some($constant(n))
            }
        }

        impl<$($generics)*> num_dual::DualStruct for $type {
            type Real = f64;
            type Inner = f64;

            fn re(&self) -> f64 {
                $real(self)
            }

            fn from_inner(inner: &f64) -> Self {
                $constant(*inner)
            }
        }

        impl<$($generics)*> num_dual::Mappable<Self> for $type {
            type Output<O> = O;

            fn map_dual<M: Fn(Self) -> O, O>(self, f: M) -> O {
                f(self)
            }
        }
    };
}

/// Implements the absolute value and the sign of a scalar type by means of the real part.
macro_rules! signed_by_reals {
    ([$($generics:tt)*] $type:ty) => {
        impl<$($generics)*> num_traits::Signed for $type {
            fn abs(&self) -> Self {
                if num_traits::Signed::is_positive(self) { *self } else { -*self }
            }

            fn abs_sub(&self, other: &Self) -> Self {
                if self > other { *self - other } else { Self::from(0.0) }
            }

            fn signum(&self) -> Self {
                Self::from(if *self == 0.0 { 0.0 } else { num_dual::DualStruct::re(self).signum() })
            }

            fn is_positive(&self) -> bool {
                num_dual::DualStruct::re(self).is_sign_positive()
            }

            fn is_negative(&self) -> bool {
                num_dual::DualStruct::re(self).is_sign_negative()
            }
        }
    };
}

/// Implements every arithmetic operation by means of its assigning form; the second operand is a
/// number of the same type or a real number.
macro_rules! operations {
    (one [$($generics:tt)*] $type:ty, |$a:ident, $b:ident|
        $operation:ident $method:ident, $assign:ident $assigning:ident = $with_number:expr, $with_real:expr
    ) => {
        impl<$($generics)*> std::ops::$assign<&$type> for $type {
            #[inline(always)]
            fn $assigning(&mut self, $b: &Self) {
                let $a = self;
                $with_number;
            }
        }
        impl<$($generics)*> std::ops::$assign<f64> for $type {
            #[inline(always)]
            fn $assigning(&mut self, $b: f64) {
                let $a = self;
                $with_real;
            }
        }
        impl<$($generics)*> std::ops::$assign for $type {
            #[inline(always)]
            fn $assigning(&mut self, other: Self) {
                std::ops::$assign::$assigning(self, &other);
            }
        }
        impl<$($generics)*> std::ops::$operation for $type {
            type Output = Self;
            #[inline(always)]
            fn $method(mut self, other: Self) -> Self {
                std::ops::$assign::$assigning(&mut self, &other);
                self
            }
        }
        impl<$($generics)*> std::ops::$operation<&$type> for $type {
            type Output = Self;
            #[inline(always)]
            fn $method(mut self, other: &Self) -> Self {
                std::ops::$assign::$assigning(&mut self, other);
                self
            }
        }
        impl<$($generics)*> std::ops::$operation<f64> for $type {
            type Output = Self;
            #[inline(always)]
            fn $method(mut self, other: f64) -> Self {
                std::ops::$assign::$assigning(&mut self, other);
                self
            }
        }
    };
    ($generics:tt $type:ty, |$a:ident, $b:ident|
        += $add:expr, $add_real:expr;
        -= $subtract:expr, $subtract_real:expr;
        *= $multiply:expr, $multiply_real:expr;
        /= $divide:expr, $divide_real:expr;
        %= $rest:expr, $rest_real:expr;
    ) => {
        $crate::core::scalar::operations! { one $generics $type, |$a, $b|
            Add add, AddAssign add_assign = $add, $add_real }
        $crate::core::scalar::operations! { one $generics $type, |$a, $b|
            Sub sub, SubAssign sub_assign = $subtract, $subtract_real }
        $crate::core::scalar::operations! { one $generics $type, |$a, $b|
            Mul mul, MulAssign mul_assign = $multiply, $multiply_real }
        $crate::core::scalar::operations! { one $generics $type, |$a, $b|
            Div div, DivAssign div_assign = $divide, $divide_real }
        $crate::core::scalar::operations! { one $generics $type, |$a, $b|
            Rem rem, RemAssign rem_assign = $rest, $rest_real }
    };
}

pub(in crate::core) use {number_of_reals, operations, signed_by_reals};
