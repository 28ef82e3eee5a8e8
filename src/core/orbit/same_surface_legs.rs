//! Legs (parts of an orbit between two events) that end on the surface on which they begin.
//!
//! Examples of such legs are the motion of a block that rocks on its other corner, and the contact
//! with a soft stop while it is compressed. For a leg that ends on the surface on which it begins,
//! the equation `h = 0` at its end is also satisfied if the duration of the leg is zero. If the
//! duration of such a leg shrinks to zero, the branch of orbits with the leg intersects the branch
//! of orbits on which the leg has zero duration, and the equations are singular there. The quotient
//! of the guard `h` at the end of the leg and the duration gives a regular equation: the mean rate
//! of the guard along the leg vanishes.

use super::legs::OrbitLegs;
use crate::core::bvp::Ends;
use crate::core::hybrid::{EventNumber, GuardNumber, Moment, time_scale};
use crate::core::linalg::dot;
use crate::core::problem::gradient;
use num_dual::Dual;

/// Heuristic: for legs (parts of an orbit) with a duration below this value, in units of the time
/// scale, the guard's rate at mid-time is used as the mean rate of the guard. For such short legs,
/// the quotient of guard and duration has a rounding error inversely proportional to the duration,
/// and the rate at mid-time differs from the mean rate only to second order in the duration.
const SHORT: f64 = 1e-8;
/// Rounding: two guards are the same function up to a factor if their values and slopes, after
/// scaling, differ by at most this fraction of the slopes: the rounding error of a few thousand
/// operations.
const SAME: f64 = 1e-9;

/// Returns, for each leg (part of the orbit), whether the guard at its end equals, after the reset
/// and up to a factor, the guard of the preceding event. The two guards are compared at the end of
/// the preceding leg, in a solution or in an initial guess. Returns `None` if a guard is not finite
/// at the end of a preceding leg.
pub(super) fn begins_on_exit(legs: &OrbitLegs, ends: Ends<f64>, q: &[f64]) -> Option<Vec<bool>> {
    let count = legs.all().len();
    let begins = |leg: usize| {
        let last = (leg + count - 1) % count;
        let (before, own) = (legs.all()[last], legs.all()[leg]);
        let (Some(entry), Some(exit)) = (before.exit, own.exit) else { return Some(false) };
        let timed = [entry, exit].iter().any(|guard| legs.guards[*guard].is_timed());
        if before.accumulates || own.accumulates || timed {
            return Some(false);
        }
        let t = legs.layout.time(last, q) + legs.layout.durations(q)[last];
        let (x, p) = (&ends.end[legs.layout.states(last)], legs.layout.p(q));
        let at = Moment { system: legs.system(), mode: before.mode, t, x, p };
        same_guard(at, entry, (own.mode, exit))
    };
    (0..count).map(begins).collect()
}

/// Whether a guard, evaluated after the reset of an event, equals the guard of this event up to a
/// factor. Returns `None` if one of the two guards is not finite.
fn same_guard(at: Moment<f64>, entry: usize, (next, exit): (usize, usize)) -> Option<bool> {
    let Moment { system, mode, t, x, p } = at;
    let mut sizes = system.sizes_of(mode, p);
    sizes.push(time_scale(system, p));
    let slopes = |(by_states, by_time): (Vec<f64>, f64)| -> Vec<f64> {
        let all = by_states.into_iter().chain([by_time]);
        all.zip(&sizes).map(|(slope, size)| slope * size).collect()
    };
    let left = slopes(gradient((t, x), p, |t, x, p| system.guard(entry, mode, t, x, p)));
    let states = system.states_of(next).len();
    let after_reset = |t, x: &[_], p: &[_]| {
        let mut after = vec![Dual::from(0.0); states];
        system.reset(entry, (mode, next), t, x, p, &mut after);
        system.guard(exit, next, t, &after, p)
    };
    let reached = slopes(gradient((t, x), p, after_reset));
    let mut after = vec![0.0; states];
    system.reset(entry, (mode, next), t, x, p, &mut after);
    let values = [at.guard(entry), system.guard(exit, next, t, &after, p)];
    let ratio = dot(&left, &reached) / dot(&left, &left);
    let size = dot(&reached, &reached).sqrt();
    let pairs = left.iter().zip(&reached).chain([(&values[0], &values[1])]);
    let mut apart = pairs.map(|(left, reached)| (reached - ratio * left).abs());
    if !(values[1].is_finite() && size.is_finite() && dot(&left, &left).is_finite()) {
        return None;
    }
    Some(ratio.is_finite() && size > 0.0 && apart.all(|apart| apart <= SAME * size))
}

/// Computes the mean rate, per unit of the time scale, of a guard along a leg (part of an orbit)
/// that begins on the guard's surface, given the end of the leg. For legs longer than the time
/// scale, returns the value of the guard at the end instead.
pub(super) fn mean_rate<T: EventNumber>(end: Moment<T>, guard: usize, duration: T) -> T
where
    Dual<T>: GuardNumber,
{
    let p: Vec<f64> = end.p.iter().map(T::real).collect();
    let (unit, length) = (time_scale(end.system, &p), duration.real().abs());
    if length >= unit {
        return end.guard(guard);
    }
    if length >= SHORT * unit {
        return end.guard(guard) * unit / duration;
    }
    let Moment { system, mode, t, x, p } = end;
    let (half, mut f) = (duration * 0.5, vec![T::zero(); x.len()]);
    system.field(mode, t, x, p, &mut f);
    let x: Vec<T> = x.iter().zip(&f).map(|(x, f)| *x - half * *f).collect();
    Moment { system, mode, t: t - half, x: &x, p }.rate(guard) * unit
}
