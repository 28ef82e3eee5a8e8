//! Promise: torus points of orbits with impacts are where closed forms have them, and there are
//! none where the product of the multipliers forbids them.

use crate::common::close;
use crate::hybrid::systems::impact_oscillator::ClosedForm;
use crate::hybrid::systems::orbits::{DIGITS, found, impacting};
use std::f64::consts::PI;
use tangency::core::continuation::{Continuation, Settings};
use tangency::core::system::Kind;

/// The negative damping `c = (ω/π) ln e` at which the product of the multipliers, `e² e^{−cT}`,
/// is 1.
fn critical(frequency: f64, restitution: f64) -> f64 {
    frequency / PI * restitution.ln()
}

/// The impact's speed near `u` at which the orbit has an amplitude of forcing, by the secant
/// method.
fn speed(form: &ClosedForm, amplitude: f64, u: f64) -> f64 {
    let [mut a, mut b] = [u, 1.01 * u];
    for _ in 0..20 {
        let [fa, fb] = [a, b].map(|u| form.amplitude(u) - amplitude);
        if fa == fb {
            break;
        }
        (a, b) = (b, b - fb * (b - a) / (fb - fa));
    }
    b
}

/// The damping at a torus point and the angle of the multipliers there, by both methods; and the
/// curve of torus points in damping and frequency.
#[test]
fn torus_points_are_exact() {
    let (frequency, restitution, u) = (2.2, 0.8, 1.5);
    let c = critical(frequency, restitution);
    let beside = ClosedForm::new(frequency, restitution, c + 0.03, 1.0);
    let form = ClosedForm::new(frequency, restitution, c, 1.0);
    let angle = (0.5 * form.trace(speed(&form, beside.amplitude(u), u))).acos();
    for mut start in impacting(&beside, u) {
        let branch = start.along("damping", [c - 0.02, c + 0.04]).trace().unwrap();
        assert_eq!(found(&branch).len(), 1, "{:?}", found(&branch));
        let torus = branch.of_kind(Kind::TR).next().unwrap();
        close(torus.value(branch.column("damping").unwrap()).unwrap(), c, DIGITS);
        let recorded = torus.number("torus_angle").unwrap().value;
        close(recorded, angle, 1e-9);
        let label = torus.label;
        let run = Continuation::new(start.system.as_mut()).restart(&branch, label).hold(Kind::TR);
        let run = run.along("damping", -1.0..=0.0).along("frequency", 2.1..=2.3);
        let curve = run.trace().unwrap();
        let [damping, frequency] = ["damping", "frequency"].map(|name| curve.column(name).unwrap());
        assert!(curve.points.len() > 4);
        for point in &curve.points {
            let expected = critical(point.value(frequency).unwrap(), restitution);
            close(point.value(damping).unwrap(), expected, DIGITS);
        }
    }
}

/// With damping the product of the multipliers is less than 1, at ω = 2 it is 0.467: no torus
/// point, whatever the steps.
#[test]
fn no_torus_point_where_multipliers_forbid_it() {
    for frequency in [0.9, 1.4, 1.8, 2.0, 2.5] {
        let form = ClosedForm::usual(frequency);
        for max_step in [0.005, 0.02, 0.1, 0.25] {
            for mut start in impacting(&form, 1.0) {
                let settings = Settings { max_step, ..Settings::default() };
                let run = start.along("amplitude", [0.0, 10.0]).settings(settings);
                let branch = run.trace().unwrap();
                let kinds = [Kind::TR, Kind::ND].map(|kind| branch.of_kind(kind).count());
                assert_eq!(kinds, [0, 0], "ω = {frequency}, {max_step}: {:?}", found(&branch));
            }
        }
    }
}
