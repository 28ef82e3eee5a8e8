//! Legs that end on the surface on which they begin.
//!
//! Such a leg, as that of a block which rocks on its other corner, or that in which a soft stop is
//! pressed, satisfies `h = 0` at its end with no duration, too: where it vanishes, orbits that have
//! the leg cross others that have it with no duration, and the equations are singular. Divided by
//! the duration they are regular: what vanishes is the mean rate of the guard along the leg.

use super::itinerary::Itinerary;
use crate::core::hybrid::{EventNumber, GuardNumber, HybridEquations, Mode, Moment, time_scale};
use num_dual::Dual;

/// The guard of a leg that is shorter, in units of the scale of time, has its mean rate half-way:
/// the quotient is rounding, and the difference of both, of second order in the duration, is less.
const SHORT: f64 = 1e-8;
/// Values of guards at places where they are compared differ by no more, in units of the larger
/// one.
const SAME: f64 = 1e-9;
/// Places at which guards are compared: what is on one surface everywhere is there.
const PLACES: usize = 4;

/// Of each leg, whether its event has the guard of the one before, but for its sign and size, after
/// the reset.
pub(super) fn returning(
    system: &dyn HybridEquations,
    itinerary: &Itinerary,
    modes: &[Mode],
) -> Vec<bool> {
    let legs = &itinerary.legs;
    let returns = |leg: usize| {
        let before = legs[(leg + legs.len() - 1) % legs.len()];
        let (Some(entry), Some(exit)) = (before.exit, legs[leg].exit) else { return false };
        if before.accumulates || legs[leg].accumulates {
            return false;
        }
        let mode = legs[leg].mode;
        let ratio = |place: usize| {
            let numbers = |count: usize, salt: usize| {
                (0..count).map(move |k| 0.1 + 0.8 * scattered(place + PLACES * (k + 8 * salt)))
            };
            let x: Vec<f64> = numbers(modes[before.mode].states.len(), 1).collect();
            let p: Vec<f64> = numbers(system.parameters().len(), 2).collect();
            let t = scattered(place);
            let mut after = vec![0.0; modes[mode].states.len()];
            system.reset(entry, (before.mode, mode), t, &x, &p, &mut after);
            let left = system.guard(entry, before.mode, t, &x, &p);
            system.guard(exit, mode, t, &after, &p) / left
        };
        let first = ratio(0);
        let same = |place| (ratio(place) - first).abs() <= SAME * first.abs();
        first.is_finite() && first != 0.0 && (1..PLACES).all(same)
    };
    (0..legs.len()).map(returns).collect()
}

/// A number between 0 and 1 for each index, by the golden ratio.
fn scattered(index: usize) -> f64 {
    (0.5 + index as f64 * 0.618_033_988_749_894_9).fract()
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
