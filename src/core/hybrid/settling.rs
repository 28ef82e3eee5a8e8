//! Where motion goes on when events have accumulated.

use super::chatter::Accumulation;
use super::erased::EventNumber;
use super::error::HybridError;
use super::event::{Event, HybridObserver};
use super::leg::GuardOf;
use super::simulation::{HybridFlow, HybridState, Run};
use crate::core::watch::Watchable;
use std::ops::ControlFlow;

impl<'a, T: EventNumber> HybridFlow<'a, T>
where
    GuardOf<'a>: Watchable<T>,
{
    /// Goes on from the accumulation of the events of a guard, unless another event of its mode comes before.
    pub(super) fn settle<O: HybridObserver<T>>(
        &mut self,
        accumulation: Accumulation<T>,
        time: T,
        state: &mut HybridState<T>,
        run: &mut Run<T, O>,
    ) -> Result<ControlFlow<()>, HybridError> {
        let Event { guard, mode, .. } = self.event;
        let (series, here) = (self.series_of(guard, mode), accumulation == Accumulation::Here);
        let before = if here { &self.event.before } else { &self.series[series].limit };
        self.x.clear();
        self.x.extend(before.iter().map(T::real));
        if !here && self.another_comes_before(time.real()) {
            return Ok(ControlFlow::Continue(()));
        }
        let next = self.system.mode_after_accumulation(guard, mode, time.real(), &self.x, &self.p);
        let Some(next) = next else {
            let unsettled = Err(self.unsettled(time.real()));
            return if here { Ok(ControlFlow::Continue(())) } else { unsettled };
        };
        if !here {
            self.event.before.clone_from(&self.series[series].limit);
        }
        (self.event.time, self.event.approach, self.event.accumulation) = (time, 0.0, true);
        run.statistics.accumulations += 1;
        self.pass(next, state, run)
    }

    /// Whether another guard of the mode is negative at the accumulation, the real parts of which are in `x`.
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
