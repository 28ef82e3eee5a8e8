//! Promise: the hybrid systems that tests refer to are stated right, as far as their closed forms,
//! the digits printed in the literature, and the equations themselves can tell without any solver
//! of this crate.

use crate::common::close;
use crate::hybrid::systems::belt::{self, Belt};
use crate::hybrid::systems::bouncing_ball::{self, BouncingBall};
use crate::hybrid::systems::coulomb::{self, Coulomb};
use crate::hybrid::systems::dry_impact::{self, DryImpact};
use crate::hybrid::systems::impact_oscillator::{ClosedForm, damped, resonance};
use crate::hybrid::systems::piecewise::{self, Piecewise};
use crate::hybrid::systems::{defect, event, multipliers};
use num_dual::{Dual64, DualNum, DualSVec64};
use proptest::prelude::*;
use std::f64::consts::{PI, TAU};
use tangency::core::hybrid::HybridSystem;
use tangency::core::hybrid::filippov::Filippov;
use tangency::core::scalar::Scalar;
use tangency::problems::classic::ImpactOscillator;

type Two = DualSVec64<2>;

/// The printed numbers, to their last digit.
#[test]
fn the_impact_oscillator_has_its_printed_numbers() {
    close(ClosedForm::usual(1.0).grazing(), 0.1, 1e-15);
    close(ClosedForm::usual(1.0).fold_amplitude(), 0.0999707536283, 5e-14);
    close(ClosedForm::usual(1.0).fold(), 0.00411153064395, 5e-15);
    close(ClosedForm::usual(1.2).fold_amplitude(), 0.151682351638, 5e-13);
    let resonant = ClosedForm::usual(2.2);
    close(resonant.grazing(), 3.84629692042, 5e-12);
    close(resonant.doubling(), 0.831219595568, 5e-13);
    close(resonant.amplitude(resonant.doubling()), 4.26985572704, 5e-12);
    assert!(resonant.fold() < 0.0, "the fold at 2.2 is not physical");
}

/// At the fold a multiplier is 1, at the period doubling one is −1, and the amplitude is extreme at
/// the fold.
#[test]
fn bifurcations_of_the_impact_oscillator_are_those_of_its_multipliers() {
    for frequency in [0.7, 1.0, 1.2, 1.7, 2.2, 2.6] {
        let form = ClosedForm::usual(frequency);
        let (fold, doubling) = (form.fold(), form.doubling());
        close(1.0 - form.trace(fold) + form.determinant(), 0.0, 1e-12);
        close(1.0 + form.trace(doubling) + form.determinant(), 0.0, 1e-12);
        close(form.amplitude(fold), form.fold_amplitude(), 1e-14 * form.fold_amplitude());
        let beside = form.amplitude(fold * (1.0 + 1e-3)).min(form.amplitude(fold * (1.0 - 1e-3)));
        assert!(beside > form.fold_amplitude());
    }
}

/// Where half a period of free motion fits n times into that of forcing, no impact changes the
/// place after a period: `Φ₁₂ = 0`, multipliers stay bounded and the family leaves grazing
/// vertically.
#[test]
fn resonant_grazing_is_where_the_square_root_vanishes() {
    for n in 1..=4 {
        let form = ClosedForm::usual(resonance(n, 0.1));
        close(form.flow[0][1], 0.0, 1e-14);
        close(form.a, 0.0, 1e-12);
        close(form.trace(1e-6), -0.8 * (form.flow[0][0] + form.flow[1][1]), 1e-6);
    }
    close(resonance(2, 0.1), damped(0.1), 1e-15);
    close(ClosedForm::usual(resonance(1, 0.1)).grazing(), 8.98_f64.sqrt(), 1e-14);
}

/// Trace and determinant of the derivative of a map of the plane.
fn trace_and_determinant(map: impl Fn([Two; 2]) -> [Two; 2], at: [f64; 2]) -> [f64; 2] {
    let image = map([Two::from(at[0]).derivative(0), Two::from(at[1]).derivative(1)]);
    for (image, at) in image.iter().zip(at) {
        close(image.re, at, 1e-11 * at.abs().max(1.0));
    }
    let [p, q] = image.map(|x| x.eps.0.expect("it depends on both"));
    [p[0] + q[1], p[0] * q[1] - p[1] * q[0]]
}

