//! Hermite interpolation: curves through points with given tangents.

/// A point of an interpolated curve, with its tangent.
pub(super) struct Knot<'a> {
    /// The value of the curve parameter `u` at the point.
    pub u: f64,
    /// The point.
    pub x: &'a [f64],
    /// A tangent.
    pub tangent: &'a [f64],
    /// The derivative `du/ds > 0` of the curve parameter `u` with respect to arclength.
    pub speed: f64,
}

/// Heuristic: the maximal number of knots of one interpolating polynomial. Three knots with their
/// slopes give a polynomial of degree 5. Polynomials of higher degree gain little accuracy, and
/// amplify the errors of corrected points.
pub(super) const MOST_KNOTS: usize = 3;

/// Evaluates the polynomial of degree `2k − 1` through `k` knots with their slopes `dX/du`, at `u`.
pub(super) fn hermite(knots: &[Knot], u: f64) -> Vec<f64> {
    let knots = &knots[..knots.len().min(MOST_KNOTS)];
    let mut point = vec![0.0; knots.first().map_or(0, |knot| knot.x.len())];
    for (k, Knot { x, tangent, speed, .. }) in knots.iter().enumerate() {
        let of_value = interpolated(knots, u, |j| [if j == k { 1.0 } else { 0.0 }, 0.0]);
        let of_slope = interpolated(knots, u, |j| [0.0, if j == k { 1.0 } else { 0.0 }]) / speed;
        for (point, (x, t)) in point.iter_mut().zip(x.iter().zip(*tangent)) {
            *point += of_value * x + of_slope * t;
        }
    }
    point
}

/// Evaluates at `u` the polynomial that has the given values and slopes at the knots, by Newton's
/// divided differences with each knot taken twice.
fn interpolated(knots: &[Knot], u: f64, datum: impl Fn(usize) -> [f64; 2]) -> f64 {
    let count = 2 * knots.len();
    let place = |k: usize| knots[k / 2].u;
    let mut differences = [0.0; 2 * MOST_KNOTS];
    for (k, difference) in differences[..count].iter_mut().enumerate() {
        *difference = datum(k / 2)[0];
    }
    for order in 1..count {
        for k in (order..count).rev() {
            differences[k] = if order == 1 && k % 2 == 1 {
                datum(k / 2)[1]
            } else {
                (differences[k] - differences[k - 1]) / (place(k) - place(k - order))
            };
        }
    }
    (0..count).rev().fold(0.0, |sum, k| sum * (u - place(k)) + differences[k])
}
