//! Promise: drawn curves are smooth, and have no kinks that the data do not have.

#[allow(dead_code)]
#[path = "../../src/output/drawing/smooth.rs"]
mod drawing;

use drawing::{SLIGHT, smooth};

/// Two states at one event, apart by a rounding error in any direction, leave a straight line
/// straight. The same holds for a refined special point beside the first point of a branch.
#[test]
fn a_repeated_point_does_not_turn_the_curve() {
    for (k, error) in
        [(5, [0.0, 1e-13]), (5, [-1e-13, 1e-13]), (5, [0.0, -2e-13]), (1, [0.0, 1e-6])]
    {
        let mut points: Vec<[f64; 2]> = (0..10).map(|k| [k as f64, 0.5 * k as f64]).collect();
        let at = (k - 1) as f64;
        points.insert(k, [at + error[0], 0.5 * at + error[1]]);
        for [x, y] in smooth(&points, [None, None], SLIGHT) {
            assert!((y - 0.5 * x).abs() < 1e-9, "({x}, {y})");
        }
    }
}