/// One period of the closed form's orbit is a solution of the equations that ends at its impact,
/// and the map from impact to impact has the multipliers of the closed form.
#[test]
fn the_impact_oscillator_moves_as_its_closed_form() {
    for (frequency, u) in [(1.0, 0.3), (1.2, 0.8), (2.2, 0.83), (2.2, 2.0), (2.7, 0.1)] {
        let form = ClosedForm::usual(frequency);
        let p = [form.amplitude(u), frequency, form.restitution, form.damping, form.clearance];
        let (start, period) = ([form.time(u), -form.restitution * u], TAU / frequency);
        for k in 0..20 {
            let after = 0.05 * f64::from(k) * period;
            let flight = |s: Dual64| form.flight(p[0], start.map(Dual64::from), s);
            let defect = defect(&ImpactOscillator, 0, start[0], after, flight, &p);
            assert!(defect < 1e-13 * p[0].max(1.0), "{frequency} {u}: {defect:e}");
        }
        let map = |start: [Two; 2]| {
            let flight = |s: Two| form.flight(p[0], start, s);
            let p = p.map(Two::from);
            let (after, state) = event(&ImpactOscillator, (0, 0), start[0], period, flight, &p);
            [start[0] + after - period, state[1]]
        };
        let [trace, determinant] = trace_and_determinant(map, start);
        close(trace, form.trace(u), 1e-10 * form.trace(u).abs().max(1.0));
        close(determinant, form.determinant(), 1e-10);
        let [large, small] = multipliers(trace, determinant);
        close(large.0 + small.0, trace, 1e-14 * trace.abs());
    }
}

/// Contact lasts while the force presses the mass to the stop.
#[test]
fn contact_of_the_impact_oscillator_ends_without_force() {
    let p = [1.5, 1.0, 0.8, 0.1, 1.0];
    let rest = |_: f64| [1.0];
    let (after, state) = event(&ImpactOscillator, (1, 1), 0.0, 0.8, rest, &p);
    close(after, (1.0_f64 / 1.5).acos(), 1e-14);
    assert_eq!(state, [1.0, 0.0]);
}

#[test]
fn the_bouncing_ball_has_its_printed_numbers() {
    close(bouncing_ball::fold(1, 0.8), 0.3490658503988659, 1e-15);
    close(bouncing_ball::doubling(1, 0.8), 1.070836468247907, 4e-15);
}

/// The ball is thrown from impact to impact as the closed form says, and rests after infinitely
/// many of them.
#[test]
fn the_ball_moves_as_its_closed_form() {
    for (n, gamma, e) in [(1, 0.6, 0.8), (1, 1.0, 0.8), (2, 1.8, 0.6)] {
        let start = bouncing_ball::orbit(n, gamma, e);
        let p = [gamma, e].map(Two::from);
        let map = |[t, v]: [Two; 2]| {
            let height = t.sin() * gamma;
            let flight = |s: Two| [height + v * s - s * s * 0.5, v - s];
            let (after, state) = event(&BouncingBall, (0, 0), t, TAU * n as f64, flight, &p);
            [t + after - TAU * n as f64, state[1]]
        };
        let [trace, determinant] = trace_and_determinant(map, start);
        let expected = bouncing_ball::map(n, gamma, e);
        close(trace, expected[0], 1e-10);
        close(determinant, expected[1], 1e-10);
    }
    let [trace, determinant] = bouncing_ball::map(1, bouncing_ball::doubling(1, 0.8), 0.8);
    close(1.0 + trace + determinant, 0.0, 1e-14);
    let (mut time, mut v, p) = (2.0_f64.sqrt(), 0.8 * 2.0_f64.sqrt(), [0.0, 0.8]);
    for _ in 0..150 {
        let flight = |s: f64| [v * s - s * s * 0.5, v - s];
        let (after, state) = event(&BouncingBall, (0, 0), 0.0, 2.0 * v, flight, &p);
        (time, v) = (time + after, state[1]);
    }
    close(time, bouncing_ball::rest(1.0, 0.8), 1e-12);
    let table = |t: f64| [1.3 * t.sin()];
    let (after, state) = event(&BouncingBall, (1, 1), 0.0, 0.8, table, &[1.3, 0.8]);
    close(after, bouncing_ball::leave(1.3), 1e-13);
    close(state[1], 1.3 * after.cos(), 1e-15);
}

