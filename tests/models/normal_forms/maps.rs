//! Promise: the normal forms and resonances of fixed points of `(x, y) → (y, α − β x − y² + R x y)`,
//! `R = ½`, which are known in closed form.

use super::{at, coefficient, model, range, traced};
use crate::common::close;
use tangency::core::system::Kind;
use tangency::output::Document;
use tangency::scene::Request;

fn curve(kind: Kind, first: &str, al: [f64; 2], be: [f64; 2], start: (f64, f64, f64)) -> Document {
    let ranges = [range("al", al[0], al[1]), range("be", be[0], be[1])];
    let mut along = ranges.to_vec();
    if first == "be" {
        along.reverse();
    }
    let (value_al, value_be, x) = start;
    let set = vec![("al".into(), value_al.to_string()), ("be".into(), value_be.to_string())];
    let state = vec![("x".into(), x), ("y".into(), x)];
    let request = Request { set, along, state, hold: Some(kind), ..Request::default() };
    traced(model("pulsed-map"), &request)
}

/// The map with multiplier −1: `ξ → −ξ + b ξ³` with `b = −c`.
#[test]
fn period_doublings_and_torus_points_of_a_map() {
    let document = curve(Kind::PD, "al", [-0.4, 5.0], [-3.0, 3.0], (0.2, 0.6, 0.1));
    let doubling = at(&document.branches[0], Kind::PD, "al", 1.6, 1e-12);
    coefficient(doubling, "doubling_c", -0.78125, 1e-9);
    let document = curve(Kind::TR, "be", [-2.0, 5.0], [0.2, 2.0], (0.5625, 0.2, 0.3));
    let torus = at(&document.branches[0], Kind::TR, "be", 1.125, 1e-12);
    coefficient(torus, "torus_d_re", 1.0 / 38.0, 1e-9);
    coefficient(torus, "torus_d_im", 0.163089831352, 1e-9);
    assert_eq!(torus.subkind.as_deref(), Some("subcritical"));
}

#[test]
fn all_strong_resonances_of_a_map() {
    let document = curve(Kind::TR, "be", [-2.0, 5.0], [0.2, 2.0], (0.5625, 0.2, 0.3));
    let torus = document.branches.last().unwrap();
    for (kind, al, be, angle) in [
        (Kind::R1, -8.0 / 9.0, 1.0 / 3.0, 0.0),
        (Kind::R2, 40.0 / 9.0, 5.0 / 3.0, std::f64::consts::PI),
        (Kind::R3, 16.0 / 9.0, 4.0 / 3.0, 2.0 * std::f64::consts::PI / 3.0),
        (Kind::R4, 0.0, 1.0, 0.5 * std::f64::consts::PI),
    ] {
        let point = at(torus, kind, "al", al, 1e-12);
        close(point.parameters[1], be, 1e-12);
        close(*point.monitors.last().unwrap(), angle, 1e-15);
        assert!(point.error < 1e-13);
    }
    // The same from the curves of folds and period doublings, with the fold–flip at (0, −1).
    let doublings = curve(Kind::PD, "al", [-0.4, 5.0], [-3.0, 3.0], (0.2, 0.6, 0.1));
    let doublings = doublings.branches.last().unwrap();
    at(doublings, Kind::R2, "al", 40.0 / 9.0, 1e-12);
    at(doublings, Kind::LPPD, "al", 0.0, 1e-12);
    assert_eq!(doublings.of_kind(Kind::GPD).count(), 0, "poles are no zeros");
    let folds = curve(Kind::LP, "al", [-2.0, 5.0], [-3.0, 3.0], (0.2, 0.6, 0.1));
    let folds = folds.branches.last().unwrap();
    at(folds, Kind::R1, "al", -8.0 / 9.0, 1e-12);
    at(folds, Kind::LPPD, "al", 0.0, 1e-12);
}
