//! Legs that end on the surface on which they begin.
//!
//! Examples of such legs are the motion of a block that rocks on its other corner, and the contact
//! with a soft stop while it is compressed. A leg that ends on the surface on which it begins also
//! satisfies `h = 0` at its end if its duration is zero. If the duration of such a leg shrinks to
//! zero, the branch of orbits with the leg crosses a branch of orbits on which the leg has zero
//! duration, and the equations are singular. Divided by the duration, the equation is regular: the
//! mean rate of the guard along the leg vanishes.

use super::legs::OrbitLegs;
use crate::core::bvp::Ends;
use crate::core::hybrid::{EventNumber, GuardNumber, Moment, time_scale};
use crate::core::linalg::dot;
use crate::core::problem::gradient;
use num_dual::Dual;

/// H: for a leg shorter than this, in units of the time scale, the mean rate of the guard is its
/// rate at mid-time. The quotient has an error of rounding / duration there, and the two differ by
/// second order in the duration.
const SHORT: f64 = 1e-8;
/// R: two guards are the same function, up to sign and size, if their values and slopes differ by
/// less than this, in units of the slopes: the rounding of a few thousand operations.
const SAME: f64 = 1e-9;

/// For each leg, whether its guard equals the guard of the preceding event, up to sign and size,
/// after the reset. The guards are compared where the legs of a solution, or of a guess, end.
/// `None` if a guard is not finite there.
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

/// Whether a guard, after the reset of the event at which another guard vanishes, equals that guard
/// up to sign and size. `None` if one of them is not finite there.
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

/// Computes the mean rate of a guard along a leg that begins on its surface, from the end of the
/// leg, in units of the time scale. For legs longer than that unit, returns the guard itself.
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
