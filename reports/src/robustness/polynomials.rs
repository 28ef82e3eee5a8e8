//! Robustness map of the plates' shape functions, evaluated by powers and by recurrence, in single
//! (7 digits) and double precision (16 digits).

use super::grid::{Found, Panel, from_to, map};
use crate::RobustnessMap;
use num_traits::Float;
use std::f64::consts::PI;
use tangency::problems::plate::Support;
use tangency::problems::plate::basis::Basis;

/// Converts a small integer or a double-precision number to another type.
fn number<T: Float>(value: f64) -> T {
    T::from(value).unwrap_or_else(T::nan)
}

/// Evaluates the shape function `f_r = Σ (−1)ⁿ (2r−2n−7)!!/(2ⁿ n! (r−2n−1)!) ξ^{r−2n−1}`, `r > 4`
/// (N. S. Bardell, 1991), as a sum of powers of `ξ`.
fn in_powers<T: Float>(order: usize, xi: T) -> T {
    let product = |to: usize, stride: usize| {
        (1..=to).rev().step_by(stride).fold(T::one(), |product, v| product * number(v as f64))
    };
    let term = |n: usize| {
        let power = order - 2 * n - 1;
        let sign = if n.is_multiple_of(2) { T::one() } else { -T::one() };
        let below = number::<T>(2.0).powi(n as i32) * product(n, 1);
        // The ratio is formed factor by factor, because the factorials exceed the range of 7-digit
        // numbers.
        let above = (2 * order - 2 * n).saturating_sub(7);
        let odd = (1..=above).rev().step_by(2).map(|v| v as f64);
        let all = (1..=power).rev().map(|v| v as f64);
        sign * ratio::<T>(odd, all) * xi.powi(power as i32) / below
    };
    (0..=(order - 1) / 2).fold(T::zero(), |sum, n| sum + term(n))
}

/// Divides one product of factors by another, factor by factor.
fn ratio<T: Float>(above: impl Iterator<Item = f64>, below: impl Iterator<Item = f64>) -> T {
    let (mut above, mut below) = (above.fuse(), below.fuse());
    let mut value = T::one();
    loop {
        match (above.next(), below.next()) {
            (None, None) => return value,
            (a, b) => value = value * number(a.unwrap_or(1.0)) / number(b.unwrap_or(1.0)),
        }
    }
}

/// Evaluates the shape function `f_r` from three Legendre polynomials: with `n = r − 3`,
/// `P_{n+2}/((2n+1)(2n+3)) − 2 P_n/((2n−1)(2n+3)) + P_{n−2}/((2n−1)(2n+1))`.
fn from_legendre<T: Float>(order: usize, polynomial: impl Fn(usize) -> T) -> T {
    let n = order - 3;
    let k: T = number(n as f64);
    let (one, two, three) = (T::one(), number::<T>(2.0), number::<T>(3.0));
    let (low, middle, high) = (two * k - one, two * k + one, two * k + three);
    polynomial(n + 2) / (middle * high) - two * polynomial(n) / (low * high)
        + polynomial(n - 2) / (low * middle)
}

/// Evaluates Legendre polynomials by the recurrence `k P_k = (2k − 1) ξ P_{k−1} − (k − 1) P_{k−2}`.
fn by_recurrence<T: Float>(order: usize, xi: T) -> T {
    let mut values = vec![T::one(), xi];
    for k in 2..=order {
        let [a, b, c] = [2 * k - 1, k - 1, k].map(|v| number::<T>(v as f64));
        values.push((a * xi * values[k - 1] - b * values[k - 2]) / c);
    }
    from_legendre(order, |n| values[n])
}

/// Evaluates a Legendre polynomial by Laplace's integral, `P_n(ξ) = 1/π ∫₀^π (ξ + i √(1 − ξ²) cos
/// φ)ⁿ dφ`, which equals the mean of the integrand over `n` or more equidistant angles. No power in
/// Laplace's sum exceeds 1 in modulus, so the sum loses no digits.
fn exact(order: usize, xi: f64) -> f64 {
    let legendre = |n: usize| {
        let parts = n + 2;
        let angle = |k: usize| (k as f64 + 0.5) * PI / parts as f64;
        let term = |k: usize| {
            let imaginary = (1.0 - xi * xi).sqrt() * angle(k).cos();
            xi.hypot(imaginary).powi(n as i32) * (imaginary.atan2(xi) * n as f64).cos()
        };
        (0..parts).map(term).sum::<f64>() / parts as f64
    };
    from_legendre(order, legendre)
}

/// Classifies the number of digits that the evaluation of a shape function of a given order loses,
/// relative to the function's largest value.
fn judged(order: usize, digits: f64, value: impl Fn(f64) -> f64) -> Found {
    let grid = || (-100..=100).map(|i| f64::from(i) / 100.0);
    let size = grid().map(|xi| exact(order, xi).abs()).fold(0.0, f64::max);
    let worse = |a: f64, b: f64| if b.is_nan() { b } else { a.max(b) };
    let miss = grid().map(|xi| (value(xi) - exact(order, xi)).abs()).fold(0.0, worse) / size;
    let left = -miss.log10();
    match left / digits {
        share if share.is_nan() => Found::silent("no number"),
        ..0.1 => Found::silent("no digit left"),
        0.1..0.5 => Found::silent("less than half of the digits"),
        0.5..0.8 => Found::silent("less than four fifths of the digits"),
        _ => Found::right("four fifths of the digits, or more"),
    }
}

/// Computes one panel.
pub(super) fn draw() -> RobustnessMap {
    let orders = from_to(5.0, 60.0, 56);
    let basis = Basis::transverse([Support::Clamped; 2], false, 56);
    // f_r" = P_{r−3}; the basis scales it by √(r − 5/2).
    let of_plates = |r: usize, xi: f64| basis.at(xi)[r - 5][0] / (r as f64 - 2.5).sqrt();
    let single = -f64::from(f32::EPSILON).log10();
    let double = -f64::EPSILON.log10();
    let panel = Panel::new("Bardell's polynomials", "order", "sum")
        .row(("powers, 7 digits", true), &orders, |r| {
            judged(r as usize, single, |xi| in_powers::<f32>(r as usize, xi as f32).into())
        })
        .row(("powers, 16 digits", true), &orders, |r| {
            judged(r as usize, double, |xi| in_powers(r as usize, xi))
        })
        .row(("recurrence, 7 digits", true), &orders, |r| {
            judged(r as usize, single, |xi| by_recurrence::<f32>(r as usize, xi as f32).into())
        })
        .row(("functions of plates", false), &orders, |r| {
            judged(r as usize, double, |xi| of_plates(r as usize, xi))
        });
    map("polynomials", vec![panel])
}
