//! Events at given times: when the next one comes.

use super::erased::{EventNumber, HybridEquations};
use super::event::Event;
use super::event_locator::{INSTANT, LocatedEvent};
use super::system::Guard;
use crate::core::linalg::refill;

/// The guards whose events come at given times.
pub(super) struct Timed {
    /// For each mode the guards, with the number of their events in a period.
    of_modes: Vec<Vec<(usize, usize)>>,
    /// When each guard's event came last; a motion begins just after the events at its start. Empty
    /// if no event comes at given times.
    pub fired: Vec<f64>,
}

impl Timed {
    /// Those among the guards of a system.
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

    /// Notes an event.
    pub fn note(&mut self, guard: usize, time: f64) {
        if let Some(fired) = self.fired.get_mut(guard) {
            *fired = time;
        }
    }

    /// Whether a motion, in a mode at a time in a state, has come to its end and to all events at that
    /// time.
    pub fn is_over<T: EventNumber>(
        &self,
        system: &dyn HybridEquations,
        place: (usize, T, &[T]),
        end: T,
        p: &[T],
    ) -> bool {
        (end - place.1).real() <= 0.0 && self.next(system, place, end, p).is_none()
    }

    /// The next event that comes up to an end, and the time until then; of several that come
    /// together, the one stated first. A time at which an event has come is past.
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

/// Ends a leg at an event that comes at once: the state there is one step of Euler's method away,
/// which is exact for its derivatives.
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
