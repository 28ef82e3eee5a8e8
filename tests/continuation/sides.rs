//! Promise: the numbers of unstable directions on the two sides of a curve in two parameters are the ones of
//! the solutions that are found there, whatever the order of the parameters, their signs and units.

use std::ops::RangeInclusive;
use tangency::core::continuation::{Branch, Continuation, RootSearch, Settings, Stretch};
use tangency::core::orbit::MapCycle;
use tangency::core::problem::{DiscreteMap, Names};
use tangency::core::scalar::Scalar;
use tangency::core::system::{Dense, Kind, System};
use tangency::prelude::*;

/// Two parameters with their ranges, in the order of the curve.
type Plane<'a> = [(&'a str, RangeInclusive<f64>); 2];

/// A solution, parameters, and the parameter along which a curve's start is found, with its range.
type Start<'a> = (&'a [f64], &'a [(&'a str, f64)], (&'a str, RangeInclusive<f64>));

/// The curve of the first point of a kind that is met from a solution along the first of the
/// parameters named.
fn curve(
    system: &mut dyn System,
    (start, values, along): Start,
    kind: Kind,
    plane: Plane,
) -> Branch {
    let mut solutions = Continuation::new(system).from(start).along(along.0, along.1);
    for (name, value) in values {
        solutions = solutions.at(name, *value);
    }
    let solutions = solutions.trace().unwrap();
    let point = solutions.of_kind(kind).next().unwrap_or_else(|| panic!("no {kind}"));
    let settings = Settings { keep_solutions: true, ..Settings::default() };
    let mut held = Continuation::new(system).settings(settings).restart(&solutions, point.label);
    for (name, range) in plane {
        held = held.along(name, range);
    }
    held.hold(kind).trace().unwrap()
}

/// The place of a point in the plane of both parameters, in parts of `sizes`.
fn place(branch: &Branch, k: usize, sizes: [f64; 2]) -> [f64; 2] {
    let columns = [0, 1].map(|axis| branch.column(&branch.released[axis]).unwrap());
    [0, 1].map(|axis| branch.points[k].value(columns[axis]).unwrap() / sizes[axis])
}

/// Looks for solutions beside three points of each stretch, `away` from the curve in parts of
/// `sizes`, in a box about the point, and compares the numbers of their unstable directions.
fn check(system: &mut dyn System, branch: &Branch, (sizes, away): ([f64; 2], f64), within: f64) {
    let mut checked = 0;
    for Stretch { points: [first, last], left, right } in &branch.stretches {
        for share in 1..4 {
            let k = first + (last - first) * share / 4;
            if k == *first || k == *last {
                continue;
            }
            let [before, at, after] = [k - 1, k, k + 1].map(|k| place(branch, k, sizes));
            let [x, y] = [0, 1].map(|axis| after[axis] - before[axis]);
            let step = away / x.hypot(y);
            for (side, expected) in [(step, left), (-step, right)] {
                let there = [at[0] - side * y, at[1] + side * x];
                let mut p = branch.points[k].parameters.clone();
                for axis in 0..2 {
                    let column = branch.column(&branch.released[axis]).unwrap();
                    p[column] = there[axis] * sizes[axis];
                }
                let state = &branch.points[k].solution.as_ref().unwrap().state;
                let around: Vec<[f64; 2]> =
                    state.iter().map(|z| [z - within, z + within]).collect();
                let found = RootSearch::default().find(system, &p, &around).unwrap().roots;
                let mut counts: Vec<usize> = found.iter().filter_map(|it| it.unstable).collect();
                counts.sort_unstable();
                assert_eq!(&counts, expected, "at {p:?}, beside {:?}", branch.points[k].parameters);
                checked += 1;
            }
        }
    }
    assert!(checked > 5, "{checked} places");
    // Only points next to special ones may belong to no stretch.
    let covered: usize = branch.stretches.iter().map(|it| it.points[1] - it.points[0] + 1).sum();
    assert!(10 * covered > 8 * branch.points.len(), "{covered} of {}", branch.points.len());
}

vector_field! {
    /// The Bogdanov–Takens normal form, with the first parameter in other units or of the other sign.
    struct Takens { unit: f64 } [x, y; e1, e2] {
        d/dt x = y;
        d/dt y = e1 * unit + e2 * y + x * x - x * y;
    }
}

/// Folds on `e1 = 0`, Hopf points on `e1 = −e2²`, `e2 < 0`.
#[test]
fn of_a_bogdanov_takens_point() {
    for unit in [1.0, -1.0, 1e6, -1e-3] {
        let first =
            || ("e1", if unit > 0.0 { -1.0 / unit..=0.5 / unit } else { 0.5 / unit..=-1.0 / unit });
        for swapped in [false, true] {
            let mut system = Dense::new(Equilibria::new(Takens { unit }));
            let start: Start = (&[-0.9, 0.0], &[("e1", -0.81 / unit), ("e2", -0.5)], first());
            for (kind, number) in [(Kind::LP, 2), (Kind::HB, 1)] {
                let mut plane = [first(), ("e2", -0.8..=0.7)];
                let mut sizes = [1.0 / unit.abs(), 1.0];
                if swapped {
                    plane.reverse();
                    sizes.reverse();
                }
                let branch = curve(&mut system, start.clone(), kind, plane);
                assert_eq!(branch.stretches.len(), number, "{:?}", branch.stretches);
                check(&mut system, &branch, (sizes, 1e-3), 0.1);
            }
        }
    }
}

vector_field! {
    /// Two oscillators, and one that a fold drives.
    struct Oscillators [a, b, c, d; p, q] {
        d/dt a = (p + q * 0.3) * a - b * 2.3 - a * (a * a + b * b) * 0.7;
        d/dt b = (p + q * 0.3) * b + a * 2.3 + c * c;
        d/dt c = (q - p * p * 0.2) * c - d;
        d/dt d = (q - p * p * 0.2) * d + c - d * (c * c + d * d);
    }
}

vector_field! {
    struct FoldAndOscillator [v, a, b; p, q] {
        d/dt v = p + v * v - (a * a + b * b) * 0.8;
        d/dt a = (q + v * 0.35) * a - b * 1.3;
        d/dt b = (q + v * 0.35) * b + a * 1.3;
    }
}

/// Further eigenvalues pass the axis at points of codimension two, and the numbers change there.
#[test]
fn of_a_double_hopf_point_and_a_fold_hopf_point() {
    let mut system = Dense::new(Equilibria::new(Oscillators));
    let plane = || [("p", -1.0..=1.0), ("q", -1.0..=1.0)];
    let start: Start = (&[0.0; 4], &[("p", -0.9), ("q", -0.5)], ("p", -0.9..=1.0));
    let branch = curve(&mut system, start, Kind::HB, plane());
    let sides = |branch: &Branch| -> Vec<Vec<usize>> {
        let all = branch.stretches.iter().flat_map(|it| [&it.left, &it.right]);
        let mut all: Vec<Vec<usize>> = all.cloned().collect();
        all.sort();
        all
    };
    assert_eq!(sides(&branch), [vec![0], vec![2], vec![2], vec![4]]);
    check(&mut system, &branch, ([1.0; 2], 1e-3), 0.02);

    let mut system = Dense::new(Equilibria::new(FoldAndOscillator));
    let start: Start = (&[-0.9, 0.0, 0.0], &[("p", -0.81), ("q", 0.2)], ("p", -1.0..=1.0));
    let folds = curve(&mut system, start.clone(), Kind::LP, plane());
    assert_eq!(sides(&folds), [vec![], vec![], vec![0, 1], vec![2, 3]]);
    check(&mut system, &folds, ([1.0; 2], 1e-3), 0.06);
    let hopf = curve(&mut system, start, Kind::HB, plane());
    assert_eq!(sides(&hopf), [vec![0], vec![1], vec![2], vec![3]]);
    check(&mut system, &hopf, ([1.0; 2], 1e-3), 0.02);
}

vector_field! {
    /// V. I. Bykov's catalytic oscillator (1985), with a cusp, two Bogdanov–Takens and two generalised
    /// Hopf points.
    struct Oxidation [x, y, s; q2, k] {
        d/dt x = free(x, y, s).powi(2) * 5.0 - x * x * 2.0 - x * y * 10.0;
        d/dt y = free(x, y, s) * q2 - y * 0.1 - x * y * 10.0;
        d/dt s = (free(x, y, s) - k * s) * 0.0675;
    }
}

fn free<T: Scalar>(x: T, y: T, s: T) -> T {
    T::one() - x - y - s
}

#[test]
fn of_the_curves_of_a_model() {
    let mut system = Dense::new(Equilibria::new(Oxidation));
    let plane = || [("q2", 0.5..=2.0), ("k", 0.1..=2.0)];
    let start: Start =
        (&[0.001137, 0.891483, 0.062345], &[("q2", 2.0), ("k", 0.4)], ("q2", 0.5..=2.0));
    // Near a Bogdanov–Takens point the other solution of the fold is near the Hopf point.
    for (kind, within) in [(Kind::LP, 0.01), (Kind::HB, 0.002)] {
        let branch = curve(&mut system, start.clone(), kind, plane());
        assert!(branch.stretches.len() > 2, "{:?}", branch.stretches);
        check(&mut system, &branch, ([1.0; 2], 2e-6), within);
    }
}

vector_field! {
    /// Branches cross where `r = p − q²` vanishes: pitchforks for `c ≠ 0`, of either sort.
    struct Crossing { b: f64, c: f64 } [x, y; p, q] {
        d/dt x = (p - q * q) * x + x * x * b + x * x * x * c;
        d/dt y = x * x - y;
    }
}

#[test]
fn of_curves_of_branch_points() {
    // Solutions are √0.001 away from the one that persists, or 0.001.
    for (b, c, within, [below, above]) in [
        (0.0, -1.0, 0.06, [vec![0], vec![0, 0, 1]]),
        (0.0, 1.0, 0.06, [vec![0, 1, 1], vec![1]]),
        (1.0, 0.0, 0.003, [vec![0, 1], vec![0, 1]]),
    ] {
        for swapped in [false, true] {
            let mut system = Dense::new(Equilibria::new(Crossing { b, c }));
            let start: Start = (&[0.0, 0.0], &[("p", -0.5), ("q", 0.3)], ("p", -1.0..=1.0));
            let mut plane = [("p", -1.0..=1.0), ("q", -0.7..=0.8)];
            if swapped {
                plane.reverse();
            }
            let branch = curve(&mut system, start, Kind::BP, plane);
            let [stretch] = &branch.stretches[..] else { panic!("{:?}", branch.stretches) };
            let sides = [&stretch.left, &stretch.right];
            assert!(sides == [&below, &above] || sides == [&above, &below], "{sides:?}");
            check(&mut system, &branch, ([1.0; 2], 1e-3), within);
        }
    }
}

/// `(x, y) → (y, α − β x − y² + x y/2)`: folds on `β = −1 − x`, period doublings on `β = 2x − 1`, torus
/// points on `β = 1 + x/2`.
struct Pulsed;

impl DiscreteMap for Pulsed {
    fn names(&self) -> Names {
        Names::new(["x", "y"], ["al", "be"])
    }

    fn next<T: Scalar>(&self, x: &[T], p: &[T], next: &mut [T]) {
        next[0] = x[1];
        next[1] = p[0] - p[1] * x[0] - x[1] * x[1] + x[0] * x[1] * 0.5;
    }
}

#[test]
fn of_the_curves_of_a_map() {
    for (kind, start, value, along) in [
        (Kind::PD, 0.1, [0.165, 0.6], "al"),
        (Kind::TR, 0.3, [0.405, 0.2], "be"),
        (Kind::LP, 0.1, [0.165, 0.6], "al"),
    ] {
        for swapped in [false, true] {
            let mut system = MapCycle::of(Pulsed, 1);
            let mut plane = [("al", -2.0..=5.0), ("be", -3.0..=3.0)];
            let range = if along == "al" { -2.0..=5.0 } else { 0.2..=2.0 };
            if swapped {
                plane.reverse();
            }
            let values = [("al", value[0]), ("be", value[1])];
            let start: Start = (&[start; 2], &values, (along, range));
            let branch = curve(&mut system, start, kind, plane);
            assert!(branch.stretches.len() > 1, "{:?}", branch.stretches);
            check(&mut system, &branch, ([1.0; 2], 1e-4), 0.04);
        }
    }
}
