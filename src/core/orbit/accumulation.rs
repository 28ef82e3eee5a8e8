//! Legs that represent infinitely many events, which accumulate in a finite time.
//!
//! Such a leg begins just after an event. Its states are constant, and it lasts until the following
//! events accumulate. A simulation of these events gives the duration of the leg and the state at
//! the start of the next leg, both with derivatives.

use super::itinerary::Leg;
use super::legs::OrbitLegs;
use crate::core::failure::OutOfDomain;
use crate::core::hybrid::{ChatterNumber, Event, HybridEquations, HybridState};

/// Computes the accumulation that ends a leg, from the start time, duration and initial state of
/// the leg.
pub(super) fn accumulation<T: ChatterNumber>(
    system: &dyn HybridEquations,
    leg: Leg,
    (begins, lasts): (T, T),
    x: &[T],
    p: &[T],
) -> Option<Event<T>> {
    let start = HybridState { mode: leg.mode, time: begins, x: x.to_vec() };
    T::accumulated(system, leg.exit?, start, lasts.real(), p)
}

/// (D) Infinitely many events within this fraction of the orbit are simultaneous: the state at the
/// end of the orbit is no more accurate.
const AT_ONCE: f64 = 1e-9;

/// Rejects events that accumulate at their first one: the leg of the following events has zero
/// length on every nearby orbit, and its duration has no derivatives.
pub(super) fn check_rebound(
    orbit: &OrbitLegs,
    leg: usize,
    lasts: f64,
    whole: f64,
) -> Result<(), OutOfDomain> {
    let Leg { mode, exit: Some(guard), accumulates: true } = orbit.all()[leg] else {
        return Ok(());
    };
    if lasts > AT_ONCE * whole {
        return Ok(());
    }
    let (mode, guard) = (&orbit.modes[mode].name, &orbit.guards[guard]);
    let rest = guard.accumulates_to.map_or("contact", |mode| orbit.modes[mode].name.as_str());
    let remedy = format!(
        "the events {mode}:{} accumulate at the first event, because the motion does not rebound, \
         as with a coefficient of restitution of 0; let the event lead to the mode that follows \
         the accumulation, with `next: \"{rest}\"` in a text model",
        guard.name
    );
    Err(OutOfDomain::new(format!("the duration of {mode}:{}+", guard.name), lasts, remedy))
}
