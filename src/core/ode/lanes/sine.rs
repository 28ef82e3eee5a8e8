//! Sine and cosine side by side.

use super::{Lanes, Vector};

/// (R) Numbers of this size or less are reduced to rounding: their quarter turns have 16 bits, so
/// that the product with the first part of π/2 is exact.
const LARGEST: f64 = 1e5;
/// Adding this rounds to an integer.
const ROUNDING: f64 = 6_755_399_441_055_744.0;
/// π/2 in two parts, the first of which has 33 bits.
const HALF_PI: [f64; 2] = [1.570_796_326_734_125_6, 6.077_100_506_506_192e-11];
/// `(sin x − x)/x³` in powers of `x²` for `|x| ≤ π/4`, from the highest one on (fdlibm).
const SINE: [f64; 6] = [
    1.589_690_995_211_55e-10,
    -2.505_076_025_340_686_3e-8,
    2.755_731_370_707_007e-6,
    -1.984_126_982_985_795e-4,
    8.333_333_333_322_49e-3,
    -1.666_666_666_666_663_2e-1,
];
/// `(cos x − 1 + x²/2)/x⁴` alike.
const COSINE: [f64; 6] = [
    -1.135_964_755_778_819_5e-11,
    2.087_572_321_298_175e-9,
    -2.755_731_435_139_066_3e-7,
    2.480_158_728_947_673e-5,
    -1.388_888_888_887_411e-3,
    4.166_666_666_666_66e-2,
];

/// A polynomial by Horner's rule.
#[inline(always)]
fn polynomial(coefficients: &[f64; 6], x: Vector) -> Vector {
    let [first, rest @ ..] = coefficients;
    rest.iter().fold(Vector::splat(*first), |sum, c| sum * x + Vector::splat(*c))
}

/// The nearest integer, for numbers far below [`ROUNDING`].
#[inline(always)]
fn rounded(x: Vector) -> Vector {
    x + Vector::splat(ROUNDING) - Vector::splat(ROUNDING)
}

impl Lanes {
    /// Sine and cosine, to about one unit in the last place.
    #[inline(always)]
    pub(super) fn circular(self) -> (Self, Self) {
        let Lanes(x) = self;
        let quarters = rounded(x * Vector::splat(std::f64::consts::FRAC_2_PI));
        let r = x - quarters * Vector::splat(HALF_PI[0]) - quarters * Vector::splat(HALF_PI[1]);
        let square = r * r;
        let sine = r + r * square * polynomial(&SINE, square);
        let half = square * Vector::splat(0.5);
        let cosine = Vector::ONE - (half - square * square * polynomial(&COSINE, square));
        // The quadrant, from −2 to 2: odd ones exchange sine and cosine.
        let quadrant = quarters - Vector::splat(4.0) * rounded(quarters * Vector::splat(0.25));
        let odd = quadrant.abs().simd_eq(Vector::ONE);
        let (first, second) = (odd.select(cosine, sine), odd.select(sine, cosine));
        let two = quadrant.abs().simd_eq(Vector::splat(2.0));
        let sine_falls = two | quadrant.simd_eq(Vector::splat(-1.0));
        let cosine_falls = two | quadrant.simd_eq(Vector::ONE);
        let signed = |falls: Vector, value: Vector| falls.select(-value, value);
        let found = [signed(sine_falls, first), signed(cosine_falls, second)];
        let near = x.abs().simd_le(Vector::splat(LARGEST));
        if near.all() {
            return (Lanes(found[0]), Lanes(found[1]));
        }
        // Only in the lanes that need it: what a lane holds does not depend on the others.
        let [sine, cosine] = [f64::sin as fn(f64) -> f64, f64::cos].map(|f| self.map(f).0);
        (Lanes(near.select(found[0], sine)), Lanes(near.select(found[1], cosine)))
    }
}
