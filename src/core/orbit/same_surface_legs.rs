//! Legs that end on the surface on which they begin.
//!
//! Such a leg, as that of a block which rocks on its other corner, or that in which a soft stop is
//! pressed, satisfies `h = 0` at its end with no duration, too: where it vanishes, orbits that have
//! the leg cross others that have it with no duration, and the equations are singular. Divided by
//! the duration they are regular: what vanishes is the mean rate of the guard along the leg.

use super::hybrid::HybridOrbit;
use crate::core::bvp::Ends;
use crate::core::hybrid::{EventNumber, GuardNumber, Moment, gradient, time_scale};
use crate::core::vector::dot;
use num_dual::Dual;

/// H: the guard of a leg that is shorter, in units of the scale of time, has its mean rate
/// half-way: the quotient has an error of rounding / duration there, the difference of both is of
/// second order in the duration.
const SHORT: f64 = 1e-8;
/// R: two guards are the same function, up to sign and size, if their values and slopes differ by
/// less than this, in units of the slopes: the rounding of a few thousand operations.
const SAME: f64 = 1e-9;

impl HybridOrbit {
    /// For each leg, whether its event has the guard of the preceding event, up to sign and size,
    /// after the reset. The guards are compared where the legs of a solution, or of a guess, end.
    /// `None` if a guard is not finite there.
    pub(super) fn begins_on_exit(&self, ends: Ends<f64>, q: &[f64]) -> Option<Vec<bool>> {
        let legs = self.legs();
        let begins = |leg: usize| {
            let last = (leg + legs.len() - 1) % legs.len();
            let (before, own) = (legs[last], legs[leg]);
            let (Some(entry), Some(exit)) = (before.exit, own.exit) else { return Some(false) };
            if before.accumulates || own.accumulates {
                return Some(false);
            }
            let (system, p, x) = (self.system(), self.split(q).0, &ends.end[self.of_leg(last)]);
            let t = self.time(last, q) + self.durations(self.split(q).1)[last];
            let mut sizes = system.sizes_of(before.mode, p);
            sizes.push(time_scale(system, p));
            let slopes = |(by_states, by_time): (Vec<f64>, f64)| -> Vec<f64> {
                let all = by_states.into_iter().chain([by_time]);
                all.zip(&sizes).map(|(slope, size)| slope * size).collect()
            };
            let left =
                slopes(gradient((t, x), p, |t, x, p| system.guard(entry, before.mode, t, x, p)));
            let after_reset = |t, x: &[_], p: &[_]| {
                let mut after = vec![Dual::from(0.0); self.modes[own.mode].states.len()];
                system.reset(entry, (before.mode, own.mode), t, x, p, &mut after);
                system.guard(exit, own.mode, t, &after, p)
            };
            let reached = slopes(gradient((t, x), p, after_reset));
            let mut after = vec![0.0; self.modes[own.mode].states.len()];
            system.reset(entry, (before.mode, own.mode), t, x, p, &mut after);
            let values = [
                system.guard(entry, before.mode, t, x, p),
                system.guard(exit, own.mode, t, &after, p),
            ];
            let ratio = dot(&left, &reached) / dot(&left, &left);
            let size = dot(&reached, &reached).sqrt();
            let pairs = left.iter().zip(&reached).chain([(&values[0], &values[1])]);
            let mut apart = pairs.map(|(left, reached)| (reached - ratio * left).abs());
            if !(values[1].is_finite() && size.is_finite() && dot(&left, &left).is_finite()) {
                return None;
            }
            Some(ratio.is_finite() && size > 0.0 && apart.all(|apart| apart <= SAME * size))
        };
        (0..legs.len()).map(begins).collect()
    }
}

/// The mean rate of a guard along a leg that begins on its surface, from the end of the leg, in
/// units of the scale of time; of longer legs than this unit the guard itself.
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
