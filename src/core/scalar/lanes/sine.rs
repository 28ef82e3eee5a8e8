//! Sine and cosine of numbers in the lanes of a vector register.

use super::Lanes;
use super::register::Register;
use fearless_simd::{ExtractToken, Select, Simd, SimdBase, SimdMask};

/// Rounding: the largest magnitude of an argument that is reduced to `|x| ≤ π/4` with an error of
/// rounding size; the number of quarter turns then has 16 bits, so that its product with the first
/// part of π/2 is exact.
const LARGEST: f64 = 1e5;
/// A large number: adding it to another number, and then subtracting it again, rounds the other
/// number to an integer.
const ROUNDING: f64 = 6_755_399_441_055_744.0;
/// The value π/2 as the sum of two parts, the first of 33 bits.
const HALF_PI: [f64; 2] = [1.570_796_326_734_125_6, 6.077_100_506_506_192e-11];
/// The coefficients of `(sin x − x)/x³` in powers of `x²` for `|x| ≤ π/4`, from the highest power
/// (fdlibm).
const SINE: [f64; 6] = [
    1.589_690_995_211_55e-10,
    -2.505_076_025_340_686_3e-8,
    2.755_731_370_707_007e-6,
    -1.984_126_982_985_795e-4,
    8.333_333_333_322_49e-3,
    -1.666_666_666_666_663_2e-1,
];
/// The coefficients of `(cos x − 1 + x²/2)/x⁴` in powers of `x²` for `|x| ≤ π/4`, from the highest
/// power.
const COSINE: [f64; 6] = [
    -1.135_964_755_778_819_5e-11,
    2.087_572_321_298_175e-9,
    -2.755_731_435_139_066_3e-7,
    2.480_158_728_947_673e-5,
    -1.388_888_888_887_411e-3,
    4.166_666_666_666_66e-2,
];

type Mask<R> = <<R as Register>::Vector as SimdBase<<R as Register>::Simd>>::Mask;

/// Evaluates a polynomial by Horner's rule.
#[inline(always)]
fn polynomial<R: Register>(coefficients: &[f64; 6], x: R::Vector) -> R::Vector {
    let [first, second, rest @ ..] = coefficients;
    rest.iter().fold(x * *first + *second, |sum, c| sum * x + *c)
}

/// Returns the nearest integer to the number in each lane; the numbers must be far smaller than
/// [`ROUNDING`].
#[inline(always)]
fn rounded<R: Register>(x: R::Vector) -> R::Vector {
    x + ROUNDING - ROUNDING
}

/// Returns a mask of the lanes whose arguments are small enough for an accurate reduction, and the
/// sine and cosine, which are valid in these lanes.
#[inline(always)]
fn reduced<R: Register>(x: R::Vector) -> (Mask<R>, [R::Vector; 2]) {
    let quarters = rounded::<R>(x * std::f64::consts::FRAC_2_PI);
    let r = x - quarters * HALF_PI[0] - quarters * HALF_PI[1];
    let square = r * r;
    let sine = r + r * square * polynomial::<R>(&SINE, square);
    let one = R::Vector::splat(x.token(), 1.0);
    let cosine = one - (square * 0.5 - square * square * polynomial::<R>(&COSINE, square));
    // The quadrant, from −2 to 2; odd quadrants exchange sine and cosine.
    let quadrant = quarters - rounded::<R>(quarters * 0.25) * 4.0;
    let odd = quadrant.abs().simd_eq(1.0);
    let (first, second) = (odd.select(cosine, sine), odd.select(sine, cosine));
    let two = quadrant.abs().simd_eq(2.0);
    let sine_falls = two | quadrant.simd_eq(-1.0);
    let cosine_falls = two | quadrant.simd_eq(1.0);
    let signed = |falls: Mask<R>, value: R::Vector| falls.select(-value, value);
    let found = [signed(sine_falls, first), signed(cosine_falls, second)];
    (x.abs().simd_le(LARGEST), found)
}

impl<R: Register> Lanes<R> {
    /// Computes the sine and cosine in each lane, to about one unit in the last place.
    pub(super) fn circular(self) -> (Self, Self) {
        // The closure is vectorised separately, since compilers do not inline it into a caller.
        let (near, [sine, cosine]) = self.0.token().vectorize(
            #[inline(always)]
            || {
                let (near, found) = reduced::<R>(self.0);
                (if near.all_true() { None } else { Some(near) }, found)
            },
        );
        let Some(near) = near else { return (Lanes(sine), Lanes(cosine)) };
        // Only lanes with large arguments use the scalar functions: no lane depends on the others.
        let far = [f64::sin as fn(f64) -> f64, f64::cos].map(|f| self.map(f).0);
        (Lanes(near.select(sine, far[0])), Lanes(near.select(cosine, far[1])))
    }
}
