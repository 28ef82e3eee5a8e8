//! Events at given times.

use super::erased::{EventNumber, HybridEquations};
use super::event::Event;
use super::event_locator::{INSTANT, LocatedEvent};
use super::system::Guard;
use crate::core::linalg::refill;

/// The guards with events at given times.
pub(super) struct Timed {
    /// The guards of each mode, with the number of their events in a period.
    of_modes: Vec<Vec<(usize, usize)>>,
    /// The last time of each guard's event; a motion begins just after the events at its start. Empty
    /// if there are no events at given times.
    pub fired: Vec<f64>,
}

impl Timed {
    /// Collects the guards with events at given times.
    pub fn among(guards: &[Guard], modes: usize) -> Self {
        let timed = guards.iter().enumerate().filter(|(_, guard)| guard.is_timed());
        let timed: Vec<(usize, &Guard)> = timed.collect();
        let of_mode = |mode| {
            let own = timed.iter().filter(|(_, guard)| guard.ends(mode));
            own.map(|(k, guard)| (*k, guard.per_period)).collect()
        };
        let count = if timed.is_empty() { 0 } else { guards.len() };
        Timed { of_modes: (0..modes).map(of_mode).collect(), fired: vec![0.0; count] }
    }

    /// Whether a mode ends at given times.
    pub fn end(&self, mode: usize) -> bool {
        !self.of_modes[mode].is_empty()
    }

    /// Begins a motion at a time.
    pub fn begin(&mut self, time: f64) {
        self.fired.fill(time);
    }

    /// Records an event.
    pub fn note(&mut self, guard: usize, time: f64) {
        if let Some(fired) = self.fired.get_mut(guard) {
            *fired = time;
        }
    }

    /// Whether a motion has reached its end and all events at that time.
    pub fn is_over<T: EventNumber>(
        &self,
        system: &dyn HybridEquations,
        place: (usize, T, &[T]),
        end: T,
        p: &[T],
    ) -> bool {
        (end - place.1).real() <= 0.0 && self.next(system, place, end, p).is_none()
    }

    /// The next event up to an end, and the time until then; of several simultaneous events, the one
    /// defined first. A time at which the event has occurred already is past.
    pub fn next<T: EventNumber>(
        &self,
        system: &dyn HybridEquations,
        (mode, time, x): (usize, T, &[T]),
        end: T,
        p: &[T],
    ) -> Option<(usize, T)> {
        let mut next: Option<(usize, T)> = None;
        for &(guard, per_period) in &self.of_modes[mode] {
            let interval = system.period(p) / per_period as f64;
            let instant = INSTANT * interval.real();
            let value = system.guard(guard, mode, time, x, p);
            let skipped = (-(value.real() + instant) / interval.real()).ceil();
            let mut left = value + interval * skipped;
            let came = (self.fired[guard] - (time + left).real()).abs() <= instant;
            if left.real() <= instant && came {
                left += interval;
            }
            let within = left.real() <= (end - time).real() + instant;
            if within && next.is_none_or(|(_, other)| left.real() < other.real() - instant) {
                next = Some((guard, left));
            }
        }
        next
    }
}

/// Ends a leg at an immediate event. The state at the event is one Euler step away, which is exact for
/// its derivatives.
pub(super) fn at_once<T: EventNumber>(
    system: &dyn HybridEquations,
    (guard, left): (usize, T),
    (mode, time, x): (usize, T, &[T]),
    p: &[T],
    event: &mut Event<T>,
) -> LocatedEvent<T> {
    refill(&mut event.before, x.iter().copied());
    system.field(mode, time, x, p, &mut event.before);
    for (before, x) in event.before.iter_mut().zip(x) {
        *before = *x + *before * left;
    }
    event.time = time + left;
    LocatedEvent::at_time(guard)
}
