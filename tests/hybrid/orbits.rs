//! Promise: hybrid orbits have the places, multipliers, folds and period doublings of their closed
//! forms to 1e-10, by collocation and by shooting.

use crate::common::close;
use crate::hybrid::systems::dry_impact::{self, DryImpact};
use crate::hybrid::systems::impact_oscillator::ClosedForm;
use crate::hybrid::systems::orbits::{ASIDE, DIGITS, Solved, by_both, found, impacting, resting};
use crate::hybrid::systems::reference::Reference;
use crate::hybrid::systems::{belt, bouncing_ball, coulomb, multipliers, piecewise};
use std::f64::consts::{PI, TAU};
use tangency::core::system::Kind;

/// Compares the multipliers, of which one more is zero since an orbit begins on a surface.
#[track_caller]
fn has_multipliers(orbit: &Solved, expected: &[(f64, f64)]) {
    let zero = std::iter::repeat(&(0.0, 0.0));
    let size = expected.iter().fold(1.0, |size: f64, mu| size.max(mu.0.hypot(mu.1)));
    for (found, expected) in orbit.multipliers.iter().zip(expected.iter().chain(zero)) {
        close(found.0, expected.0, DIGITS * size);
        close(found.1, expected.1, DIGITS * size);
    }
}

/// Along families of orbits with one impact, towards grazing, where a multiplier grows like `1/u`.
#[test]
fn impacting_orbits_have_their_speeds_and_multipliers() {
    for (frequency, speeds) in [(1.0, [0.5, 0.05, 0.01]), (2.2, [3.0, 0.5, 0.01])] {
        let form = ClosedForm::usual(frequency);
        for u in speeds {
            for start in impacting(&form, u) {
                let orbit = start.solved();
                close(-orbit.first("velocity") / form.restitution, u, DIGITS);
                close(orbit.first("start"), form.time(u), DIGITS);
                has_multipliers(&orbit, &multipliers(form.trace(u), form.determinant()));
            }
        }
    }
}

/// Where the impact has no speed the equations are as regular as elsewhere: only a multiplier is
/// infinite.
#[test]
fn impacting_orbits_are_regular_where_they_graze() {
    for frequency in [0.7, 2.2] {
        let form = ClosedForm::usual(frequency);
        for u in [1e-3, 1e-6, 0.0] {
            for start in impacting(&form, u) {
                let orbit = start.solved();
                close(-orbit.first("velocity"), form.restitution * u, DIGITS);
                let [large, small] = multipliers(form.trace(u), form.determinant());
                let found = &orbit.multipliers;
                close(found[0].0.recip(), large.0.recip(), DIGITS);
                // Both others are zero where the speed is.
                close(found[1].0, small.0, 1e-7);
            }
        }
    }
}

/// Orbits with one impact fold, or double their period.
#[test]
fn impacting_orbits_fold_and_double() {
    for frequency in [1.0, 1.2] {
        let form = ClosedForm::usual(frequency);
        for mut start in impacting(&form, 0.3) {
            let branch = start.along("amplitude", [0.05, 0.5]).trace().unwrap();
            let fold = found(&branch).into_iter().find(|(kind, _)| *kind == Kind::LP).unwrap();
            close(fold.1, form.fold_amplitude(), DIGITS);
        }
    }
    let form = ClosedForm::usual(2.2);
    for mut start in impacting(&form, 1.3) {
        let branch = start.along("amplitude", [3.0, 6.0]).trace().unwrap();
        let doubling = found(&branch).into_iter().find(|(kind, _)| *kind == Kind::PD).unwrap();
        close(doubling.1, form.amplitude(form.doubling()), DIGITS);
    }
}

/// Orbits with one impact in `n` periods are born in a fold, and double their period.
#[test]
fn the_balls_orbits_are_born_and_double() {
    for (n, gamma, e) in [(1, 0.7, 0.8), (2, 0.9, 0.8), (1, 1.3, 0.5)] {
        let [t, v] = bouncing_ball::orbit(n, gamma, e);
        let state = [gamma * t.sin(), v * (1.0 + ASIDE)];
        let words = format!("{n}* flight:impact");
        let extras = [t, TAU * n as f64];
        let starts = || by_both(Reference::BouncingBall, &words, &[&state], &extras, &[gamma, e]);
        let [trace, determinant] = bouncing_ball::map(n, gamma, e);
        for start in starts() {
            let orbit = start.solved();
            close(orbit.first("start"), t, DIGITS);
            close(orbit.first("velocity"), v, DIGITS);
            has_multipliers(&orbit, &multipliers(trace, determinant));
        }
        for mut start in starts() {
            let branch = start.along("acceleration", [0.1, 1.8]).trace().unwrap();
            let [(Kind::LP, fold), (Kind::PD, doubling)] = found(&branch)[..] else {
                panic!("{}: {:?}", branch.name, found(&branch))
            };
            close(fold, bouncing_ball::fold(n, e), DIGITS);
            close(doubling, bouncing_ball::doubling(n, e), DIGITS);
        }
    }
}

