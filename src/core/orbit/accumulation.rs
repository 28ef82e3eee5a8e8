//! Legs that stand for infinitely many events.
//!
//! Such a leg begins just behind an event. Nothing moves on it, and it lasts until the events that
//! follow accumulate, which a motion that follows them tells, with derivatives; so does that motion
//! tell the state from which the next leg begins.

use super::itinerary::Leg;
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
