//! What tolerances of a hybrid motion are relative to.

use super::erased::HybridEquations;
use super::system::Scales;
use crate::core::problem::{Forcing, change_by};
use num_dual::Dual64;

/// The scale of time of a system: the one that it states, or else the time in which the phase of
/// its forcing grows by 1, or else 1.
pub(crate) fn time_scale(system: &dyn HybridEquations, p: &[f64]) -> f64 {
    let of_forcing = || match system.forcing() {
        Forcing::None => 1.0,
        Forcing::Periodic { phase } => system.period(p) / phase,
    };
    let usable = |scale: &f64| scale.is_finite() && *scale > 0.0;
    let unstated = || Some(of_forcing()).filter(usable);
    system.scales(p).time.filter(usable).or_else(unstated).unwrap_or(1.0)
}

/// Whether a system states no scale but 1: those of guards and other functions are 1 then.
pub(super) fn without_scales(system: &dyn HybridEquations, p: &[f64]) -> bool {
    let Scales { time, states } = system.scales(p);
    states.is_empty() && time.is_none_or(|time| time == 1.0)
}

/// The scale of a guard at a place.
pub(crate) fn guard_scale(
    system: &dyn HybridEquations,
    (guard, mode): (usize, usize),
    place: (f64, &[f64]),
    p: &[f64],
) -> f64 {
    scale_at(system, mode, place, p, |t, x, p| system.guard(guard, mode, t, x, p))
}

/// The scale of a decision, the one at a position after an event of a guard in a mode, where states
/// have half theirs.
pub(crate) fn decision_scale(
    system: &dyn HybridEquations,
    (position, guard, mode): (usize, usize, usize),
    p: &[f64],
) -> f64 {
    typical_scale(system, mode, p, |t, x, p| system.decision(position, guard, mode, t, x, p))
}

/// The scale of a function of a mode's states where these have half their scales.
pub(super) fn typical_scale(
    system: &dyn HybridEquations,
    mode: usize,
    p: &[f64],
    value: impl Fn(Dual64, &[Dual64], &[Dual64]) -> Dual64,
) -> f64 {
    if without_scales(system, p) {
        return 1.0;
    }
    let mut x = system.sizes_of(mode, p);
    x.iter_mut().for_each(|x| *x *= 0.5);
    scale_at(system, mode, (0.0, &x), p, value)
}

/// The scale of a function at a place: how much it changes as time and states change by theirs.
fn scale_at(
    system: &dyn HybridEquations,
    mode: usize,
    place: (f64, &[f64]),
    p: &[f64],
    value: impl Fn(Dual64, &[Dual64], &[Dual64]) -> Dual64,
) -> f64 {
    if without_scales(system, p) {
        return 1.0;
    }
    let (time, mut states) = (time_scale(system, p), system.scales_of(mode, p));
    states.resize(place.1.len(), 1.0);
    change_by((time, &states), place, p, value)
}
