//! Legs that stand for infinitely many events.
//!
//! Such a leg begins just behind an event. Nothing moves on it, and it lasts until the events that
//! follow accumulate, which a motion that follows them tells, with derivatives; so does that motion
//! tell the state from which the next leg begins.

use super::itinerary::Leg;
use super::legs::OrbitLegs;
use crate::core::failure::OutOfDomain;
use crate::core::hybrid::{ChatterNumber, Event, HybridEquations, HybridState};

/// The accumulation that ends a leg which begins at a time in a state, and is to last as long as
/// given.
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

/// (D) Infinitely many events within this part of the orbit are simultaneous: a state at its end is
/// not known better.
const AT_ONCE: f64 = 1e-9;

/// Refuses events that accumulate at their first one: a leg of the ones that follow has no length on
/// any orbit nearby, and its duration has no derivatives.
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
        "the events {mode}:{} accumulate at the first one, as with a restitution of 0: there is no rebound; let the event \
         itself lead to the mode that follows the accumulation, as with `next: \"{rest}\"` in a text model",
        guard.name
    );
    Err(OutOfDomain::new(format!("the duration of {mode}:{}+", guard.name), lasts, remedy))
}
