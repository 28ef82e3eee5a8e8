//! Numbers in the lanes of a vector register, with which several flows of one vector field take an
//! integration step simultaneously.
//!
//! The result in each lane is bitwise independent of the other lanes: results depend neither on the
//! flows that share a register, nor on the width of registers.

mod dual;
mod register;
mod sine;

pub(in crate::core) use self::register::in_registers;
pub use self::register::{Avx2, Avx512, Baseline, LaneWidth, MOST_LANES, Register, Registered};
#[cfg(feature = "scene")]
pub(crate) use self::register::{in_registers_of, with_avx2};

use super::number::operations;
use super::{DualChunk, Scalar};
use fearless_simd::{SimdBase, SimdMask};
use num_dual::Dual64;
use std::fmt::{Display, Formatter};
use std::ops::Neg;

/// Dual numbers in the lanes of a vector register, each with one derivative. (Operations of
/// `num_dual::Dual` are too long for compilers to inline automatically.)
pub type DualLanes<R> = DualChunk<Lanes<R>, 1>;

/// A scalar type that can be evaluated in the lanes of registers `R`, several numbers at a time.
pub trait InLanes<R: Register>: Scalar {
    /// The type that contains the scalars of all lanes.
    type Wide: Scalar;

    /// Combines several scalars into one number with one scalar per lane.
    fn gather(each: &[Self; MOST_LANES]) -> Self::Wide;

    /// Returns the scalar in one lane.
    fn lane(wide: &Self::Wide, lane: usize) -> Self;

    /// Returns the real parts of the scalars in all lanes.
    fn reals(wide: &Self::Wide) -> Lanes<R>;
}

impl<R: Register> InLanes<R> for f64 {
    type Wide = Lanes<R>;

    #[inline(always)]
    fn gather(each: &[f64; MOST_LANES]) -> Lanes<R> {
        Lanes::from(each)
    }

    #[inline(always)]
    fn lane(wide: &Lanes<R>, lane: usize) -> f64 {
        wide.0[lane]
    }

    #[inline(always)]
    fn reals(wide: &Lanes<R>) -> Lanes<R> {
        *wide
    }
}

impl<R: Register> InLanes<R> for Dual64 {
    type Wide = DualLanes<R>;

    #[inline(always)]
    fn gather(each: &[Dual64; MOST_LANES]) -> DualLanes<R> {
        let [re, eps] = [each.map(|x| x.re), each.map(|x| x.eps)];
        DualLanes { re: Lanes::from(&re), eps: [Lanes::from(&eps)] }
    }

    #[inline(always)]
    fn lane(wide: &DualLanes<R>, lane: usize) -> Dual64 {
        Dual64::new(wide.re.0[lane], wide.eps[0].0[lane])
    }

    #[inline(always)]
    fn reals(wide: &DualLanes<R>) -> Lanes<R> {
        wide.re
    }
}

/// Real numbers in the lanes of a vector register. Arithmetic operations and elementary functions
/// are applied to each lane separately. A comparison, or a branch on the real part, has one result
/// for all lanes, which is determined by the first lane.
#[derive(Clone, Copy, Debug)]
pub struct Lanes<R: Register>(R::Vector);

impl<R: Register> Lanes<R> {
    /// Creates a number with the same value in all lanes.
    #[inline(always)]
    pub fn splat(value: f64) -> Self {
        Lanes(R::Vector::splat(R::instructions(), value))
    }

    /// Returns the numbers in the lanes, padded with zeros.
    #[inline(always)]
    pub fn each(self) -> [f64; MOST_LANES] {
        let mut each = [0.0; MOST_LANES];
        each[..R::LANES].copy_from_slice(self.0.as_slice());
        each
    }

    /// Returns the number in the first lane.
    #[inline(always)]
    fn first(self) -> f64 {
        self.0[0]
    }

    /// Applies a function that has no vector implementation, lane by lane.
    fn map(self, function: impl Fn(f64) -> f64) -> Self {
        self.map_lanes(|_, x| function(x))
    }

    /// Applies a function of the lane's index and of the number in the lane, lane by lane.
    #[inline(always)]
    fn map_lanes(self, function: impl Fn(usize, f64) -> f64) -> Self {
        let Lanes(mut x) = self;
        x.as_mut_slice().iter_mut().enumerate().for_each(|(lane, x)| *x = function(lane, *x));
        Lanes(x)
    }

    /// Returns the larger of two numbers in each lane.
    #[inline(always)]
    pub fn most(self, other: Self) -> Self {
        Lanes(self.0.max(other.0))
    }

    /// Returns the smaller of two numbers in each lane.
    #[inline(always)]
    pub fn least(self, other: Self) -> Self {
        Lanes(self.0.min(other.0))
    }

    /// Returns a bit mask of the lanes in which this number is larger than the other number.
    #[inline(always)]
    pub fn exceeds(self, other: Self) -> u32 {
        self.0.simd_gt(other.0).to_bitmask() as u32
    }
}

/// Converts the first elements of an array to numbers in lanes, one element per lane.
impl<R: Register> From<&[f64; MOST_LANES]> for Lanes<R> {
    #[inline(always)]
    fn from(values: &[f64; MOST_LANES]) -> Self {
        Lanes(R::Vector::from_slice(R::instructions(), &values[..R::LANES]))
    }
}

impl<R: Register> Neg for Lanes<R> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Lanes(-self.0)
    }
}

operations! { [R: Register] Lanes<R>, |a, b|
    += a.0 += b.0, a.0 += b;
    -= a.0 -= b.0, a.0 -= b;
    *= a.0 *= b.0, a.0 *= b;
    /= a.0 /= b.0, a.0 /= b;
    %= *a = a.map_lanes(|lane, x| x % b.0[lane]), *a = a.map(|x| x % b);
}

impl<R: Register> Display for Lanes<R> {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        write!(f, "{:?}", self.0.as_slice())
    }
}
