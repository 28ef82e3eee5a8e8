//! Smooth curves between the points of a branch: cubics that interpolate the values and derivatives
//! of two columns.

use crate::core::continuation::{Point, Slopes, SpecialPoint};

/// The largest angle, in radians, by which a drawn cubic turns between two of its vertices; each of
/// the two columns is scaled by the length of its range.
const TURN: f64 = 0.1;

/// The maximum number of segments by which a cubic is approximated.
const MOST: f64 = 16.0;

/// A point of a branch, given by its values and derivatives in two columns.
#[derive(Clone, Copy)]
pub(super) struct Knot {
    values: [f64; 2],
    /// The derivatives of the two columns with respect to the position of the point along the
    /// branch, and this position.
    slopes: Option<([f64; 2], f64)>,
}

impl Knot {
    /// Returns the knot (a point of the curve with its derivatives) for a point of a branch, if the
    /// point has values in both columns.
    pub fn of_point(point: &Point, columns: [usize; 2]) -> Option<Self> {
        let values = [point.value(columns[0])?, point.value(columns[1])?];
        Some(Knot { values, slopes: slopes(point.slopes.as_ref(), columns) })
    }

    /// Returns the knot (a point of the curve with its derivatives) for a special point, if the
    /// point has values in both columns.
    pub fn of_special(point: &SpecialPoint, columns: [usize; 2]) -> Option<Self> {
        let values = [point.value(columns[0])?, point.value(columns[1])?];
        Some(Knot { values, slopes: slopes(point.slopes.as_ref(), columns) })
    }
}

fn slopes(slopes: Option<&Slopes>, columns: [usize; 2]) -> Option<([f64; 2], f64)> {
    let slopes = slopes?;
    let of = |column: usize| slopes.columns.get(column).copied().flatten();
    Some(([of(columns[0])?, of(columns[1])?], slopes.position))
}

/// Returns the vertices of the curve between two successive points of a branch, excluding these two
/// points. The result is empty if derivatives are unknown, or if one of the two columns is not
/// smooth between the points, for example if a maximum jumps to another peak. `ranges` contains the
/// lengths of the ranges of the two columns.
pub(super) fn between(from: &Knot, to: &Knot, ranges: [f64; 2]) -> Vec<[f64; 2]> {
    let (Some((first, begin)), Some((last, end))) = (from.slopes, to.slopes) else {
        return Vec::new();
    };
    let length = end - begin;
    let ends = [0, 1].map(|axis| Axis {
        values: [from.values[axis], to.values[axis]],
        slopes: [length * first[axis], length * last[axis]],
    });
    if !ends.iter().all(Axis::is_smooth) {
        return Vec::new();
    }
    let scaled = |slope: usize| [0, 1].map(|axis| ends[axis].slopes[slope] / ranges[axis]);
    let chord = [0, 1].map(|axis| ends[axis].change() / ranges[axis]);
    let turn = angle(scaled(0), chord).max(angle(chord, scaled(1)));
    let parts = (2.0 * turn / TURN).ceil().clamp(1.0, MOST) as usize;
    let at = |part: usize| [0, 1].map(|axis| ends[axis].at(part as f64 / parts as f64));
    (1..parts).map(at).collect()
}

/// A column between two points of a branch: its values at both points, and its derivatives with
/// respect to the fraction of the way from the first to the second point.
struct Axis {
    values: [f64; 2],
    slopes: [f64; 2],
}

impl Axis {
    fn change(&self) -> f64 {
        self.values[1] - self.values[0]
    }

    /// Returns whether the cubic is a good approximation of the column: whether the third
    /// derivative of the cubic, `h³ f‴`, is small compared with the changes over the step. The test
    /// is necessary because derivatives at both ends do not reveal a jump between them, and because
    /// near a zero of a square root the cubic would leave the range of the two end values.
    fn is_smooth(&self) -> bool {
        let [a, b] = self.slopes;
        let change = self.change();
        (a + b - 2.0 * change).abs() <= 0.5 * a.abs().max(b.abs()).max(change.abs())
    }

    /// Returns the value of the cubic at a fraction of the way from the first to the second point.
    fn at(&self, t: f64) -> f64 {
        let ([a, b], [c, d]) = (self.values, self.slopes);
        let (u, v) = (t * t, t * t * t);
        a + (3.0 * u - 2.0 * v) * (b - a) + (v - 2.0 * u + t) * c + (v - u) * d
    }
}

/// Returns the angle between two directions; 0 if one of the directions is zero.
fn angle(a: [f64; 2], b: [f64; 2]) -> f64 {
    (a[0] * b[1] - a[1] * b[0]).atan2(a[0] * b[0] + a[1] * b[1]).abs()
}