#[test]
fn the_belt_has_its_printed_period_and_its_motion() {
    let p @ [friction, kinetic, belt] = [1.0, 0.6, 0.3];
    close(belt::period(friction, kinetic, belt), 7.095261537843029, 2e-15);
    close(belt::largest(friction, kinetic, belt), 1.1, 1e-15);
    let delta = friction - kinetic;
    fn slip<T: Scalar>([kinetic, delta, belt]: [f64; 3], s: T) -> [T; 2] {
        [s.cos() * delta + s.sin() * belt + kinetic, s.cos() * belt - s.sin() * delta]
    }
    let numbers = [kinetic, delta, belt];
    assert!(defect(&Filippov(Belt), Belt::SLOWER, 0.0, 0.7, |s| slip(numbers, s), &p) < 1e-15);
    let sticking = 2.0 * delta / belt;
    let (system, expected) = (Filippov(Belt), belt::period(friction, kinetic, belt) - sticking);
    let (after, state) =
        event(&system, (Belt::CATCH, Belt::SLOWER), 0.0, expected + 1e-3, |s| slip(numbers, s), &p);
    close(after, expected, 1e-13);
    assert_eq!(system.next_mode(Belt::CATCH, Belt::SLOWER, 0.0, &state, &p), Belt::STICK);
    close(state[0], belt::stick(friction, kinetic), 1e-13);
    let stick = |s: f64| [state[0] + belt * s, belt];
    let (after, state) = event(&system, (Belt::SLIP, Belt::STICK), 0.0, 2.0, stick, &p);
    close(after, sticking, 1e-13);
    close(state[0], friction, 1e-13);
    assert_eq!(state[1], belt);
}

#[test]
fn den_hartogs_motion_has_its_printed_amplitude() {
    let p @ [beta, friction] = [1.5, 0.2];
    close(coulomb::amplitude(beta, friction), 0.765941686205071, 1e-15);
    for (beta, friction) in [(1.5, 0.2), (0.8, 0.3), (2.5, 0.05)] {
        let p = [beta, friction];
        let amplitude = coulomb::amplitude(beta, friction);
        let start = coulomb::phase(beta, friction) / beta;
        let backward = |s: Dual64| coulomb::backward(beta, friction, s);
        let half = PI / beta;
        for k in 0..=20 {
            let after = f64::from(k) * half / 20.0;
            let defect = defect(&Coulomb, Coulomb::BACKWARD, start, after, backward, &p);
            assert!(defect < 1e-14, "{defect:e}");
            assert!(backward(Dual64::from(after))[1].re < 1e-14, "it does not stop");
        }
        close(coulomb::backward(beta, friction, 0.0)[0], amplitude, 1e-14);
        let flight = |s: f64| coulomb::backward(beta, friction, s);
        let (after, state) =
            event(&Coulomb, (Coulomb::LOW, Coulomb::BACKWARD), start, half + 1e-3, flight, &p);
        close(after, half, 1e-12);
        close(state[0], -amplitude, 1e-13);
        assert_eq!(state.len(), 2, "it goes on forwards");
    }
    // The spring of a mass at rest at 0.1 lets go where cos βt − 0.1 = ±F.
    let rest = |_: f64| [0.1];
    let (after, _) = event(&Coulomb, (Coulomb::PUSH, Coulomb::STICK), 0.0, 1.1, rest, &p);
    close((beta * after).cos(), 0.1 - friction, 1e-14);
}

/// The limit cycle's radii are found by bisection; its period and multiplier are the printed ones.
#[test]
fn the_piecewise_field_has_its_printed_cycle() {
    let cycle = piecewise::cycle(1.0, 2.0, 1.5);
    close(PI + cycle.right, 4.810271605994165, 1e-14);
    close(cycle.multiplier, 0.002430511420186203, 1e-15);
}

