//! Legs that stand for infinitely many events.
//!
//! Such a leg begins just behind an event. Nothing moves on it, and it lasts until the events that
//! follow accumulate, which a motion that follows them tells, with derivatives; so does that motion
//! tell the state from which the next leg begins.

use super::itinerary::Leg;
use super::legs::OrbitLegs;
use crate::core::failure::{Failure, OutOfDomain};
use crate::core::hybrid::{ChatterNumber, Event, HybridEquations, HybridState};
use crate::core::problem::{Domains, Fields};
use crate::core::scalar::Scalar;

/// The field that is zero.
pub(super) struct Still;

impl Domains for Still {
    fn domain_of(&self, _index: usize, _x: &[f64], _p: &[f64]) -> Result<(), OutOfDomain> {
        Ok(())
    }

    fn scales_of(&self, _index: usize, _p: &[f64]) -> Vec<f64> {
        Vec::new()
    }

    fn states_of(&self, _index: usize) -> Vec<String> {
        Vec::new()
    }
}

impl<T: Scalar> Fields<T> for Still {
    fn field_of(&self, _index: usize, _t: T, _x: &[T], _p: &[T], f: &mut [T]) {
        f.fill(T::zero());
    }
}

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

/// Refuses a leg that leads to no accumulation, or to another mode than the itinerary says.
pub(super) fn check_accumulation(
    legs: &OrbitLegs,
    leg: usize,
    times: (f64, f64),
    x: &[f64],
    p: &[f64],
) -> Result<(), Failure> {
    let meant = legs.mode_after(leg);
    let found = accumulation(legs.system(), legs.all()[leg], times, x, p);
    if found.as_ref().is_some_and(|event| event.next == meant) {
        return Ok(());
    }
    let event = legs.all()[leg].exit.map_or("", |guard| &legs.guards[guard].name);
    let to = |mode: usize| format!("lead to `{}`", legs.modes[mode].name);
    let led = found.map_or_else(|| "do not accumulate".into(), |event| to(event.next));
    Err(Failure::Mismatch(format!(
        "the events `{event}` that follow t = {:.6e}, leg {leg}, {led}, and are to accumulate within {:.1e} and {}: let a \
         simulation find the itinerary",
        times.0,
        times.1,
        to(meant)
    )))
}
