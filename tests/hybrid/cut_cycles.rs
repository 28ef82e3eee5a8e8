//! Promise: a smooth cycle that is cut by events, with other coordinates after each of them, keeps
//! its multipliers and the coefficients of its normal forms, by both methods, forced or not.

use crate::common::close;
use crate::hybrid::systems::orbits::{Start, by_both};
use std::f64::consts::{PI, TAU};
use tangency::core::continuation::SpecialPoint;
use tangency::core::hybrid::{Guard, HybridSystem, Mode};
use tangency::core::problem::Forcing;
use tangency::core::scalar::Scalar;
use tangency::core::system::Kind;

/// Deviations `(s, Z)` from a circle with an angle θ, `θ' = 1`, that have exact normal forms
/// (`tests/models/normal_forms/flipped.ron` and `torus.ron`): in a Möbius band with the multipliers
/// `−e^{2πμ}` and `−e^{−2πν}` and `doubling_c = c/(2π)`, or with the pair `e^{2π(μ ± iω)}` and
/// `torus_d = (c + 0.45 i)/π`.
///
/// The angle θ is the time, or `(X, Y) = e^s (cos θ, sin θ)`. States are `(s, Z)` or
/// `(X, Y, Z)`, with a circle, or 1, added where they would be zero. On the second half of the circle, in the mode
/// `there`, `Z + κ s²` stands for `Z`, and the plane of the first two states is turned: the change of
/// coordinates is orthogonal to first order, so that `∫⟨q, q⟩ dt` stays what it is. The events
/// depend on the deviations: they come sooner or later beside the cycle.
#[derive(Clone, Copy, Debug)]
struct Cut {
    pair: bool,
    forced: bool,
}

const HERE: usize = 0;
const THERE: usize = 1;

/// Another vector with the same length.
fn turned<T: Scalar>(angle: f64, [a, b]: [T; 2]) -> [T; 2] {
    let (sine, cosine) = angle.sin_cos();
    [a * cosine - b * sine, a * sine + b * cosine]
}

/// What is added to the deviations of forced motion: a circle.
fn moving<T: Scalar>(t: T) -> [T; 2] {
    [t.cos() * MOVES + 1.0, t.sin() * MOVES + 1.0]
}

const MOVES: f64 = 0.5;
const TURN: f64 = 1.0;
const KAPPA: f64 = 0.6;

impl Cut {
    /// `(s', Z')`.
    fn rates<T: Scalar>(self, [cosine, sine]: [T; 2], [s, z]: [T; 2], p: &[T]) -> [T; 2] {
        let (mu, c) = (p[0], p[1]);
        if self.pair {
            let square = s * s + z * z;
            let (a, b) = (mu + c * square, square * 0.45 + 0.21);
            return [a * s - b * z, a * z + b * s];
        }
        let nu = 0.3;
        let along = ((cosine + 1.0) * s + sine * z) * 0.5;
        let across = (sine * s + (-cosine + 1.0) * z) * 0.5;
        // p cos ½θ = s and p sin ½θ = Z on the band.
        let square = s * along + z * across;
        let rate = mu + c * square + square * square * 0.3;
        [rate * along - (s - along) * nu - z * 0.5, rate * across - (z - across) * nu + s * 0.5]
    }

    /// The cosine and the sine of the angle, the deviations, and `(X, Y)` where it is a state.
    fn read<T: Scalar>(self, mode: usize, t: T, x: &[T]) -> ([T; 2], [T; 2], [T; 2]) {
        let back = |v: [T; 2]| if mode == THERE { turned(-TURN, v) } else { v };
        let behind = |s: T| if mode == THERE { s * s * KAPPA } else { T::zero() };
        if self.forced {
            let [a, b] = moving(t);
            let [s, z] = back([x[0] - a, x[1] - b]);
            return ([t.cos(), t.sin()], [s, z - behind(s)], [T::zero(); 2]);
        }
        let plane = back([x[0], x[1]]);
        let radius = (plane[0] * plane[0] + plane[1] * plane[1]).sqrt();
        let s = radius.ln();
        (plane.map(|x| x / radius), [s, x[2] - 1.0 - behind(s)], plane)
    }
}

impl HybridSystem for Cut {
    fn modes(&self) -> Vec<Mode> {
        let states = if self.forced { &["s", "z"][..] } else { &["x", "y", "z"] };
        ["here", "there"].map(|name| Mode::new(name, states.iter().copied())).into()
    }

    fn guards(&self) -> Vec<Guard> {
        vec![Guard::new("leave", [HERE]), Guard::new("return", [THERE])]
    }

    fn parameters(&self) -> Vec<String> {
        ["mu", "c"].map(String::from).into()
    }

