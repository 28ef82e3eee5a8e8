//! The continuation of a motion after an event, and after an accumulation of events.

use super::chatter::Accumulation;
use super::crowding::Crowd;
use super::erased::EventNumber;
use super::error::HybridError;
use super::event::{Event, HybridObserver};
use super::event_locator::{INSTANT, LocatedEvent};
use super::leg::GuardOf;
use super::simulation::{HybridFlow, HybridState, Run};
use super::support::Surface;
use crate::core::linalg::refill;
use crate::core::ode::NEGATIVE;
use crate::core::problem::Watchable;
use std::ops::ControlFlow;

impl<'a, T: EventNumber> HybridFlow<'a, T>
where
    GuardOf<'a>: Watchable<T>,
{
    /// Processes an event, and the accumulation of such events if the accumulation is near.
    pub(super) fn land<O: HybridObserver<T>>(
        &mut self,
        LocatedEvent { guard, root }: LocatedEvent<T>,
        state: &mut HybridState<T>,
        run: &mut Run<T, O>,
    ) -> Result<ControlFlow<()>, HybridError> {
        (self.event.guard, self.event.mode) = (guard, state.mode);
        (self.event.approach, self.event.accumulation) = (-root.rate.real(), false);
        let tolerance = self.settings.accumulation * self.unit;
        let series = self.series_of(guard, state.mode);
        let Event { time, before, .. } = &self.event;
        let accumulation = self.series[series].push(*time, -root.rate, before, tolerance);
        let time = match accumulation {
            Accumulation::None => None,
            Accumulation::Here => Some(self.event.time),
            Accumulation::At(time) => Some(time),
        };
        self.real_event();
        let time_of_event = self.event.time.real();
        if let Err(left) = self.check_end(self.event.mode, time_of_event) {
            (state.time, state.x) = (self.event.time, self.event.before.clone());
            return Err(left);
        }
        run.statistics.together += usize::from(self.another_vanishes(time_of_event));
        let next = self.system.next_mode(guard, self.event.mode, time_of_event, &self.x, &self.p);
        if self.pass(next, state, run)?.is_break() {
            return Ok(ControlFlow::Break(()));
        }
        self.stands_still(run)?;
        self.crowds(run)?;
        match time.filter(|time| time.real() <= run.end.real()) {
            Some(time) => self.settle(accumulation, time, state, run),
            None => Ok(ControlFlow::Continue(())),
        }
    }

    /// Returns the index of the event series of a guard in a mode.
    pub(super) fn series_of(&self, guard: usize, mode: usize) -> usize {
        mode * self.guards.len() + guard
    }

    /// Copies the real parts of the state before the event to the record of the event.
    fn real_event(&mut self) {
        refill(&mut self.x, self.event.before.iter().map(T::real));
    }

    /// Applies the reset, switches to the next mode and passes the event to the observer.
    pub(super) fn pass<O: HybridObserver<T>>(
        &mut self,
        next: usize,
        state: &mut HybridState<T>,
        run: &mut Run<T, O>,
    ) -> Result<ControlFlow<()>, HybridError> {
        let Some(mode) = self.modes.get(next) else {
            let (after, modes) = (self.after(self.event.guard), self.modes.len());
            (state.time, state.x) = (self.event.time, self.event.before.clone());
            let time = state.time.real();
            return Err(HybridError::NoMode { time, mode: next, modes, after });
        };
        let event = &mut self.event;
        event.next = next;
        event.after.clear();
        event.after.resize(mode.states.len(), T::zero());
        let (guard, modes, time) = (event.guard, (event.mode, next), event.time);
        self.system.reset(guard, modes, time, &event.before, run.p, &mut event.after);
        let [before, after] = [event.before.len(), event.after.len()];
        if after > 0 && before != after && event.after.iter().all(|x| x.real().is_nan()) {
            (state.time, state.x) = (time, event.before.clone());
            let [mode, next] = [modes.0, next].map(|mode| self.modes[mode].name.clone());
            let (time, guard) = (time.real(), self.guards[guard].name.clone());
            return Err(HybridError::NoReset { time, guard, mode, next, before, after });
        }
        (state.mode, state.time) = (next, time);
        state.x.clone_from(&event.after);
        run.statistics.events += 1;
        self.timed.note(guard, time.real());
        let outcome = run.observer.event(event);
        self.inside(state, Some(guard))?;
        Ok(outcome)
    }

    /// Returns an error if too many events occur without an advance of time.
    fn stands_still<O>(&self, run: &mut Run<T, O>) -> Result<(), HybridError> {
        let (time, (since, count)) = (self.event.time.real(), run.crowd.still);
        run.crowd.still =
            if time - since > INSTANT * self.unit { (time, 0) } else { (since, count + 1) };
        if run.crowd.still.1 <= self.settings.at_once {
            return Ok(());
        }
        Err(HybridError::Standstill {
            time,
            mode: self.modes[self.event.mode].name.clone(),
            guard: self.guards[self.event.guard].name.clone(),
            events: run.crowd.still.1,
            span: time - since,
        })
    }

    /// Returns an error if events become ever more frequent.
    fn crowds<O>(&self, run: &mut Run<T, O>) -> Result<(), HybridError> {
        let time = self.event.time.real();
        let Some(interval) = run.crowd.push(time, self.unit) else { return Ok(()) };
        let (mode, guard) = (&self.modes[self.event.mode], &self.guards[self.event.guard]);
        let (mode, guard, events) = (mode.name.clone(), guard.name.clone(), Crowd::events());
        Err(HybridError::Crowded { time, mode, guard, events, interval })
    }

    /// Continues the motion from the accumulation of a guard's events, unless another event of the
    /// mode occurs earlier.
    pub(super) fn settle<O: HybridObserver<T>>(
        &mut self,
        accumulation: Accumulation<T>,
        time: T,
        state: &mut HybridState<T>,
        run: &mut Run<T, O>,
    ) -> Result<ControlFlow<()>, HybridError> {
        let Event { guard, mode, .. } = self.event;
        let (series, here) = (self.series_of(guard, mode), accumulation == Accumulation::Here);
        let before = if here { &self.event.before[..] } else { self.series[series].limit() };
        refill(&mut self.x, before.iter().map(T::real));
        let timed = self.timed.next(self.system, state.place(), time, run.p);
        if !here && (timed.is_some() || self.another_comes_before(time.real())) {
            return Ok(ControlFlow::Continue(()));
        }
        let next = self.system.mode_after_accumulation(guard, mode, time.real(), &self.x, &self.p);
        let Some(next) = next else {
            let unsettled = Err(self.unsettled(time.real()));
            return if here { Ok(ControlFlow::Continue(())) } else { unsettled };
        };
        if !here {
            self.rest(series, time, run.p);
        }
        (self.event.time, self.event.approach, self.event.accumulation) = (time, 0.0, true);
        run.statistics.accumulations += 1;
        self.pass(next, state, run)
    }

    /// Writes the state at the accumulation of a series of events to the event record, as the state
    /// before the event. At the accumulation, a body is exactly at rest on the surface. If the
    /// series were truncated instead, the body would keep a small distance from the surface until
    /// its release.
    fn rest(&mut self, series: usize, time: T, p: &[T]) {
        let Event { guard, mode, .. } = self.event;
        let limit = self.series[series].limit();
        let change = Surface { system: self.system, guard, mode, t: time }.change(limit, p, true);
        // The correction is bounded by the rest of the series, since the extrapolation is not more
        // accurate than that.
        let bounds = limit.iter().zip(&self.event.before).map(|(a, b)| (*a - *b).real().abs());
        let largest = bounds.fold(0.0, f64::max);
        let small = change.iter().all(|change| change.real().abs() <= largest);
        refill(
            &mut self.event.before,
            limit.iter().zip(change).map(|(limit, change)| match small {
                true => *limit + change,
                false => *limit,
            }),
        );
    }

    /// Whether another guard of the mode vanishes at the event, where `x` holds the real parts of the
    /// state before the event.
    fn another_vanishes(&self, time: f64) -> bool {
        let Event { guard, mode, .. } = self.event;
        let mut others = self.watched[mode].iter().filter(|g| **g != guard);
        others.any(|g| {
            let value = self.system.guard(*g, mode, time, &self.x, &self.p);
            value.abs() <= NEGATIVE * self.scale_of(*g, mode, time)
        })
    }

    /// Whether another guard of the mode is negative at the accumulation, where `x` holds the real
    /// parts of the state at the accumulation.
    fn another_comes_before(&self, time: f64) -> bool {
        let Event { guard, mode, .. } = self.event;
        let mut others = self.watched[mode].iter().filter(|g| **g != guard);
        others.any(|g| self.system.guard(*g, mode, time, &self.x, &self.p) < 0.0)
    }

    fn unsettled(&self, time: f64) -> HybridError {
        let Event { guard, mode, .. } = self.event;
        let series = &self.series[self.series_of(guard, mode)];
        HybridError::Accumulation {
            time,
            mode: self.modes[mode].name.clone(),
            guard: self.guards[guard].name.clone(),
            events: series.events,
            ratio: series.ratio.real(),
            interval: series.interval.real(),
        }
    }
}
