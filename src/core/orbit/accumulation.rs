//! Legs (parts of an orbit between two events) that represent infinitely many events, which
//! accumulate in a finite time.
//!
//! A leg that represents infinitely many events begins just after the first of these events. The
//! states of such a leg are constant, and the leg lasts until the following events accumulate. A
//! simulation of the accumulating events gives the duration of the leg and the state at the start
//! of the next leg, both with derivatives.

use super::itinerary::Leg;
use super::legs::OrbitLegs;
use crate::core::failure::OutOfDomain;
use crate::core::hybrid::{ChatterNumber, Event, HybridEquations, HybridState};

/// Computes the accumulation of events that ends a leg (a part of an orbit), given the start time,
/// duration and initial state of the leg.
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

/// Discretisation: infinitely many events count as simultaneous if they occur within this fraction
/// of the orbit's duration, which is the accuracy of the state at the end of the orbit.
const AT_ONCE: f64 = 1e-9;

/// Returns an error if the events of a leg (a part of an orbit) accumulate at the first of these
/// events: the leg then has zero length on every nearby orbit, and its duration has no derivatives.
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
