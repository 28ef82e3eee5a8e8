//! Events at given times: when the next one comes.

use super::erased::EventNumber;
use super::event_locator::{INSTANT, LocatedEvent};
use super::leg::GuardOf;
use super::simulation::{HybridFlow, HybridState};
use crate::core::problem::Watchable;

impl<'a, T: EventNumber> HybridFlow<'a, T>
where
    GuardOf<'a>: Watchable<T>,
{
    /// Whether a motion has come to its end, and to all events at that time.
    pub(super) fn is_over(&self, state: &HybridState<T>, end: T, p: &[T]) -> bool {
        (end - state.time).real() <= 0.0 && self.timed_within(state, end, p).is_none()
    }

    /// The next event at a given time that comes up to an end, and the time until then; of several
    /// that come together, the one stated first. A time at which an event has come is past.
    pub(super) fn timed_within(
        &self,
        state: &HybridState<T>,
        end: T,
        p: &[T],
    ) -> Option<(usize, T)> {
        let HybridState { mode, time, x } = state;
        let mut next: Option<(usize, T)> = None;
        for &guard in &self.timed[*mode] {
            let interval = self.system.period(p) / self.guards[guard].per_period as f64;
            let instant = INSTANT * interval.real();
            let value = self.system.guard(guard, *mode, *time, x, p);
            let skipped = (-(value.real() + instant) / interval.real()).ceil();
            let mut left = value + interval * skipped;
            let came = (self.fired[guard] - (*time + left).real()).abs() <= instant;
            if left.real() <= instant && came {
                left += interval;
            }
            let within = left.real() <= (end - *time).real() + instant;
            if within && next.is_none_or(|(_, other)| left.real() < other.real() - instant) {
                next = Some((guard, left));
            }
        }
        next
    }

    /// The event at a given time if it comes at once: the state there is one step of Euler's method
    /// away, which is exact for its derivatives.
    pub(super) fn timed_at_once(
        &mut self,
        timed: Option<(usize, T)>,
        HybridState { mode, time, x }: &HybridState<T>,
        p: &[T],
    ) -> Option<LocatedEvent<T>> {
        let (guard, left) = timed.filter(|(_, left)| left.real() <= INSTANT * self.unit)?;
        let before = &mut self.event.before;
        before.clone_from(x);
        self.system.field(*mode, *time, x, p, before);
        for (before, x) in before.iter_mut().zip(x) {
            *before = *x + *before * left;
        }
        self.event.time = *time + left;
        Some(LocatedEvent::at_time(guard))
    }
}
