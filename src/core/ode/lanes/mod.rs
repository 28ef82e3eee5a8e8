//! Numbers side by side, one in each lane of a vector register: several flows of one field take a
//! step at once.
//!
//! Every lane is computed as if the others were not there, to the last bit, so that what is found
//! does not depend on which flows go together.

mod dual;
mod sine;

use crate::core::scalar::{Scalar, operations};
use num_dual::{Dual, Dual64};
use std::fmt::{Display, Formatter};
use std::ops::Neg;

#[cfg(not(target_feature = "avx512f"))]
use wide::f64x4 as Vector;
/// As many numbers as registers hold: more of them would not stay in registers. What a lane holds
/// does not depend on their number.
#[cfg(target_feature = "avx512f")]
use wide::f64x8 as Vector;

/// How many numbers there are side by side.
pub(in crate::core) const LANES: usize = size_of::<Vector>() / size_of::<f64>();

/// A scalar of which [`LANES`] go side by side.
pub trait InLanes: Scalar {
    /// The scalars of all lanes.
    type Wide: Scalar;

    /// Puts scalars side by side.
    fn gather(each: [Self; LANES]) -> Self::Wide;

    /// The scalar of one lane.
    fn lane(wide: &Self::Wide, lane: usize) -> Self;

    /// The real parts of all lanes.
    fn reals(wide: &Self::Wide) -> Lanes;
}

impl InLanes for f64 {
    type Wide = Lanes;

    #[inline(always)]
    fn gather(each: [f64; LANES]) -> Lanes {
        Lanes::from(each)
    }

    #[inline(always)]
    fn lane(wide: &Lanes, lane: usize) -> f64 {
        wide.0.as_array()[lane]
    }

    #[inline(always)]
    fn reals(wide: &Lanes) -> Lanes {
        *wide
    }
}

impl InLanes for Dual64 {
    type Wide = Dual<Lanes>;

    #[inline(always)]
    fn gather(each: [Dual64; LANES]) -> Dual<Lanes> {
        Dual::new(Lanes::from(each.map(|x| x.re)), Lanes::from(each.map(|x| x.eps)))
    }

    #[inline(always)]
    fn lane(wide: &Dual<Lanes>, lane: usize) -> Dual64 {
        Dual::new(f64::lane(&wide.re, lane), f64::lane(&wide.eps, lane))
    }

    #[inline(always)]
    fn reals(wide: &Dual<Lanes>) -> Lanes {
        wide.re
    }
}

/// Numbers side by side. Arithmetic and elementary functions are those of each lane; a comparison,
/// or a decision by the real part, can only be one for all, and sees the first lane.
#[derive(Clone, Copy, Debug)]
pub struct Lanes(Vector);

impl Lanes {
    /// One number in all lanes.
    #[inline(always)]
    pub fn splat(value: f64) -> Self {
        Lanes(Vector::splat(value))
    }

    /// The numbers of the lanes.
    #[inline(always)]
    pub fn each(self) -> [f64; LANES] {
        self.0.to_array()
    }

    /// The first number.
    #[inline(always)]
    fn first(self) -> f64 {
        self.0.as_array()[0]
    }

    /// A function that has no vector form, lane by lane.
    fn map(self, function: impl Fn(f64) -> f64) -> Self {
        Lanes(Vector::new(self.each().map(function)))
    }

    /// The larger number in each lane.
    #[inline(always)]
    pub fn most(self, other: Self) -> Self {
        Lanes(self.0.fast_max(other.0))
    }

    /// The smaller number in each lane.
    #[inline(always)]
    pub fn least(self, other: Self) -> Self {
        Lanes(self.0.fast_min(other.0))
    }

    /// In which lanes the number is larger than another, one bit each.
    #[inline(always)]
    pub fn exceeds(self, other: Self) -> u32 {
        self.0.simd_gt(other.0).to_bitmask()
    }
}

impl From<[f64; LANES]> for Lanes {
    #[inline(always)]
    fn from(values: [f64; LANES]) -> Self {
        Lanes(Vector::new(values))
    }
}

impl Neg for Lanes {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Lanes(-self.0)
    }
}

operations! { [] Lanes, |a, b|
    += a.0 += b.0, a.0 += b;
    -= a.0 -= b.0, a.0 -= b;
    *= a.0 *= b.0, a.0 *= b;
    /= a.0 /= b.0, a.0 /= b;
    %= a.0 %= b.0, a.0 %= b;
}

impl Display for Lanes {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        write!(f, "{:?}", self.each())
    }
}
