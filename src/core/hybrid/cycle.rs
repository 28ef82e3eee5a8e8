//! Periodic motions as simulation finds them.

use super::erased::HybridEquations;
use super::event::Event;
use super::simulation::HybridState;

/// A leg of a periodic motion: from just after one event to just before the next.
#[derive(Clone, Debug, PartialEq)]
pub struct CycleLeg {
    /// The mode.
    pub mode: usize,
    /// The guard at which it ends; `None` if nothing happens in the whole cycle.
    pub exit: Option<usize>,
    /// How long it lasts.
    pub duration: f64,
    /// The state at its start.
    pub start: Vec<f64>,
    /// The state at its end.
    pub end: Vec<f64>,
    /// Whether it stands for the rest of a series of infinitely many events, up to their
    /// accumulation. The state at its end is that before the last event, in whichever mode that
    /// comes.
    pub accumulation: bool,
}

/// One cycle of a periodic motion, from just after an event on.
#[derive(Clone, Debug, PartialEq)]
pub struct Cycle {
    /// When the first leg begins; under forcing its phase counts.
    pub start: f64,
    /// The legs, the last of which leads to the first.
    pub legs: Vec<CycleLeg>,
    /// The periods of the forcing in a cycle; 1 without forcing.
    pub periods: usize,
    /// How near the motion came back, as [`CycleSearch::tolerance`](crate::core::attractor::CycleSearch::tolerance)
    /// measures it.
    pub distance: f64,
}

impl CycleLeg {
    /// The leg between two events, the second of which is to come so much later.
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
    /// A cycle that begins and ends in these states and lasts so long, over a number of periods of
    /// the forcing, from its events. Without events it is one leg.
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

    /// How long a cycle lasts.
    pub fn duration(&self) -> f64 {
        self.legs.iter().map(|leg| leg.duration).sum()
    }

    /// How many events of one name there are, accumulations not counted.
    pub fn count(&self, system: &dyn HybridEquations, name: &str) -> usize {
        let guards = system.guards();
        let named = |leg: &&CycleLeg| leg.exit.is_some_and(|exit| guards[exit].name == name);
        self.legs.iter().filter(named).filter(|leg| !leg.accumulation).count()
    }
}
