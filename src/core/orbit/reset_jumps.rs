//! Detection of discontinuous resets; a branch of orbits cannot be continued beyond an orbit at
//! which a reset is discontinuous.

use super::event_cascade::{NUDGE, UNMOVED, moved_state};
use super::known_orbit::KnownOrbit;
use super::legs::OrbitLegs;
use crate::core::bvp::Ends;
use crate::core::failure::Failure;
use crate::core::hybrid::{Moment, time_scale};
use crate::core::system::Jump;

/// Rounding: the number of bisections: the last interval is smaller than the rounding error, even
/// if bisection starts between points that are one minimal step apart.
const HALVINGS: usize = 30;

/// Returns the first discontinuity of a reset between two orbits; the states and times of their
/// events are interpolated linearly.
pub(super) fn jump_between(legs: &OrbitLegs, [from, to]: [(Ends<f64>, &[f64]); 2]) -> Option<Jump> {
    let pairs = legs.events(from.0, from.1).zip(legs.events(to.0, to.1));
    let jumps =
        pairs.filter_map(|((leg, guard, a), (.., b))| jump_of_reset(legs, (leg, guard), [a, b]));
    jumps.min_by(|a, b| a.share.total_cmp(&b.share))
}

/// Returns an error if a reset is discontinuous at an event of the orbit.
pub(super) fn check_resets(orbit: &KnownOrbit) -> Result<(), Failure> {
    for (leg, it) in orbit.legs.all().iter().enumerate() {
        let Some(guard) = it.exit.filter(|_| !it.accumulates) else { continue };
        let (t, x) = orbit.end_of(leg)?;
        let at = orbit.moment(leg, t, &x);
        let mut steps = at.system.sizes_of(at.mode, at.p);
        steps.push(time_scale(at.system, at.p));
        for (k, step) in steps.iter().enumerate() {
            let moved = |way: f64| {
                let (mut t, mut x, by) = (t, x.clone(), way * NUDGE * step);
                *x.get_mut(k).unwrap_or(&mut t) += by;
                (t, x)
            };
            let [a, b] = [-1.0, 1.0].map(moved);
            let beside = [&a, &b].map(|(t, x)| Moment { t: *t, x, ..at });
            if let Some(jump) = jump_of_reset(orbit.legs, (leg, guard), beside) {
                return Err(Failure::Undetermined(format!(
                    "{jump}: the orbits on the two sides of the jump are not connected; start the \
                     branch on the other side from a simulated cycle (`start: Simulated()`, in Rust `orbit::from_cycle`)"
                )));
            }
        }
    }
    Ok(())
}

/// Returns the discontinuity of the reset at the end of a leg, between two states before the event.
fn jump_of_reset(
    legs: &OrbitLegs,
    (leg, guard): (usize, usize),
    [from, to]: [Moment<f64>; 2],
) -> Option<Jump> {
    let (mode, next, system) = (from.mode, legs.mode_after(leg), legs.system());
    let states = &legs.modes[next].states;
    let after = |share: f64| {
        let between = |(a, b): (&f64, &f64)| a + share * (b - a);
        let [x, p] = [(from.x, to.x), (from.p, to.p)]
            .map(|(a, b)| a.iter().zip(b).map(between).collect::<Vec<f64>>());
        let mut after = vec![0.0; states.len()];
        system.reset(guard, (mode, next), between((&from.t, &to.t)), &x, &p, &mut after);
        after
    };
    let distance =
        |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    // Bisection keeps the half across which the reset changes more.
    let (mut low, mut high, mut length) = ((0.0, after(0.0)), after(1.0), 1.0);
    let whole = distance(&low.1, &high);
    for _ in 0..HALVINGS {
        length *= 0.5;
        let middle = after(low.0 + length);
        match distance(&low.1, &middle) < distance(&middle, &high) {
            true => low = (low.0 + length, middle),
            false => high = middle,
        }
    }
    let (share, before) = low;
    let jumps = distance(&before, &high) > 0.5 * whole;
    let state = moved_state(system, next, [&before, &high], UNMOVED, from.p).filter(|_| jumps)?;
    Some(Jump {
        share,
        event: legs.guards[guard].name.clone(),
        state: states[state].clone(),
        states: [before[state], high[state]],
    })
}
