//! Promise: steps are predicted and measured independently of units, and pairs of events within a
//! step are found.

#[path = "../../src/core/continuation/hermite.rs"]
mod hermite;

use hermite::{Knot, hermite as predicted};
use tangency::core::continuation::{Continuation, Metric, StartSizes};
use tangency::core::problem::Names;
use tangency::core::system::{Dense, Kind};
use tangency::zero_problem;

/// A quintic is its own interpolation through three knots, at any speed along it.
#[test]
fn quintics_are_reproduced() {
    let value = |u: f64| [u, 1.0 - u + 2.0 * u.powi(3) - 0.5 * u.powi(5)];
    let slope = |u: f64| [1.0, -1.0 + 6.0 * u.powi(2) - 2.5 * u.powi(4)];
    let at = [0.0, -0.3, -0.7];
    let (values, slopes) = (at.map(value), at.map(|u| slope(u).map(|s| 3.0 * s)));
    let knots: Vec<Knot> =
        (0..3).map(|k| Knot { u: at[k], x: &values[k], tangent: &slopes[k], speed: 3.0 }).collect();
    let found = predicted(&knots, 0.4);
    let exact = value(0.4);
    assert!((found[0] - exact[0]).abs() < 1e-14 && (found[1] - exact[1]).abs() < 1e-13);
}

#[test]
fn a_change_of_units_scales_the_weights() {
    let names = Names::new([("u", 2), ("v", 1)], ["p"]);
    let metric = |u: f64, p: f64| {
        let start = StartSizes {
            z: &[0.0, 0.0, 3.0],
            z_tangent: &[u, 2.0 * u, 1.0],
            p: &[0.0],
            p_tangent: &[p],
            ..StartSizes::default()
        };
        Metric::new(&names, &start, &[[0.0, 10.0 * p]], &[]).weights(&names)
    };
    let (here, there) = (metric(1.0, 1.0), metric(1e3, 1e-2));
    for (i, factor) in [1e3, 1e3, 1.0, 1e-2].into_iter().enumerate() {
        assert!((here[i] / (there[i] * factor * factor) - 1.0).abs() < 1e-12);
    }
}

zero_problem! {
    /// `u = p` with the monitor `(u − 0.3)²`.
    struct Line [u; p] {
        0 = u - p;
        monitor square = (u - 0.3).powi(2);
    }
}

/// Two crossings of a level within one step, between ends of the same sign.
#[test]
fn a_level_that_is_crossed_twice_in_a_step_is_found_twice() {
    for level in [1e-2_f64, 1e-4, 1e-6] {
        let mut line = Dense::new(Line);
        let branch = Continuation::new(&mut line).along("p", 0.0..=1.0).mark("square", level);
        let branch = branch.trace().unwrap();
        let mut found: Vec<f64> = branch.of_kind(Kind::UZ).map(|mark| mark.state[0]).collect();
        found.sort_by(f64::total_cmp);
        let exact = [0.3 - level.sqrt(), 0.3 + level.sqrt()];
        assert_eq!(found.len(), 2, "{level}: {found:?}");
        assert!(found.iter().zip(exact).all(|(a, b)| (a - b).abs() < 1e-9), "{level}: {found:?}");
    }
}
