//! Periodic motions found by simulation: what they go through, and where.
//!
//! Under a forcing of period `T` a motion is looked at once in every period, and is periodic where mode and state
//! are those of `q` periods before, and the same events came in both. Without forcing it is looked at just after
//! the events of one guard.

use super::erased::HybridEquations;
use super::error::HybridError;
use super::event::Event;
use super::repetition::{Nearness, Repetition};
use super::simulation::{HybridFlow, HybridState};
use crate::core::field::Forcing;
use std::ops::ControlFlow;

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
    /// Whether it stands for the rest of a series of infinitely many events, up to their accumulation.
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
    /// How near the motion came back, in units of its largest state.
    pub distance: f64,
}

impl Cycle {
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

/// Why a simulation has found no periodic motion.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum RecurrenceError {
    /// The motion ends.
    #[error(transparent)]
    Motion(#[from] HybridError),
    /// The motion does not repeat.
    #[error(
        "the motion has not repeated in {returns} returns, looked at {most} at a time: it came as near as \
         {distance:.1e} of its largest state where {tolerance:.1e} was asked for; simulate longer, or elsewhere \
         if it is not periodic"
    )]
    Unsettled {
        /// The number of returns.
        returns: usize,
        /// The largest number of returns in a cycle.
        most: usize,
        /// The smallest distance, in units of the largest state.
        distance: f64,
        /// The distance asked for.
        tolerance: f64,
    },
    /// Nothing happens that a motion without forcing could return to.
    #[error(
        "no event came within a time of {longest}: the motion has settled in one mode, whose own orbits are \
         found by simulation of its field"
    )]
    NoEvent {
        /// The time waited.
        longest: f64,
    },
}

/// How long to look for a periodic motion, and when it repeats.
///
/// ```
/// use tangency::core::hybrid::Recurrence;
/// let patient = Recurrence { transient: 1000.0, ..Recurrence::default() };
/// assert!(patient.tolerance == 1e-6 && patient.most == 16);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Recurrence {
    /// The duration of the transient, before which nothing is looked at.
    pub transient: f64,
    /// A motion repeats when it comes back this near, in units of its largest state.
    pub tolerance: f64,
    /// The largest number of periods of the forcing, or of returns to a guard, in a cycle.
    pub most: usize,
    /// How many periods, or returns, to look at.
    pub returns: usize,
    /// The longest time to wait for them without forcing.
    pub longest: f64,
}

impl Default for Recurrence {
    /// A transient of 100, then 1000 returns, up to 16 in a cycle, within a time of 10 000, and a tolerance of
    /// 1e-6.
    fn default() -> Self {
        Recurrence { transient: 100.0, tolerance: 1e-6, most: 16, returns: 1000, longest: 1e4 }
    }
}

impl Recurrence {
    /// Follows a motion until it repeats.
    ///
    /// ```
    /// use tangency::core::hybrid::{HybridFlow, HybridSettings, HybridState, Recurrence};
    /// use tangency::problems::classic::ImpactOscillator;
    /// // Impacts once in every period of the forcing.
    /// let mut flow = HybridFlow::new(&ImpactOscillator, HybridSettings::default())?;
    /// let start = HybridState { mode: ImpactOscillator::FLIGHT, time: 0.0, x: vec![0.0, 0.0] };
    /// let cycle = Recurrence::default().find(&mut flow, start, &[5.0, 2.2, 0.8, 0.1, 1.0])?;
    /// assert_eq!((cycle.count(&ImpactOscillator, "impact"), cycle.periods), (1, 1));
    /// assert!((cycle.duration() - std::f64::consts::TAU / 2.2).abs() < 1e-6);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`RecurrenceError`] if the motion ends, or does not repeat.
    pub fn find(
        &self,
        flow: &mut HybridFlow<f64>,
        start: HybridState<f64>,
        p: &[f64],
    ) -> Result<Cycle, RecurrenceError> {
        match flow.system().forcing() {
            Forcing::Periodic { .. } => self.strobed(flow, start, flow.system().period(p), p),
            Forcing::None => self.returning(flow, start, p),
        }
    }

