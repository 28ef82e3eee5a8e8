//! Derivatives in several directions at a time: dual numbers with a chunk of derivatives.

use super::Scalar;
use super::number::{number_of_reals, operations, signed_by_reals};
use num_dual::{Dual, Dual2, DualNum};
use std::any::Any;
use std::fmt::{Display, Formatter};
use std::ops::Neg;
use wide::f64x4;

/// (H) The number of directions that are differentiated in one pass: two to one vector registers,
/// as measured. Only time depends on it.
pub const CHUNK: usize = 8;
/// Dual numbers with derivatives in [`CHUNK`] directions.
pub type Chunk = DualChunk<f64, CHUNK>;
/// Numbers with half a chunk of derivatives, for small problems.
pub(in crate::core) type Narrow = DualChunk<f64, 4>;

/// A dual number with derivatives in `W` directions: a [`Scalar`], compared by its real part.
///
/// It stands for `num_dual::DualSVec` where derivatives are taken in inner loops: without an
/// `Option` in every number, products are a few vector instructions. Elementary functions take
/// their slopes from [`num_dual::Dual`].
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
    /// A number that depends on nothing.
    #[inline(always)]
    pub fn of(re: T) -> Self {
        DualChunk { re, eps: [T::zero(); W] }
    }

    /// `x` with the unit direction `direction`; one beyond the width is none.
    #[inline(always)]
    pub fn seeded(x: T, direction: usize) -> Self {
        // All parts at once: one that is stored by itself would be waited for where the chunk is
        // loaded as vectors.
        let part = |k| if k == direction { T::one() } else { T::zero() };
        DualChunk { re: x, eps: std::array::from_fn(part) }
    }

    /// A function of the number, from its value and slope at the real part.
    #[inline(always)]
    fn chained(&self, function: Dual<T>) -> Self {
        let Dual { re, eps: slope } = function;
        // No derivative stays none where the slope is infinite; parts of nested numbers cannot be
        // told to be none.
        // In lanes one decision cannot be right for all.
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

    /// The real part with a derivative of 1.
    #[inline(always)]
    fn unit(&self) -> Dual<T> {
        Dual::new(self.re, T::one())
    }

    /// The number with all parts changed alike.
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

    /// The number with both parts changed.
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

/// The derivatives in all directions.
#[inline(always)]
fn parts<T: Copy, const W: usize>(mut part: impl FnMut(usize) -> T) -> [T; W] {
    // One derivative in lanes is computed in place, with the instructions of their registers.
    if W == 1 { [part(0); W] } else { std::array::from_fn(part) }
}

/// An operation on all parts: compiled in place where they are real, and once where they are nested
/// numbers, whose operations would otherwise fill every caller.
#[inline(always)]
fn of_parts<T: Scalar, R>(operation: impl FnOnce() -> R) -> R {
    #[inline(never)]
    fn once<R>(operation: impl FnOnce() -> R) -> R {
        operation()
    }
    if T::NDERIV == 0 { operation() } else { once(operation) }
}

/// `a y + b x`. Of real numbers it is computed in vectors by name: where numbers come from memory,
/// the compiler otherwise loads the last part with the real part behind it, which waits until both
/// have been stored.
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

/// `x` with the unit direction `direction` if that lies in the chunk that begins at `start`.
pub(crate) fn seeded<T: Scalar, const W: usize>(
    x: T,
    direction: usize,
    start: usize,
) -> DualChunk<T, W> {
    DualChunk::seeded(x, direction.wrapping_sub(start))
}

/// A number with a chunk of derivatives, and with derivatives along a direction, up to some order.
pub(crate) trait Directional: Scalar {
    /// A value that is seeded, and its component of the direction.
    fn along(seeded: Chunk, component: f64) -> Self;

    /// The derivative of the highest order along the direction: of order 0 the value itself.
    fn derivative(&self) -> &Chunk;
}

/// Without derivatives along a direction: order 0.
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

// The remainder of a division is that which is truncated as its real part is.
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

/// Functions of one number by the chain rule.
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
