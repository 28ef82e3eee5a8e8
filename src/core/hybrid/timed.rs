//! Events at given times.

use super::erased::{EventNumber, HybridEquations};
use super::event::Event;
use super::event_locator::{INSTANT, LocatedEvent};
use super::system::Guard;
use crate::core::linalg::refill;

/// The guards whose events occur at given times.
pub(super) struct Timed {
    /// The guards of each mode whose events occur at given times, with the number of their events
    /// in a period.
    of_modes: Vec<Vec<(usize, usize)>>,
    /// The last time of each guard's event; since a motion begins just after the events at its start,
    /// the initial value is the start time. The list is empty if the system has no events at given
    /// times.
    pub fired: Vec<f64>,
}

impl Timed {
    /// Collects the guards whose events occur at given times.
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

    /// Whether a mode can end at given times.
    pub fn end(&self, mode: usize) -> bool {
        !self.of_modes[mode].is_empty()
    }

    /// Resets the event times to the start time of a motion.
    pub fn begin(&mut self, time: f64) {
        self.fired.fill(time);
    }

    /// Records an event.
    pub fn note(&mut self, guard: usize, time: f64) {
        if let Some(fired) = self.fired.get_mut(guard) {
            *fired = time;
        }
    }

    /// Whether a motion has reached its end time and processed all events at that time.
    pub fn is_over<T: EventNumber>(
        &self,
        system: &dyn HybridEquations,
        place: (usize, T, &[T]),
        end: T,
        p: &[T],
    ) -> bool {
        (end - place.1).real() <= 0.0 && self.next(system, place, end, p).is_none()
    }

    /// Returns the guard of the next event at a given time before `end`, and the time left until the
    /// event; if several events are simultaneous, the guard that is defined first. A time at which
    /// the event of a guard has already occurred counts as past.
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

/// Ends a leg (the part of the motion between two events) at an event that occurs immediately. The
/// state at the event is computed by one Euler step, whose length is nearly zero, so that the step
/// is exact for the derivatives of the state.
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