    /// Looks at the motion once in every period of the forcing.
    fn strobed(
        &self,
        flow: &mut HybridFlow<f64>,
        mut state: HybridState<f64>,
        period: f64,
        p: &[f64],
    ) -> Result<Cycle, RecurrenceError> {
        let phase = state.time;
        let skipped = (self.transient / period).max(0.0) as usize;
        let mut repetition = Repetition::new(self.most, self.tolerance);
        for k in 0..skipped.saturating_add(self.returns) {
            // From the same time in every period: long times have fewer digits.
            state.time = phase;
            let before = state.clone();
            let events = flow.events(&mut state, period, p)?;
            if k < skipped {
                continue;
            }
            events.iter().for_each(|event| repetition.extend(&event.after));
            let guards = events.iter().map(|event| event.guard).collect();
            if let Some(q) = repetition.push(before, guards, &state) {
                state.time = phase;
                let mut cycle = cycle(flow, state, q, period, p)?;
                cycle.distance = repetition.nearness.least;
                return Ok(cycle);
            }
        }
        Err(self.unsettled(repetition.nearness))
    }

    /// Looks at the motion just after every event of the guard that comes first.
    fn returning(
        &self,
        flow: &mut HybridFlow<f64>,
        mut state: HybridState<f64>,
        p: &[f64],
    ) -> Result<Cycle, RecurrenceError> {
        flow.advance(&mut state, self.transient, p, &mut ())?;
        let mut nearness = Nearness::new();
        let (mut events, mut returns, mut found) = (Vec::<Event<f64>>::new(), Vec::new(), None);
        let mut look = |event: &Event<f64>| {
            nearness.extend(&event.after);
            let same = |first: &Event<f64>| (first.guard, first.mode) == (event.guard, event.mode);
            let returned = events.first().is_none_or(same);
            if returned && !event.accumulation {
                let mut recent = returns.iter().rev().take(self.most).copied();
                found = recent.find(|k: &usize| {
                    let old = &events[*k];
                    old.next == event.next
                        && nearness.admit(&old.after, &event.after, self.tolerance)
                });
                returns.push(events.len());
            }
            events.push(event.clone());
            let done = found.is_some() || returns.len() > self.returns;
            if done { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        };
        flow.advance(&mut state, self.longest, p, &mut look)?;
        let Some(first) = found else {
            return Err(match events.is_empty() {
                true => RecurrenceError::NoEvent { longest: self.longest },
                false => self.unsettled(nearness),
            });
        };
        let legs = (first + 1..events.len()).map(|k| leg(&events[k - 1], &events[k], 0.0));
        let (start, distance) = (events[first].time, nearness.least);
        Ok(Cycle { start, legs: legs.collect(), periods: 1, distance })
    }

    fn unsettled(&self, nearness: Nearness) -> RecurrenceError {
        let Recurrence { returns, most, tolerance, .. } = *self;
        RecurrenceError::Unsettled { returns, most, distance: nearness.least, tolerance }
    }
}

/// The legs of `q` periods.
fn cycle(
    flow: &mut HybridFlow<f64>,
    mut state: HybridState<f64>,
    q: usize,
    period: f64,
    p: &[f64],
) -> Result<Cycle, HybridError> {
    let (start, duration) = (state.clone(), period * q as f64);
    let events = flow.events(&mut state, duration, p)?;
    let (first, last) = match (events.first(), events.last()) {
        (Some(first), Some(last)) => (first, last),
        _ => {
            let HybridState { mode, time, x } = start;
            let leg = CycleLeg {
                mode,
                exit: None,
                duration,
                start: x,
                end: state.x,
                accumulation: false,
            };
            return Ok(Cycle { start: time, legs: vec![leg], periods: q, distance: 0.0 });
        }
    };
    let inner = events.windows(2).map(|pair| leg(&pair[0], &pair[1], 0.0));
    let legs = inner.chain([leg(last, first, duration)]).collect();
    Ok(Cycle { start: first.time, legs, periods: q, distance: 0.0 })
}

/// The leg between two events, the second of which is to come so much later.
fn leg(from: &Event<f64>, to: &Event<f64>, later: f64) -> CycleLeg {
    CycleLeg {
        mode: to.mode,
        exit: Some(to.guard),
        duration: to.time + later - from.time,
        start: from.after.clone(),
        end: to.before.clone(),
        accumulation: to.accumulation,
    }
}