    fn field<T: Scalar>(&self, mode: usize, t: T, x: &[T], p: &[T], f: &mut [T]) {
        let (angle, [s, z], [a, b]) = self.read(mode, t, x);
        let [ds, mut dz] = self.rates(angle, [s, z], p);
        if mode == THERE {
            dz += s * ds * (2.0 * KAPPA);
        }
        let of_mode = |v: [T; 2]| if mode == THERE { turned(TURN, v) } else { v };
        if self.forced {
            let [a, b] = of_mode([ds, dz]);
            f.copy_from_slice(&[a - t.sin() * MOVES, b + t.cos() * MOVES]);
        } else {
            let [a, b] = of_mode([ds * a - b, ds * b + a]);
            f.copy_from_slice(&[a, b, dz]);
        }
    }

    fn guard<T: Scalar>(&self, guard: usize, mode: usize, t: T, x: &[T], _p: &[T]) -> T {
        let ([cosine, _], [s, z], _) = self.read(mode, t, x);
        if guard == HERE {
            cosine + s * 0.5 + z * 0.4 + 0.5
        } else {
            -cosine - s * 0.2 + z * 0.3 + 0.5
        }
    }

    fn reset<T: Scalar>(
        &self,
        _guard: usize,
        (mode, next): (usize, usize),
        t: T,
        x: &[T],
        _p: &[T],
        after: &mut [T],
    ) {
        let (_, [s, mut z], plane) = self.read(mode, t, x);
        if next == THERE {
            z += s * s * KAPPA;
        }
        let of_mode = |v: [T; 2]| if next == THERE { turned(TURN, v) } else { v };
        if self.forced {
            let ([a, b], [c, d]) = (of_mode([s, z]), moving(t));
            after.copy_from_slice(&[a + c, b + d]);
        } else {
            let [a, b] = of_mode(plane);
            after.copy_from_slice(&[a, b, z + 1.0]);
        }
    }

    fn next_mode(&self, _guard: usize, mode: usize, _t: f64, _x: &[f64], _p: &[f64]) -> usize {
        1 - mode
    }

    fn forcing(&self) -> Forcing {
        if self.forced { Forcing::Periodic { phase: TAU } } else { Forcing::None }
    }

    fn period<T: Scalar>(&self, _p: &[T]) -> T {
        T::constant(TAU)
    }
}

/// The cycle by both methods.
fn cycle(system: Cut, p: [f64; 2]) -> [Start; 2] {
    let begin = -PI / 3.0;
    if system.forced {
        let [here, there] = [begin, begin + PI].map(moving);
        let starts: [&[f64]; 2] = [&here, &there];
        return by_both(system, "here:leave there:return", &starts, &[begin, PI, PI], &p);
    }
    let (y, x) = begin.sin_cos();
    let [a, b] = turned(TURN, [-x, -y]);
    let starts: [&[f64]; 2] = [&[x, y, 1.0], &[a, b, 1.0]];
    by_both(system, "here:leave there:return", &starts, &[PI, PI], &p)
}

/// Asserts that a coefficient has its exact value, to its error and rounding.
#[track_caller]
fn agrees(point: &SpecialPoint, name: &str, expected: f64) {
    let number = point.number(name).unwrap();
    close(number.value, expected, number.error + 2e-11 * expected.abs());
    assert!(number.error <= 1e-7 * expected.abs(), "{name}: {number:?}");
}

/// The point of a kind on a branch in μ, which is at μ = 0.
fn at_zero(system: Cut, c: f64, kind: Kind, check: impl Fn(&SpecialPoint)) {
    for mut start in cycle(system, [-0.1, c]) {
        let branch = start.along("mu", [-0.1, 0.1]).trace().unwrap();
        let point = branch.of_kind(kind).next();
        let point = point.unwrap_or_else(|| panic!("{}: no {kind}", start.method));
        close(point.parameters[0], 0.0, 1e-9);
        agrees(point, "growth_slope", 1.0);
        check(point);
    }
}

#[test]
fn doublings_of_cut_cycles_have_the_coefficients_of_the_smooth_ones() {
    for forced in [true, false] {
        for (c, case) in [(0.7, "subcritical"), (-0.5, "supercritical")] {
            at_zero(Cut { pair: false, forced }, c, Kind::PD, |doubling| {
                agrees(doubling, "doubling_c", c / TAU);
                assert_eq!(doubling.subkind.as_deref(), Some(case));
            });
        }
    }
}

#[test]
fn torus_points_of_cut_cycles_have_the_coefficients_of_the_smooth_ones() {
    for forced in [true, false] {
        for (c, case) in [(0.6, "subcritical"), (-0.7, "supercritical")] {
            at_zero(Cut { pair: true, forced }, c, Kind::TR, |torus| {
                agrees(torus, "torus_angle", TAU * 0.21);
                agrees(torus, "torus_d_re", c / PI);
                agrees(torus, "torus_d_im", 0.45 / PI);
                assert_eq!(torus.subkind.as_deref(), Some(case));
            });
        }
    }
}
