//! Periodic motions found by simulation.

use super::erased::HybridEquations;
use super::event::Event;
use super::simulation::HybridState;

/// A leg of a periodic motion, from just after one event to just before the next event.
#[derive(Clone, Debug, PartialEq)]
pub struct CycleLeg {
    /// The mode.
    pub mode: usize,
    /// The guard at which the leg ends; `None` if the cycle has no events.
    pub exit: Option<usize>,
    /// The duration.
    pub duration: f64,
    /// The state at the start of the leg.
    pub start: Vec<f64>,
    /// The state at the end of the leg.
    pub end: Vec<f64>,
    /// Whether the leg represents the rest of a series of infinitely many events, up to the
    /// accumulation of the events. If a leg represents the rest of a series of infinitely many
    /// events, `end` is the state just before the event that represents the accumulation, in the
    /// mode of that event.
    pub accumulation: bool,
}

/// One cycle of a periodic motion, which begins just after an event.
#[derive(Clone, Debug, PartialEq)]
pub struct Cycle {
    /// The time at which the first leg begins; in a forced system this time determines the phase of
    /// the forcing.
    pub start: f64,
    /// The legs of the cycle in order; the last leg leads to the first.
    pub legs: Vec<CycleLeg>,
    /// The number of forcing periods in a cycle; 1 in a system without forcing.
    pub periods: usize,
    /// The distance between the start and the end of the cycle, in the units of
    /// [`CycleSearch::tolerance`](crate::core::attractor::CycleSearch::tolerance).
    pub distance: f64,
}

impl CycleLeg {
    /// Creates the leg (the part of the motion between two events) from its two events; the time of
    /// the second event is delayed by `later`.
    fn between(from: &Event<f64>, to: &Event<f64>, later: f64) -> Self {
        CycleLeg {
            mode: from.next,
            exit: Some(to.guard),
            duration: to.time + later - from.time,
            start: from.after.clone(),
            end: to.before.clone(),
            accumulation: to.accumulation,
        }
    }
}

impl Cycle {
    /// Creates a cycle from its events, given the states at its start and end, its duration and its
    /// number of forcing periods. A cycle without events consists of one leg.
    pub(in crate::core) fn through(
        events: &[Event<f64>],
        (start, end): (&HybridState<f64>, Vec<f64>),
        duration: f64,
        periods: usize,
    ) -> Self {
        let (Some(first), Some(last)) = (events.first(), events.last()) else {
            let HybridState { mode, time, x: start } = start.clone();
            let leg = CycleLeg { mode, exit: None, duration, start, end, accumulation: false };
            return Cycle { start: time, legs: vec![leg], periods, distance: 0.0 };
        };
        let inner = events.windows(2).map(|pair| CycleLeg::between(&pair[0], &pair[1], 0.0));
        let legs = inner.chain([CycleLeg::between(last, first, duration)]).collect();
        Cycle { start: first.time, legs, periods, distance: 0.0 }
    }

    /// Returns the duration of the cycle.
    pub fn duration(&self) -> f64 {
        self.legs.iter().map(|leg| leg.duration).sum()
    }

    /// Returns the number of events with this name in the cycle, without accumulations.
    pub fn count(&self, system: &dyn HybridEquations, name: &str) -> usize {
        let guards = system.guards();
        let named = |leg: &&CycleLeg| leg.exit.is_some_and(|exit| guards[exit].name == name);
        self.legs.iter().filter(named).filter(|leg| !leg.accumulation).count()
    }
}
