//! Smooth curves through points.

/// The largest angle, in radians, by which a drawn curve turns at one of its interpolated points.
const TURN: f64 = 0.05;

/// The angle, in radians: a branch that turns by a larger angle at a point has a corner there.
pub(super) const CORNER: f64 = 1.2;

/// The angle, in radians: a trajectory that turns by a larger angle at a point has a corner there.
pub(super) const SLIGHT: f64 = 0.6;

/// The maximum number of interpolated points between two given points of a curve.
const MOST: f64 = 24.0;

/// Returns a smooth curve through points, with interpolated points where the curve turns. The curve
/// consists of cubic pieces, whose direction at a point lies between the directions of the chords
/// on both sides, nearer to the direction of the shorter chord. The direction at an end of the
/// curve is the end direction of a circular arc. `before` and `after` are the neighbouring points
/// beyond the two ends of the curve. The curve has a corner at each point at which it turns by more
/// than `corner`.
pub(super) fn smooth(
    points: &[[f64; 2]],
    [before, after]: [Option<[f64; 2]>; 2],
    corner: f64,
) -> Vec<[f64; 2]> {
    let mut all: Vec<[f64; 2]> = before.into_iter().collect();
    all.extend(points);
    all.extend(after);
    let all = distinct(&all, [points.first(), points.last()]);
    let mut tangents: Vec<[[f64; 2]; 2]> =
        (0..all.len()).map(|k| tangents(&all, k, corner)).collect();
    let count = all.len();
    if count > 2 {
        tangents[0] = [mirrored(tangents[1][0], sub(all[1], all[0])); 2];
        let chord = sub(all[count - 1], all[count - 2]);
        tangents[count - 1] = [mirrored(tangents[count - 2][1], chord); 2];
    }
    let is_end = |at: [f64; 2], end: Option<&[f64; 2]>| end.is_some_and(|end| *end == at);
    let first = all.iter().position(|at| is_end(*at, points.first())).unwrap_or(0);
    let last = all.iter().rposition(|at| is_end(*at, points.last())).unwrap_or(0);
    let mut drawn: Vec<[f64; 2]> = all.get(first).copied().into_iter().collect();
    for k in first..last {
        let (a, b) = (all[k], all[k + 1]);
        let (from, to) = (tangents[k][1], tangents[k + 1][0]);
        let length = distance(a, b);
        let parts = (angle(from, to).max(angle(from, sub(b, a))) / TURN).ceil().clamp(1.0, MOST);
        let parts = if parts.is_nan() { 1.0 } else { parts };
        for part in 1..=parts as usize {
            let t = part as f64 / parts;
            let (u, v) = (t * t, t * t * t);
            let weights = [2.0 * v - 3.0 * u + 1.0, v - 2.0 * u + t, 3.0 * u - 2.0 * v, v - u];
            let at = |i: usize| {
                let terms = [a[i], length * from[i], b[i], length * to[i]];
                weights.iter().zip(terms).map(|(w, term)| w * term).sum()
            };
            drawn.push(if part as f64 == parts { b } else { [at(0), at(1)] });
        }
    }
    drawn
}

/// The distance below which two points are one point, relative to the extent of the curve: at an
/// event, the states before and after the event may differ by rounding errors, and a refined special
/// point differs from a point on the mesh by the discretisation error. The direction between two such
/// points is meaningless.
const SAME: f64 = 1e-5;

/// Returns the points, except for points that equal the preceding point; the two ends are kept.
fn distinct(points: &[[f64; 2]], ends: [Option<&[f64; 2]>; 2]) -> Vec<[f64; 2]> {
    let [from, to] = [f64::min, f64::max].map(|bound| {
        [0, 1].map(|i| points.iter().map(|at| at[i]).reduce(bound).unwrap_or_default())
    });
    let same = SAME * distance(from, to);
    let mut all: Vec<[f64; 2]> = Vec::new();
    for at in points {
        let is_end = ends.contains(&Some(at));
        match all.last() {
            Some(last) if last == at || distance(*last, *at) <= same && !is_end => {}
            Some(last) if distance(*last, *at) <= same && !ends.contains(&Some(last)) => {
                all.pop();
                all.push(*at);
            }
            _ => all.push(*at),
        }
    }
    all
}

/// Returns the incoming and outgoing directions of a curve at a point, as derivatives with respect
/// to its arc length.
fn tangents(points: &[[f64; 2]], k: usize, corner: f64) -> [[f64; 2]; 2] {
    let chord = |i: usize| {
        let (a, b) = (points.get(i)?, points.get(i + 1)?);
        Some((sub(*b, *a).map(|d| d / distance(*a, *b)), distance(*a, *b)))
    };
    let behind = k.checked_sub(1).and_then(chord);
    match (behind, chord(k)) {
        (None, None) => [[0.0; 2]; 2],
        (Some((only, _)), None) | (None, Some((only, _))) => [only, only],
        (Some((left, _)), Some((right, _))) if angle(left, right) > corner => [left, right],
        (Some((left, a)), Some((right, b))) => {
            let (a, b) = (a.sqrt(), b.sqrt());
            let mean = [0, 1].map(|i| (b * left[i] + a * right[i]) / (a + b));
            let size = mean[0].hypot(mean[1]);
            [mean.map(|m| m / size); 2]
        }
    }
}

/// Mirrors a direction at a chord: if a circular arc over the chord has the given direction at one
/// end of the chord, it has the mirrored direction at the other end.
fn mirrored(direction: [f64; 2], chord: [f64; 2]) -> [f64; 2] {
    let square = chord[0] * chord[0] + chord[1] * chord[1];
    let along = 2.0 * (direction[0] * chord[0] + direction[1] * chord[1]) / square;
    [0, 1].map(|i| along * chord[i] - direction[i])
}

fn sub(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [a[0] - b[0], a[1] - b[1]]
}

fn distance(a: [f64; 2], b: [f64; 2]) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

/// Returns the angle between two directions.
fn angle(a: [f64; 2], b: [f64; 2]) -> f64 {
    (a[0] * b[1] - a[1] * b[0]).atan2(a[0] * b[0] + a[1] * b[1]).abs()
}