/// The numbers at `k = 5.5`, the fold, and where sliding begins before the impact.
#[test]
fn dry_impacts_have_their_printed_numbers() {
    let form = dry_impact::ClosedForm::new(DryImpact::DEFAULTS);
    let [x, _] = form.rest();
    close(x, -0.1331776845606505, 1e-15);
    close(form.time(x), 0.7950838416259379, 1e-15);
    close(form.multiplier(x), 0.8054521711443933, 1e-14);
    close(form.fold(), 4.95153555561129, 2e-14);
    let [k] = form.switching_sliding()[..] else { panic!("one point") };
    close(k, 5.57303403997821, 2e-14);
    // At the fold both orbits are one, with the multiplier 1; at the other place the orbit rests at
    // −F/k.
    let at = |k: f64| {
        let [_, rest @ ..] = DryImpact::DEFAULTS;
        let [a, b, c, d, e, f] = rest;
        dry_impact::ClosedForm::new([k, a, b, c, d, e, f])
    };
    let [low, high] = at(form.fold() * (1.0 + 1e-12)).rest();
    close(low, high, 1e-5);
    close(at(form.fold()).multiplier(0.5 * (low + high)), 1.0, 1e-5);
    close(at(k).rest()[0], -0.7961 / k, 1e-14);
}

/// Hit, up, down and at rest again: exact half circles, ended by the system's guards and begun by
/// its resets, return to the place of rest, with the multiplier of the closed form.
#[test]
fn dry_impacts_move_as_their_closed_form() {
    // Of the two orbits at 5.5 the second would rest beyond F/k.
    for (stiffness, orbits) in [(5.0, 2), (5.5, 1)] {
        let mut p = DryImpact::DEFAULTS;
        p[0] = stiffness;
        let form = dry_impact::ClosedForm::new(p);
        let physical = |place: &f64| place.abs() < 0.7961 / stiffness;
        let places: Vec<f64> = form.rest().into_iter().filter(physical).collect();
        assert_eq!(places.len(), orbits);
        for place in places {
            let rest = Dual64::from(place).derivative();
            let (root, p) = (stiffness.sqrt(), p.map(Dual64::from));
            let half_circle = |state: [Dual64; 2], centre: f64, s: Dual64| {
                let (sine, cosine) = (s * root).sin_cos();
                let (x, v) = (state[0] - centre, state[1] / root);
                [x * cosine + v * sine + centre, (v * cosine - x * sine) * root]
            };
            let f = 0.7961 / stiffness;
            let zero = Dual64::from(0.0);
            let expected = form.time(place);
            let (time, up) = event(&DryImpact, (0, 0), zero, expected + 1e-3, |_| [rest], &p);
            close(time.re, expected, 1e-13);
            close(up[1].re, form.velocity(place), 1e-13);
            let quarter = (up[1].re / root).atan2(place + f) / root;
            let flight = |s| half_circle([up[0], up[1]], -f, s);
            let (_, down) =
                event(&DryImpact, (DryImpact::TURN, DryImpact::UP), time, quarter, flight, &p);
            let flight = |s| half_circle([down[0], down[1]], f, s);
            let (_, again) =
                event(&DryImpact, (DryImpact::TURN, DryImpact::DOWN), time, PI / root, flight, &p);
            assert_eq!(again.len(), 1, "it rests");
            close(again[0].re, place, 1e-13);
            close(again[0].eps, form.multiplier(place), 1e-12);
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, failure_persistence: None, ..ProptestConfig::default() })]

    /// The planar field is the one that its polar equations state, on either side.
    #[test]
    fn the_piecewise_field_is_the_polar_one(r in 0.1..3.0_f64, theta in -1.5..1.5_f64, alpha in 0.5..2.0_f64) {
        let (beta, gamma) = (2.0, 1.5);
        for (mode, angle, growth, turn) in [
            (Piecewise::LEFT, theta + PI, r * (1.0 - r), 1.0),
            (Piecewise::RIGHT, theta, alpha * r * (beta - r), gamma + beta - r),
        ] {
            let (sine, cosine) = angle.sin_cos();
            let mut f = [0.0; 2];
            Piecewise.field(mode, 0.0, &[r * cosine, r * sine], &[alpha, beta, gamma], &mut f);
            close(f[0] * cosine + f[1] * sine, growth, 1e-14 * 20.0);
            close((f[1] * cosine - f[0] * sine) / r, turn, 1e-14 * 20.0);
        }
    }
}
