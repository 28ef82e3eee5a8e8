//! Derivatives in several directions together, by dual numbers with several derivatives.

use super::Scalar;
use super::number::{number_of_reals, operations, signed_by_reals};
use num_dual::{Dual, Dual2, DualNum};
use std::any::Any;
use std::fmt::{Display, Formatter};
use std::ops::Neg;
use wide::f64x4;

/// Heuristic: the number of directions in which one pass differentiates; it fills one or two vector
/// registers, and was chosen by measurement. The number of directions affects only the run time.
pub const CHUNK: usize = 8;
/// A dual number with derivatives in [`CHUNK`] directions.
pub type Chunk = DualChunk<f64, CHUNK>;
/// A dual number with half as many derivatives as [`Chunk`], for small problems.
pub(in crate::core) type Narrow = DualChunk<f64, 4>;

/// A dual number with derivatives in `W` directions; it is a [`Scalar`] and is compared by its real
/// part.
///
/// This type replaces `num_dual::DualSVec` in inner loops: since a number does not contain an
/// `Option`, a product takes a few vector instructions. The derivatives of elementary functions are
/// computed by [`num_dual::Dual`].
///
/// ```
/// use num_dual::DualNum;
/// use tangency::core::scalar::DualChunk;
/// let x = DualChunk::<f64, 2>::seeded(3.0, 0);
/// let y = DualChunk::seeded(4.0, 1);
/// let f = x * y + x.powi(2);
/// assert_eq!((f.re, f.eps), (21.0, [10.0, 3.0]));
/// ```
#[derive(Clone, Copy, Debug)]
pub struct DualChunk<T, const W: usize> {
    /// The real part.
    pub re: T,
    /// The derivatives.
    pub eps: [T; W],
}

impl<T: Scalar, const W: usize> DualChunk<T, W> {
    /// Creates a constant: a number with zero derivatives.
    #[inline(always)]
    pub fn of(re: T) -> Self {
        DualChunk { re, eps: [T::zero(); W] }
    }

    /// Creates the variable `x`, whose derivative is 1 in the direction `direction`; the result is
    /// a constant if `direction` is at least `W`.
    #[inline(always)]
    pub fn seeded(x: T, direction: usize) -> Self {
        // All parts are stored together: loading the chunk as vectors would stall after the store of
        // a single part.
        let part = |k| if k == direction { T::one() } else { T::zero() };
        DualChunk { re: x, eps: std::array::from_fn(part) }
    }

    /// Applies a function to the number by the chain rule, given the function's value and slope at
    /// the real part.
    #[inline(always)]
    fn chained(&self, function: Dual<T>) -> Self {
        let Dual { re, eps: slope } = function;
        // A zero derivative stays zero where the slope is infinite. Parts of nested numbers cannot be
        // tested for zero, and for numbers in lanes one test is not valid for all lanes.
        if size_of::<T>() == size_of::<f64>() && !slope.real().is_finite() {
            return DualChunk {
                re,
                eps: self.eps.map(|e| if e.is_zero() { e } else { e * slope }),
            };
        }
        DualChunk {
            re,
            eps: parts(
                #[inline(always)]
                |k| self.eps[k] * slope,
            ),
        }
    }

    /// Returns the real part as a dual number with the derivative 1.
    #[inline(always)]
    fn unit(&self) -> Dual<T> {
        Dual::new(self.re, T::one())
    }

    /// Applies a function to the real part and to every derivative.
    #[inline(always)]
    fn mapped(&self, part: impl Fn(T) -> T) -> Self {
        of_parts::<T, _>(
            #[inline(always)]
            || DualChunk {
                re: part(self.re),
                eps: parts(
                    #[inline(always)]
                    |k| part(self.eps[k]),
                ),
            },
        )
    }

    /// Combines the derivatives of two numbers by a function; `re` is the real part of the result.
    #[inline(always)]
    fn combined(&self, other: &Self, re: T, part: impl Fn(T, T) -> T) -> Self {
        of_parts::<T, _>(
            #[inline(always)]
            || DualChunk {
                re,
                eps: parts(
                    #[inline(always)]
                    |k| part(self.eps[k], other.eps[k]),
                ),
            },
        )
    }

