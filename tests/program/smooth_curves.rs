//! Promise: drawn curves are smooth, and have no kinks that the data do not have.

#[allow(dead_code)]
#[path = "../../src/output/drawing/smooth.rs"]
mod drawing;

use drawing::{SLIGHT, smooth};

/// Two states at one event, apart by a rounding error in any direction, leave a straight line
/// straight.
#[test]
fn a_repeated_point_does_not_turn_the_curve() {
    for error in [[0.0, 1e-13], [-1e-13, 1e-13], [0.0, -2e-13]] {
        let mut points: Vec<[f64; 2]> = (0..10).map(|k| [k as f64, 0.5 * k as f64]).collect();
        points.insert(5, [4.0 + error[0], 2.0 + error[1]]);
        for [x, y] in smooth(&points, [None, None], SLIGHT) {
            assert!((y - 0.5 * x).abs() < 1e-9, "({x}, {y})");
        }
    }
}
