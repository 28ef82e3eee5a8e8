//! Stable and unstable manifolds of saddles of maps in the plane.

use crate::common::close;
use crate::orbits::map_cycles::Henon;
use std::sync::Arc;
use tangency::core::continuation::End;
use tangency::core::manifold::{Half, Manifold, ManifoldError, ManifoldSettings, Side, manifold};
use tangency::core::problem::{DiscreteMap, Names};
use tangency::core::scalar::Scalar;

/// A map as one function, generic over scalars.
macro_rules! plane_map {
    ($(#[$meta:meta])* $name:ident, |$x:ident, $y:ident, $p:ident| $next:expr) => {
        $(#[$meta])*
        struct $name;
        impl DiscreteMap for $name {
            fn names(&self) -> Names {
                Names::new(["x", "y"], ["a", "b"])
            }
            fn next<T: Scalar>(&self, x: &[T], $p: &[T], next: &mut [T]) {
                let ($x, $y) = (x[0], x[1]);
                next.copy_from_slice(&$next);
            }
        }
    };
}

fn both<M: DiscreteMap + 'static>(
    map: M,
    start: &[f64],
    p: &[f64],
    settings: &ManifoldSettings,
) -> Result<[Vec<Manifold>; 2], ManifoldError> {
    let map = Arc::new(map);
    let of = |side| manifold(&map, start, p, side, settings);
    Ok([of(Side::Unstable)?, of(Side::Stable)?])
}

/// The distance of a point from a chain of chords.
fn distance(at: [f64; 2], chain: &[[f64; 2]]) -> f64 {
    let from_chord = |pair: &[[f64; 2]]| {
        let (a, b) = (pair[0], pair[1]);
        let (d, e) = ([b[0] - a[0], b[1] - a[1]], [at[0] - a[0], at[1] - a[1]]);
        let along = (d[0] * e[0] + d[1] * e[1]) / (d[0] * d[0] + d[1] * d[1]);
        let along = if along.is_nan() { 0.0 } else { along.clamp(0.0, 1.0) };
        (e[0] - along * d[0]).hypot(e[1] - along * d[1])
    };
    chain.windows(2).map(from_chord).fold(f64::INFINITY, f64::min)
}

/// A half from the saddle on.
fn chain(of: &Manifold, half: &Half) -> Vec<[f64; 2]> {
    [of.saddle].into_iter().chain(half.points.iter().map(|point| point.at)).collect()
}

/// A change of coordinates with a polynomial inverse: `(u, v) ↦ (X, v + X³/2 − X²)`, `X = u + v²/2`.
fn bent<T: Scalar>([u, v]: [T; 2]) -> [T; 2] {
    let x = u + v * v * 0.5;
    [x, v + x * x * x * 0.5 - x * x]
}

fn straight<T: Scalar>([x, y]: [T; 2]) -> [T; 2] {
    let v = y - x * x * x * 0.5 + x * x;
    [x - v * v * 0.5, v]
}

/// The linear map with the multipliers `a` and `b` in bent coordinates.
struct Bent;

impl DiscreteMap for Bent {
    fn names(&self) -> Names {
        Names::new(["x", "y"], ["a", "b"])
    }
    fn next<T: Scalar>(&self, x: &[T], p: &[T], next: &mut [T]) {
        let [u, v] = straight([x[0], x[1]]);
        next.copy_from_slice(&bent([u * p[0], v * p[1]]));
    }
}

/// `W^u` is the image of the line `v = 0`, `W^s` the image of `u = 0`, whatever the signs of the
/// multipliers.
#[test]
fn manifolds_of_a_conjugate_of_a_linear_map_are_exact() {
    let settings = ManifoldSettings { length: 6.0, ..ManifoldSettings::default() };
    for p in [[2.5, 0.4], [-1.3, 0.7], [3.0, -0.2], [-2.0, -0.6], [1.01, 0.98]] {
        let found = both(Bent, &[0.01, 0.02], &p, &settings).unwrap();
        for (curves, (axis, multiplier)) in found.iter().zip([(1, p[0]), (0, p[1])]) {
            let [curve] = &curves[..] else { panic!("one curve") };
            close(curve.multiplier, multiplier, 1e-13);
            assert!(curve.local_error <= 1e-12, "{:.1e}", curve.local_error);
            assert_eq!(curve.iterates, if multiplier < 0.0 { 2 } else { 1 });
            for half in &curve.halves {
                let end = End::MonitorBound { name: "arclength".into(), value: 6.0 };
                assert_eq!(half.end, end, "{p:?}");
                close(half.length(), 6.0, 1e-9);
                let apart = half.points.iter().map(|point| straight(point.at)[axis].abs());
                let apart = apart.fold(0.0, f64::max);
                assert!(apart <= 1e-11, "{p:?}: {apart:.1e}");
                let deviation = half.deviation.unwrap();
                assert!(deviation <= settings.resolution, "{p:?}: {deviation:.1e}");
            }
        }
    }
}

/// The exact curve, `y = x³/2 − x²` on `W^u`, has the same arclength, by a sum of a million chords.
#[test]
fn arclength_is_that_of_the_curve() {
    let settings = ManifoldSettings { length: 4.0, ..ManifoldSettings::default() };
    let curves = manifold(&Arc::new(Bent), &[0.0, 0.0], &[2.0, 0.5], Side::Unstable, &settings);
    for half in &curves.unwrap()[0].halves {
        let end = half.points.last().unwrap().at[0];
        let y = |k: usize| {
            let x = end * k as f64 / 1e6;
            x * x * x * 0.5 - x * x
        };
        let chords = (0..1_000_000).map(|k| (end / 1e6).hypot(y(k + 1) - y(k)));
        close(chords.sum::<f64>(), 4.0, 1e-6);
    }
}

/// The halves of the unstable manifold of Hénon's map, whose multiplier is negative, are images of
/// each other, and the stated deviation is what the images of points show.
#[test]
fn the_unstable_manifold_of_henons_map_is_invariant() {
    let settings = ManifoldSettings { length: 15.0, ..ManifoldSettings::default() };
    let p = [1.4, 0.3];
    let curves = manifold(&Arc::new(Henon), &[0.6, 0.2], &p, Side::Unstable, &settings).unwrap();
    let curve = &curves[0];
    let x = (-0.7 + (0.49_f64 + 5.6).sqrt()) / 2.8;
    close(curve.saddle[0], x, 1e-14);
    close(curve.saddle[1], 0.3 * x, 1e-14);
    close(curve.multiplier, -1.4 * x - ((1.4 * x).powi(2) + 0.3).sqrt(), 1e-13);
    assert_eq!(curve.iterates, 2);
    for (k, half) in curve.halves.iter().enumerate() {
        assert!(half.deviation.unwrap() <= settings.resolution, "{:?}", half.deviation);
        // An iterate stretches the curve by its multiplier, more or less.
        let other = chain(curve, &curve.halves[1 - k]);
        for point in half.points.iter().step_by(7).filter(|point| point.arclength < 4.0) {
            let mut image = [0.0; 2];
            Henon.next(&point.at, &p, &mut image);
            let apart = distance(image, &other);
            assert!(apart <= 2.0 * settings.resolution, "{:?} is {apart:.1e} away", point.at);
        }
    }
}

plane_map! {
    /// An area-preserving map of Hénon's, `(x, y) ↦ (y, −x + 3y − y²)`: with the reversor `R(x, y) =
    /// (y, x)` its inverse is `R f R`. The origin is a saddle with the multipliers `(3 ± √5)/2`.
    Reversible, |x, y, p| [y, -x + y * 3.0 - y * y * p[0]]
}

/// The stable manifold, by preimages, is the mirror image of the unstable one, by images.
#[test]
fn the_reversor_takes_one_manifold_to_the_other() {
    let settings = ManifoldSettings { length: 12.0, ..ManifoldSettings::default() };
    let [unstable, stable] = both(Reversible, &[0.0, 0.0], &[1.0, 0.0], &settings).unwrap();
    let (unstable, stable) = (&unstable[0], &stable[0]);
    close(unstable.multiplier, 0.5 * (3.0 + 5.0_f64.sqrt()), 1e-13);
    close(stable.multiplier, 0.5 * (3.0 - 5.0_f64.sqrt()), 1e-13);
    for k in 0..2 {
        let [u, s] = [&unstable.halves[k], &stable.halves[k]];
        let mirror = |at: [f64; 2]| [at[1], at[0]];
        let [a, b] = [u, s].map(|half| half.points.last().unwrap().at);
        close(a[0], mirror(b)[0], 1e-7);
        close(a[1], mirror(b)[1], 1e-7);
        let all = chain(unstable, u);
        for point in s.points.iter().step_by(5) {
            let apart = distance(mirror(point.at), &all);
            assert!(apart <= settings.resolution, "{:?}: {apart:.1e}", point.at);
        }
    }
}

/// Where the unstable manifold crosses the line `x = y` of fixed points of the reversor there are
/// homoclinic points. They are also found by iterates of a short piece of the eigenvector, with
/// bisection.
#[test]
fn homoclinic_points_are_those_of_iterates() {
    let settings = ManifoldSettings {
        length: 18.0,
        resolution: 1e-6,
        max_points: 200_000,
        ..ManifoldSettings::default()
    };
    let curves =
        manifold(&Arc::new(Reversible), &[0.0, 0.0], &[1.0, 0.0], Side::Unstable, &settings);
    let half = &curves.unwrap()[0].halves[1];
    let points: Vec<[f64; 2]> = half.points.iter().map(|point| point.at).collect();
    let found: Vec<f64> = points
        .windows(2)
        .filter(|pair| (pair[0][0] - pair[0][1]) * (pair[1][0] - pair[1][1]) < 0.0)
        .map(|pair| {
            let [a, b] = [pair[0], pair[1]].map(|at| at[0] - at[1]);
            pair[0][0] + a / (a - b) * (pair[1][0] - pair[0][0])
        })
        .collect();
    assert_eq!(found.len(), 8, "{found:?}");
    // A point at 1e-7 of the saddle is within 1e-14 of the curve.
    let lambda = 0.5 * (3.0 + 5.0_f64.sqrt());
    let size = 1.0_f64.hypot(lambda);
    let at = |exponent: f64| {
        let iterates = exponent.floor();
        let s = 1e-7 * lambda.powf(exponent - iterates) / size;
        let mut x = [s, s * lambda];
        for _ in 0..iterates as usize {
            let mut next = [0.0; 2];
            Reversible.next(&x, &[1.0, 0.0], &mut next);
            x = next;
        }
        x
    };
    let side = |exponent: f64| at(exponent)[0] - at(exponent)[1];
    let (mut expected, samples) = (Vec::new(), 100_000);
    let mut length = 0.0;
    for k in 0..samples {
        let [mut low, mut high] = [k, k + 1].map(|k| 28.0 * k as f64 / samples as f64);
        let (a, b) = (at(low), at(high));
        length += (b[0] - a[0]).hypot(b[1] - a[1]);
        if length > 18.0 {
            break;
        }
        if side(low) * side(high) < 0.0 {
            for _ in 0..50 {
                let middle = 0.5 * (low + high);
                if side(low) * side(middle) > 0.0 { low = middle } else { high = middle }
            }
            expected.push(at(low)[0]);
        }
    }
    assert_eq!(found.len(), expected.len(), "{found:?}, {expected:?}");
    for (found, expected) in found.iter().zip(expected) {
        close(*found, expected, 10.0 * settings.resolution);
    }
}

/// The cycle of two iterates of Hénon's map has a curve at each of its points, and the map takes one
/// to the other.
#[test]
fn each_point_of_a_cycle_has_a_manifold() {
    let settings = ManifoldSettings { length: 8.0, ..ManifoldSettings::default() };
    let p = [1.4, 0.3];
    let [a, b] = [1.0, -1.0].map(|sign| (0.7 + sign * (5.6_f64 - 1.47).sqrt()) / 2.8);
    let start = [a + 0.01, 0.3 * b, b, 0.3 * a - 0.01];
    let found = both(Henon, &start, &p, &settings).unwrap();
    let trace = 4.0 * 1.96 * a * b + 0.6;
    let large = 0.5 * (trace - (trace * trace - 0.36).sqrt());
    for (curves, multiplier) in found.iter().zip([large, 0.09 / large]) {
        assert_eq!(curves.len(), 2);
        close(curves[0].saddle[0], a, 1e-13);
        close(curves[1].saddle[0], b, 1e-13);
        for (k, curve) in curves.iter().enumerate() {
            close(curve.multiplier, multiplier, 1e-12);
            assert_eq!(curve.iterates, 4);
            let other = &curves[1 - k];
            let halves = [&other.halves[0], &other.halves[1]].map(|half| chain(other, half));
            for half in &curve.halves {
                assert!(half.deviation.unwrap() <= settings.resolution);
                for point in half.points.iter().step_by(9).filter(|point| point.arclength < 1.0) {
                    let mut image = [0.0; 2];
                    Henon.next(&point.at, &p, &mut image);
                    let apart = halves.each_ref().map(|half| distance(image, half));
                    assert!(apart[0].min(apart[1]) <= 2.0 * settings.resolution, "{apart:?}");
                }
            }
        }
    }
    let error = both(Henon, &[0.63, 0.19, 0.63, 0.19], &p, &settings).unwrap_err();
    assert_eq!(error, ManifoldError::Shorter { found: 1, wanted: 2 });
}

plane_map! {
    /// `u ↦ 2u`, `v ↦ v (1 − v)/2` with `x = u + v²`: the map folds at `v = 1/2`, and the stable
    /// manifold of the origin is `x = y²`.
    Folded, |x, y, p| {
        let (v, w) = (y, y * (-y + 1.0) * 0.5);
        [(x - v * v) * p[0] + w * w, w]
    }
}

#[test]
fn a_fold_of_the_map_ends_a_stable_manifold() {
    let settings = ManifoldSettings { length: 3.0, ..ManifoldSettings::default() };
    let curves = manifold(&Arc::new(Folded), &[0.0, 0.0], &[2.0, 0.0], Side::Stable, &settings);
    let curve = &curves.unwrap()[0];
    let on_curve = |half: &Half| {
        half.points.iter().all(|point| (point.at[0] - point.at[1].powi(2)).abs() < 1e-12)
    };
    let of = |sign: f64| {
        let up = |half: &&Half| half.points[0].at[1] * sign > 0.0;
        curve.halves.iter().find(up).unwrap()
    };
    let End::StepTooSmall { cause, .. } = &of(1.0).end else { panic!("{:?}", of(1.0).end) };
    assert!(cause.starts_with("the manifold reaches a fold of the map"), "{cause}");
    close(of(1.0).points.last().unwrap().at[1], 0.5, settings.resolution);
    // The other half goes to another fixed point, with v = −1.
    let End::ConvergesTo { point } = &of(-1.0).end else { panic!("{:?}", of(-1.0).end) };
    close(point[0], 1.0, settings.resolution);
    close(point[1], -1.0, settings.resolution);
    assert!(curve.halves.iter().all(on_curve));
}

plane_map! {
    /// Both halves of the unstable manifold of the origin go to stable nodes, at `x = ±1`.
    Settling, |x, y, p| [x + x * (-x * x + 1.0) * p[0], y * 0.5]
}

#[test]
fn ends_have_reasons() {
    let settings = ManifoldSettings::default();
    let map = Arc::new(Settling);
    let curves = manifold(&map, &[0.1, 0.0], &[0.3, 0.0], Side::Unstable, &settings).unwrap();
    for half in &curves[0].halves {
        let End::ConvergesTo { point } = &half.end else { panic!("{:?}", half.end) };
        close(point[0].abs(), 1.0, settings.resolution);
        close(half.length(), 1.0, settings.resolution);
    }
    let bounds = [[-0.5, 0.7], [-0.25, f64::INFINITY]];
    let bounded = ManifoldSettings { bounds, ..settings.clone() };
    let ends = |side, settings: &ManifoldSettings| {
        let curves = manifold(&map, &[0.1, 0.0], &[0.3, 0.0], side, settings).unwrap();
        let [a, b] = &curves[0].halves;
        [a, b].map(|half| (half.end.clone(), half.points.last().unwrap().at))
    };
    let bound = |name: &str, value: f64| End::MonitorBound { name: name.into(), value };
    let [left, right] = ends(Side::Unstable, &bounded);
    assert_eq!((left.0, right.0), (bound("x", -0.5), bound("x", 0.7)));
    close(left.1[0], -0.5, 1e-12);
    close(right.1[0], 0.7, 1e-12);
    let [down, up] = ends(Side::Stable, &bounded);
    assert_eq!((down.0, up.0), (bound("y", -0.25), bound("arclength", 20.0)));
    let few = ManifoldSettings { max_points: 11, ..settings };
    assert_eq!(ends(Side::Stable, &few)[0].0, End::PointLimit { points: 11 });
}

plane_map! { Linear, |x, y, p| [x * p[0], y * p[1]] }
plane_map! { Rotating, |x, y, p| [x * p[0] - y * p[1], x * p[1] + y * p[0]] }

/// One state.
struct Line;

impl DiscreteMap for Line {
    fn names(&self) -> Names {
        Names::new(["x"], Vec::<String>::new())
    }
    fn next<T: Scalar>(&self, x: &[T], _p: &[T], next: &mut [T]) {
        next[0] = x[0] * 2.0;
    }
}

#[test]
fn what_is_no_saddle_is_refused() {
    let settings = ManifoldSettings::default();
    let message = |p: [f64; 2]| both(Linear, &[0.0, 0.0], &p, &settings).unwrap_err().to_string();
    let stable = message([0.5, -0.2]);
    assert!(stable.starts_with("the cycle is a stable node, not a saddle"), "{stable}");
    let unstable = message([2.0, -3.0]);
    assert!(unstable.starts_with("the cycle is an unstable node, not a saddle"), "{unstable}");
    assert!(unstable.contains("-3.000000 and 2.000000"), "{unstable}");
    assert!(
        message([1.0005, 0.5]).starts_with("the multiplier 1.0005"),
        "{}",
        message([1.0005, 0.5])
    );
    assert!(
        message([2.0, 0.0]).contains("the stable manifold cannot be computed from preimages"),
        "{}",
        message([2.0, 0.0])
    );
    let focus = both(Rotating, &[0.0, 0.0], &[0.6, 0.9], &settings).unwrap_err();
    assert_eq!(focus, ManifoldError::Focus { re: 0.6, im: 0.9 });
    let line = manifold(&Arc::new(Line), &[0.0], &[], Side::Unstable, &settings).unwrap_err();
    assert_eq!(line, ManifoldError::NotPlanar { states: 1 });
    let out = ManifoldSettings { bounds: [[1.0, 2.0], [-1.0, 1.0]], ..settings.clone() };
    let out = both(Linear, &[0.0, 0.0], &[2.0, 0.5], &out).unwrap_err();
    assert_eq!(out, ManifoldError::OutOfBounds { name: "x".into(), value: 0.0 });
    let negative = ManifoldSettings { length: -1.0, ..settings };
    let negative = both(Linear, &[0.0, 0.0], &[2.0, 0.5], &negative).unwrap_err().to_string();
    assert_eq!(negative, "`length` is -1: the value of the setting must be finite and above 0");
}

/// `Bent` in units of its own for both states.
struct InUnits;

impl DiscreteMap for InUnits {
    fn names(&self) -> Names {
        Names::new(["x", "y"], ["a", "b"])
    }
    fn scales(&self, _p: &[f64]) -> Vec<f64> {
        vec![1e-6, 1e4]
    }
    fn next<T: Scalar>(&self, x: &[T], p: &[T], next: &mut [T]) {
        Bent.next(&[x[0] * 1e6, x[1] * 1e-4], p, next);
        (next[0], next[1]) = (next[0] * 1e-6, next[1] * 1e4);
    }
}

#[test]
fn manifolds_do_not_depend_on_units() {
    let settings = ManifoldSettings { length: 3.0, ..ManifoldSettings::default() };
    let of_bent = both(Bent, &[0.0, 0.0], &[2.0, -0.5], &settings).unwrap();
    let in_units = both(InUnits, &[0.0, 0.0], &[2.0, -0.5], &settings).unwrap();
    for (a, b) in of_bent.iter().flatten().zip(in_units.iter().flatten()) {
        for (a, b) in a.halves.iter().zip(&b.halves) {
            let [a, b] = [a, b].map(|half| half.points.last().unwrap());
            close(b.at[0] * 1e6, a.at[0], 1e-8);
            close(b.at[1] * 1e-4, a.at[1], 1e-8);
            close(b.arclength, a.arclength, 1e-9);
        }
    }
}

/// Without its second state Hénon's map is the logistic map: the unstable manifold goes to and fro on
/// an interval, and turns by π where it does.
#[test]
fn a_curve_may_turn_back_on_itself() {
    let settings = ManifoldSettings { length: 10.0, ..ManifoldSettings::default() };
    let curves = manifold(&Arc::new(Henon), &[0.6, 0.0], &[1.4, 0.0], Side::Unstable, &settings);
    for half in &curves.unwrap()[0].halves {
        assert_eq!(half.end, End::MonitorBound { name: "arclength".into(), value: 10.0 });
        close(half.length(), 10.0, 1e-9);
        assert!(half.points.iter().all(|point| point.at[1] == 0.0 && point.at[0] <= 1.0));
        let ways = half.points.windows(2).map(|pair| pair[1].at[0] - pair[0].at[0]);
        let ways: Vec<f64> = ways.collect();
        let turns = ways.windows(2).filter(|pair| pair[0] * pair[1] < 0.0).count();
        assert!(turns >= 10, "{turns}");
        // A turn that is cut off goes at most the resolution to and fro.
        let hidden = 2.0 * settings.resolution * turns as f64;
        close(ways.iter().map(|way| way.abs()).sum(), 10.0, hidden);
    }
}