    #[inline(always)]
    fn product(&self, other: &Self) -> Self {
        let (x, y) = (self.re, other.re);
        of_parts::<T, _>(
            #[inline(always)]
            || DualChunk { re: x * y, eps: weighted((&self.eps, y), (&other.eps, x)) },
        )
    }

    #[inline(always)]
    fn quotient(&self, other: &Self) -> Self {
        let (x, y, inverse) = (self.re, other.re, other.re.recip());
        self.combined(other, x * inverse, |a, b| (a * y - b * x) * inverse * inverse)
    }
}

/// Creates an array of derivatives: the results of a function for each direction.
#[inline(always)]
fn parts<T: Copy, const W: usize>(mut part: impl FnMut(usize) -> T) -> [T; W] {
    // A single derivative in lanes is computed in place, with the instructions of the caller.
    if W == 1 { [part(0); W] } else { std::array::from_fn(part) }
}

/// Runs an operation on all derivatives of a number. The operation is inlined if the derivatives are
/// real numbers. If the derivatives are nested dual numbers, the operation is compiled only once,
/// since its code would otherwise enlarge every caller.
#[inline(always)]
fn of_parts<T: Scalar, R>(operation: impl FnOnce() -> R) -> R {
    #[inline(never)]
    fn once<R>(operation: impl FnOnce() -> R) -> R {
        operation()
    }
    if T::NDERIV == 0 { operation() } else { once(operation) }
}

/// Computes the weighted sum `a y + b x` in every component. For real numbers the function uses
/// explicit vector instructions: for numbers in memory, the compiler otherwise loads the last
/// derivative together with the real part that follows it, and this load waits until both are
/// stored.
#[inline(always)]
fn weighted<T: Scalar, const W: usize>((a, y): (&[T; W], T), (b, x): (&[T; W], T)) -> [T; W] {
    #[inline(always)]
    fn real<T: 'static, R: 'static>(number: &T) -> Option<&R> {
        (number as &dyn Any).downcast_ref()
    }
    let mut sum = [T::zero(); W];
    let Some(reals) = (&mut sum as &mut dyn Any).downcast_mut::<[f64; W]>() else {
        return parts(
            #[inline(always)]
            |k| a[k] * y + b[k] * x,
        );
    };
    if let (Some(a), Some(b), Some(x), Some(y)) = (real(a), real(b), real(&x), real(&y)) {
        weighted_reals((a, *y), (b, *x), reals);
    }
    sum
}

#[inline(always)]
fn weighted_reals<const W: usize>(
    (a, y): (&[f64; W], f64),
    (b, x): (&[f64; W], f64),
    sum: &mut [f64; W],
) {
    let ((a, last_a), (b, last_b)) = (a.as_chunks::<4>(), b.as_chunks::<4>());
    let (sum, last) = sum.as_chunks_mut::<4>();
    for ((sum, a), b) in sum.iter_mut().zip(a).zip(b) {
        *sum = (f64x4::new(*a) * y + f64x4::new(*b) * x).to_array();
    }
    for ((sum, a), b) in last.iter_mut().zip(last_a).zip(last_b) {
        *sum = a * y + b * x;
    }
}

/// Creates the variable `x`, whose derivative is 1 in the direction `direction` if the chunk that
/// begins at the direction `start` contains this direction; otherwise the result is a constant.
pub(crate) fn seeded<T: Scalar, const W: usize>(
    x: T,
    direction: usize,
    start: usize,
) -> DualChunk<T, W> {
    DualChunk::seeded(x, direction.wrapping_sub(start))
}

/// A number with derivatives in a chunk of directions, and with higher derivatives along one more
/// direction.
pub(crate) trait Directional: Scalar {
    /// Adds the derivative `component` along the additional direction to a number with derivatives
    /// in a chunk of directions.
    fn along(seeded: Chunk, component: f64) -> Self;

