//! The scales of a hybrid system, which are the units of its tolerances.

use super::erased::HybridEquations;
use super::system::Scales;
use crate::core::problem::{Forcing, change_by};
use num_dual::Dual64;

/// Returns the time scale of a system: the scale that the system defines, or else the time in which
/// the phase of its forcing grows by 1, or 1 without forcing.
pub(crate) fn time_scale(system: &dyn HybridEquations, p: &[f64]) -> f64 {
    let of_forcing = || match system.forcing() {
        Forcing::None => 1.0,
        Forcing::Periodic { phase } => system.period(p) / phase,
    };
    let usable = |scale: &f64| scale.is_finite() && *scale > 0.0;
    let unstated = || Some(of_forcing()).filter(usable);
    system.scales(p).time.filter(usable).or_else(unstated).unwrap_or(1.0)
}

/// Whether all scales of a system are 1, so that the scales of its guards and other functions are
/// also 1.
pub(super) fn without_scales(system: &dyn HybridEquations, p: &[f64]) -> bool {
    let Scales { time, states } = system.scales(p);
    states.is_empty() && time.is_none_or(|time| time == 1.0)
}

/// Returns the scale of a guard at a time and a state.
pub(crate) fn guard_scale(
    system: &dyn HybridEquations,
    (guard, mode): (usize, usize),
    place: (f64, &[f64]),
    p: &[f64],
) -> f64 {
    scale_at(system, mode, place, p, |t, x, p| system.guard(guard, mode, t, x, p))
}

/// Returns the scale of a decision function for states at half their scales; the function is given
/// by the guard and the mode of an event, and by its index among the decision functions of this
/// event.
pub(crate) fn decision_scale(
    system: &dyn HybridEquations,
    (position, guard, mode): (usize, usize, usize),
    p: &[f64],
) -> f64 {
    typical_scale(system, mode, p, |t, x, p| system.decision(position, guard, mode, t, x, p))
}

/// Returns the scale of a function of a mode's states, evaluated at half the scales of the states.
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

/// Returns the scale of a function at a point: the change of the function when time and states
/// change by their scales.
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
