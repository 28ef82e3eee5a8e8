//! Curves of sliding bifurcations in the library's scenes against motion by hand: at marked points
//! of each, motion that is stepped with fields, normal velocities and sliding from paper comes back
//! after a period, and is just where the bifurcation is.

use super::library::{executed, scene};
use crate::common::settling::middle;
use crate::hybrid::systems::sliding::{ByHand, Mark, Sliding, on_belt};
use tangency::core::continuation::Branch;
use tangency::core::hybrid::filippov::Filippov;
use tangency::core::system::Kind;
use tangency::output::Document;

/// Motion comes back, and is at the bifurcation, but for this.
const ERROR: f64 = 1e-8;

/// What a scene finds with marks at values of a parameter along its curves.
fn marked(name: &str, parameter: &str, values: &[f64]) -> Document {
    let mut scene = scene(name);
    for run in scene.runs.iter_mut().filter(|run| run.hold.is_some()) {
        run.marks = values.iter().map(|value| (parameter.to_string(), *value)).collect();
    }
    executed(&scene)
}

/// Compares the marked points of a curve, of which there are at least so many, with motion by hand
/// in their parameters: it closes, and the least size of what a mark shows is zero.
#[track_caller]
fn agrees<'a>(
    system: Sliding,
    branch: &Branch,
    least: usize,
    motion: impl Fn(&[f64], &mut dyn FnMut(ByHand)) + 'a,
    shown: impl Fn(&ByHand, &[f64], Mark, f64, &[f64; 3]) -> Option<f64>,
) {
    let points: Vec<_> = branch.of_kind(Kind::UZ).collect();
    assert!(points.len() >= least, "{}: {}", branch.name, points.len());
    for point in points {
        let p = &point.parameters;
        let (start, period) = middle(&Filippov(system), branch, point);
        let mut x = [0.0; 3];
        x[..start.x.len()].copy_from_slice(&start.x);
        motion(p, &mut |motion| {
            let mut zero = f64::INFINITY;
            let miss = motion.miss((start.mode, start.time, x), period, |mark, t, x| {
                zero = zero.min(shown(&motion, p, mark, t, x).map_or(f64::INFINITY, f64::abs));
            });
            assert!(miss < ERROR, "{} at {p:?}: {miss:.1e} from where it was", branch.name);
            assert!(zero < ERROR, "{} at {p:?}: {zero:.1e} from the bifurcation", branch.name);
        });
    }
}

/// The margin by which motion that reaches the surface crosses it, or slides.
fn margin(motion: &ByHand, mark: Mark, t: f64, x: &[f64; 3]) -> Option<f64> {
    match mark {
        Mark::Arrival(from) if from < 2 => Some((motion.normal)(t, x)[1 - from]),
        _ => None,
    }
}

/// Where `ζ`, `ω` and `λ` vary, and `σ = −1`, `ρ = 1`: sliding keeps `u = −y`.
fn relay(p: &[f64], with: &mut dyn FnMut(ByHand)) {
    let (zeta, omega, lambda) = (p[0], p[1], p[2]);
    let square = omega * omega;
    let field = move |mode: usize, _t: f64, x: &[f64; 3]| {
        let u = [-1.0, 1.0, -x[1]][mode];
        let slope = if mode == 2 { 0.0 } else { x[1] - (2.0 * zeta * omega + lambda) * x[0] + u };
        let feedback = 2.0 * zeta * omega * lambda + square;
        [slope, x[2] - feedback * x[0] - 2.0 * u, u - lambda * square * x[0]]
    };
    with(ByHand {
        field: &field,
        surface: &|x| x[0],
        normal: &|_, x| [x[1] - 1.0, x[1] + 1.0],
        probe: &|_, _, _| None,
        step: 5e-4,
    });
}

#[test]
fn relay_in_frequency_and_damping() {
    let document = marked("relay", "zeta", &[0.01, 0.02, 0.03, 0.04, 0.07, 0.1]);
    let curve = document.branch("crossing-sliding").unwrap();
    agrees(Sliding::Relay, curve, 5, relay, |motion, _, mark, t, x| margin(motion, mark, t, x));
}

/// The mass on a belt, by frequency and force.
fn belt(p: &[f64], with: &mut dyn FnMut(ByHand)) {
    on_belt([p[0], p[1]], with);
}

#[test]
fn belt_in_frequency_and_force() {
    let document = marked("belt", "A", &[2.2, 2.6, 3.1, 3.4, 3.7, 4.0]);
    let branch = |name: &str| document.branch(name).unwrap();
    let touch = |_: &ByHand, _: &[f64], mark: Mark, _: f64, x: &[f64; 3]| {
        matches!(mark, Mark::Probe).then(|| 1.0 - x[1])
    };
    agrees(Sliding::Friction, branch("grazing-sliding"), 5, belt, touch);
    for name in ["switching-sliding", "crossing-sliding"] {
        agrees(Sliding::Friction, branch(name), 5, belt, |motion, _, mark, t, x| {
            margin(motion, mark, t, x)
        });
    }
    // The force that turns is as large as friction.
    let held = |_: &ByHand, p: &[f64], mark: Mark, t: f64, x: &[f64; 3]| {
        matches!(mark, Mark::Probe).then(|| (p[1] * (p[0] * t).cos() - x[0]).abs() - 1.5)
    };
    agrees(Sliding::Friction, branch("adding-sliding"), 5, belt, held);
}

/// Chua's circuit, `h = E − x`, whose voltage is held at `E`.
fn chua(p: &[f64], with: &mut dyn FnMut(ByHand)) {
    let (alpha, limit) = (p[0], p[2]);
    let rate = move |x: &[f64; 3]| alpha * (x[1] + x[0] / 7.0 - x[0].powi(3) * 4.0 / 63.0);
    let field = move |mode: usize, _t: f64, x: &[f64; 3]| {
        let voltage = [rate(x), rate(x) - 0.5 * alpha, 0.0][mode];
        [voltage, x[0] - x[1] + x[2], -14.0 * x[1]]
    };
    with(ByHand {
        field: &field,
        surface: &|x| limit - x[0],
        normal: &|_, x| [-rate(x), 0.5 * alpha - rate(x)],
        probe: &|mode, _, x| (mode == 0).then(|| rate(x)),
        step: 5e-4,
    });
}

#[test]
fn chua_in_capacity_and_voltage() {
    let document = marked("chua-sliding", "E", &[1.6, 1.65, 1.7, 1.75, 1.85, 1.9]);
    let mut curve = document.branch("grazing-sliding").unwrap().clone();
    for (own, general) in [("clamped", "sliding"), ("clamp", "surface"), ("free", "above")] {
        curve.itinerary = curve.itinerary.replace(own, general);
    }
    agrees(Sliding::Chua, &curve, 5, chua, |_, p, mark, _, x| {
        matches!(mark, Mark::Probe).then(|| p[2] - x[0])
    });
}