    /// Returns the derivative of the highest order along the additional direction; for order 0, the
    /// number itself.
    fn derivative(&self) -> &Chunk;
}

/// The implementation for order 0, in which a number has no derivatives along the additional
/// direction.
impl Directional for Chunk {
    #[inline]
    fn along(seeded: Chunk, _: f64) -> Self {
        seeded
    }

    #[inline]
    fn derivative(&self) -> &Chunk {
        self
    }
}

impl Directional for Dual<Chunk> {
    #[inline]
    fn along(seeded: Chunk, component: f64) -> Self {
        Dual::new(seeded, Chunk::from(component))
    }

    #[inline]
    fn derivative(&self) -> &Chunk {
        &self.eps
    }
}

impl Directional for Dual2<Chunk> {
    #[inline]
    fn along(seeded: Chunk, component: f64) -> Self {
        Dual2::new(seeded, Chunk::from(component), Chunk::from(0.0))
    }

    #[inline]
    fn derivative(&self) -> &Chunk {
        &self.v2
    }
}

number_of_reals!(
    [T: Scalar, const W: usize] DualChunk<T, W>,
    real: |x: &Self| x.re.real(), constant: |value| Self::of(T::constant(value))
);

impl<T: Scalar, const W: usize> Neg for DualChunk<T, W> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        self.mapped(|x| -x)
    }
}

// The remainder of a division uses the quotient truncated by its real part.
operations! { [T: Scalar, const W: usize] DualChunk<T, W>, |a, b|
    += *a = a.combined(b, a.re + b.re, |x, y| x + y), a.re += b;
    -= *a = a.combined(b, a.re - b.re, |x, y| x - y), a.re -= b;
    *= *a = a.product(b), *a = a.mapped(|x| x * b);
    /= *a = a.quotient(b), *a = a.mapped(|x| x / b);
    %= *a -= *b * (a.re.real() / b.re.real()).trunc(), *a %= &Self::from(b);
}

impl<T: Scalar, const W: usize> Display for DualChunk<T, W> {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} + {:?}ε", self.re, self.eps)
    }
}

signed_by_reals!([T: Scalar, const W: usize] DualChunk<T, W>);

/// Implements functions of one number by the chain rule.
macro_rules! chained {
    ($($function:ident $(($argument:ident: $kind:ty))?),* $(,)?) => {$(
        #[inline]
        fn $function(&self $(, $argument: $kind)?) -> Self {
            self.chained(DualNum::$function(&self.unit() $(, $argument)?))
        }
    )*};
}

impl<T: Scalar, const W: usize> DualNum for DualChunk<T, W> {
    type Primitive = f64;
    type InnerDual = T;
    const NDERIV: usize = T::NDERIV + 1;

    #[inline(always)]
    fn from_re(re: T) -> Self {
        Self::of(re)
    }

    #[inline(always)]
    fn scale(self, factor: &T) -> Self {
        self.mapped(|x| x * factor)
    }

    #[inline(always)]
    fn sin(&self) -> Self {
        let (sin, cos) = self.re.sin_cos();
        self.chained(Dual::new(sin, cos))
    }

    #[inline(always)]
    fn cos(&self) -> Self {
        let (sin, cos) = self.re.sin_cos();
        self.chained(Dual::new(cos, -sin))
    }

    #[inline(always)]
    fn sin_cos(&self) -> (Self, Self) {
        let (sin, cos) = self.re.sin_cos();
        (self.chained(Dual::new(sin, cos)), self.chained(Dual::new(cos, -sin)))
    }

    fn atan2(&self, other: Self) -> Self {
        let angle = (*self / other).atan();
        DualChunk { re: self.re.atan2(other.re), ..angle }
    }

    chained! {
        recip, powi(n: i32), powf(n: f64), sqrt, cbrt, exp, exp2, exp_m1, ln, log(base: f64), log2, log10, ln_1p,
        tan, asin, acos, atan, sinh, cosh, tanh, asinh, acosh, atanh, sph_j0, sph_j1, sph_j2,
    }
}
