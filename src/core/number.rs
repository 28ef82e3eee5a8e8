//! What every scalar of the library's own has in common, as `num_dual` and `num_traits` ask for it.

/// Implements comparison by real parts, constants, sums, products and conversions for a scalar.
///
/// `real` gives the real part by which numbers are compared, `constant` a number from it.
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

/// Implements every operation from its assigning forms with a reference and with a real number, which the caller
/// implements; the traits of `std::ops` are in scope where it stands.
macro_rules! operations {
    (one [$($generics:tt)*] $type:ty: $operation:ident $method:ident $assign:ident $assigning:ident) => {
        impl<$($generics)*> $assign for $type {
            #[inline(always)]
            fn $assigning(&mut self, other: Self) {
                $assign::$assigning(self, &other);
            }
        }
        impl<$($generics)*> $operation for $type {
            type Output = Self;
            #[inline(always)]
            fn $method(mut self, other: Self) -> Self {
                $assign::$assigning(&mut self, &other);
                self
            }
        }
        impl<$($generics)*> $operation<&$type> for $type {
            type Output = Self;
            #[inline(always)]
            fn $method(mut self, other: &Self) -> Self {
                $assign::$assigning(&mut self, other);
                self
            }
        }
        impl<$($generics)*> $operation<f64> for $type {
            type Output = Self;
            #[inline(always)]
            fn $method(mut self, other: f64) -> Self {
                $assign::$assigning(&mut self, other);
                self
            }
        }
    };
    ($generics:tt $type:ty) => {
        $crate::core::number::operations! { $generics $type:
            Add add AddAssign add_assign; Sub sub SubAssign sub_assign; Mul mul MulAssign mul_assign;
            Div div DivAssign div_assign; Rem rem RemAssign rem_assign;
        }
    };
    ($generics:tt $type:ty: $($operation:ident $method:ident $assign:ident $assigning:ident;)*) => {$(
        $crate::core::number::operations!(one $generics $type: $operation $method $assign $assigning);
    )*};
}

pub(in crate::core) use {number_of_reals, operations};
