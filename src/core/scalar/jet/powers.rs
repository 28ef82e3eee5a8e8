//! Integer powers and polar angles for any scalar type, computed from products and functions of one
//! variable.

use crate::core::scalar::Scalar;

/// Computes `aⁿ` by repeated squaring; for `n ≥ 0` the computation does not use divisions.
#[inline(never)]
pub(crate) fn by_squares<T: Scalar>(a: &T, n: i32, recip: fn(&T) -> T) -> T {
    if n == 0 {
        return T::one();
    }
    let (bits, mut square) = (n.unsigned_abs(), *a);
    for _ in 0..bits.trailing_zeros() {
        square *= square;
    }
    let (mut rest, mut power) = (bits >> bits.trailing_zeros() >> 1, square);
    while rest > 0 {
        square *= square;
        if rest % 2 == 1 {
            power *= square;
        }
        rest /= 2;
    }
    if n < 0 { recip(&power) } else { power }
}

/// Computes the polar angle of `(x, y)` from the quotient `y/x` or `x/y` whose magnitude is at most
/// 1.
#[inline(never)]
pub(crate) fn by_quotient<T: Scalar>(y: &T, x: &T, [recip, atan]: [fn(&T) -> T; 2]) -> T {
    let near = match y.real().abs() <= x.real().abs() {
        true => atan(&(*y * recip(x))),
        false => -atan(&(*x * recip(y))),
    };
    near - near.real() + y.real().atan2(x.real())
}