/// An orbit that sticks forgets all before: its only multiplier is zero.
#[test]
fn the_belts_orbit_has_its_period() {
    for p @ [friction, kinetic, belt] in [[1.0, 0.6, 0.3], [1.0, 0.9, 0.5], [2.0, 0.5, 1.0]] {
        let sticks = belt::stick(friction, kinetic);
        let sticking = 2.0 * (friction - kinetic) / belt;
        let period = belt::period(friction, kinetic, belt);
        let largest = belt::largest(friction, kinetic, belt);
        let durations = [sticking, (period - sticking) * (1.0 + ASIDE)];
        let starts: [&[f64]; 2] = [&[sticks, belt], &[friction, belt]];
        for start in by_both(Reference::Belt, "stick:slower slower:belt", &starts, &durations, &p) {
            let mut orbit = start.solved();
            close(orbit.monitor("period"), period, DIGITS);
            close(orbit.monitor("max_displacement"), largest, DIGITS);
            close(orbit.first("displacement[0]"), sticks, DIGITS);
            has_multipliers(&orbit, &[]);
        }
    }
}

#[test]
fn den_hartogs_motion_has_its_amplitude() {
    for p @ [beta, friction] in [[1.5, 0.2], [0.8, 0.3], [2.5, 0.05]] {
        let x = coulomb::amplitude(beta, friction);
        let (aside, half) = (x * (1.0 + ASIDE), PI / beta);
        let starts: [&[f64]; 2] = [&[aside, 0.0], &[-aside, 0.0]];
        let extras = [coulomb::phase(beta, friction) / beta, half, half];
        for start in by_both(Reference::Coulomb, "backward:low forward:high", &starts, &extras, &p)
        {
            let mut orbit = start.solved();
            close(orbit.monitor("max_displacement"), x, DIGITS);
            close(orbit.monitor("min_displacement"), -x, DIGITS);
        }
    }
}

#[test]
fn the_piecewise_field_has_its_cycle() {
    for p @ [alpha, beta, gamma] in [[1.0, 2.0, 1.5], [0.5, 1.5, 1.0], [1.0, 0.5, 2.0]] {
        let cycle = piecewise::cycle(alpha, beta, gamma);
        let starts: [&[f64]; 2] = [&[0.0, cycle.top * (1.0 + ASIDE)], &[0.0, -cycle.bottom]];
        let durations = [PI, cycle.right];
        let words = "left:rightwards right:leftwards";
        for start in by_both(Reference::Piecewise, words, &starts, &durations, &p) {
            let mut orbit = start.solved();
            close(orbit.monitor("period"), PI + cycle.right, DIGITS);
            close(orbit.first("x2[0]"), cycle.top, DIGITS);
            has_multipliers(&orbit, &[(cycle.multiplier, 0.0)]);
        }
    }
}

#[test]
fn dry_impacts_have_their_place_and_multiplier() {
    for stiffness in [5.0, 5.5] {
        let mut p = DryImpact::DEFAULTS;
        p[0] = stiffness;
        let form = dry_impact::ClosedForm::new(p);
        let [x, _] = form.rest();
        for start in resting(stiffness) {
            let orbit = start.solved();
            close(orbit.first("displacement[0]"), x, DIGITS);
            close(orbit.first("start") + orbit.first("duration[0]"), form.time(x), DIGITS);
            close(orbit.first("velocity[1]"), form.velocity(x), DIGITS);
            has_multipliers(&orbit, &[(form.multiplier(x), 0.0)]);
        }
    }
}

#[test]
fn dry_impacts_fold() {
    let form = dry_impact::ClosedForm::new(DryImpact::DEFAULTS);
    for mut start in resting(5.2) {
        let branch = start.along("stiffness", [4.5, 5.2]).trace().unwrap();
        let [(Kind::LP, fold)] = found(&branch)[..] else { panic!("{:?}", found(&branch)) };
        close(fold, form.fold(), DIGITS);
    }
}
