//! Cycles that attract slowly, computed by Newton's method from a motion that nearly repeats.

use super::repetition::{Repetition, StateScales};
use super::section::Section;
use super::stable_point::{SAME, stable_point};
use crate::core::hybrid::{
    Cycle, Event, EventNumber, GuardOf, HybridEquations, HybridFlow, HybridObserver, HybridState,
    Member,
};
use crate::core::ode::Step;
use crate::core::problem::{FieldIn, Watchable};
use num_dual::Dual64;
use std::ops::ControlFlow;

/// Heuristic: if the smallest return distance of a motion is larger than this fraction of the
/// motion's size, the motion does not count as approaching a cycle: it may be chaotic, or still far
/// from the cycle.
const NEARLY: f64 = 1e-3;

/// The way in which a motion is sampled.
#[derive(Clone, Copy)]
pub(super) enum Sampling<'a> {
    /// Sampling once every forcing period of this duration.
    Period(f64),
    /// Sampling just after every event of a guard in a mode, with a longest waiting time;
    /// accumulations of events are excluded.
    Event { guard: usize, mode: usize, longest: f64 },
    /// Sampling on the section through a state, with a longest waiting time.
    Section { longest: f64, scales: &'a StateScales },
}

/// The search for the cycle that a motion approaches slowly.
pub(super) struct SlowCycle<'a> {
    pub system: &'a dyn HybridEquations,
    pub sampling: Sampling<'a>,
    pub p: &'a [f64],
}

impl SlowCycle<'_> {
    /// Returns the stable cycle that the motion approaches, with its minimal period; `None` if
    /// Newton's method does not find a cycle nearby with the same events as the motion.
    pub fn find(&self, flow: &mut HybridFlow<f64>, motion: &Repetition) -> Option<Cycle> {
        let (q, distance, size) = motion.nearest_return()?;
        if distance > NEARLY * size {
            return None;
        }
        let member = Member { state: motion.before(0).clone(), p: self.p.to_vec() };
        let (near, scales) = (&member.state, &motion.scales);
        let mut dual = HybridFlow::<Dual64>::new(self.system, flow.settings.clone()).ok()?;
        let push = &mut |Member { state, p }: &mut Member<Dual64>| {
            self.advance(&mut dual, state, (near, p), &mut Vec::new())
        };
        let (Member { state, .. }, _) = stable_point(push, &member, q, (size, scales))?;
        let mut least = 1;
        while least < q && !(q.is_multiple_of(least) && self.closes(flow, &state, least, scales)) {
            least += 1;
        }
        let approached = motion.approaches(&state.x, least);
        self.cycle(flow, state, least, &motion.numbers(least)).filter(|_| approached)
    }

    /// Advances a state to the next sample of its motion; if motion is sampled on sections, the
    /// section passes through the state `base`.
    fn advance<'f, T: EventNumber>(
        &self,
        flow: &mut HybridFlow<'f, T>,
        state: &mut HybridState<T>,
        (base, p): (&HybridState<f64>, &[T]),
        events: &mut Vec<Event<T>>,
    ) -> Option<()>
    where
        GuardOf<'f>: Watchable<T>,
    {
        let mut next = Next { at: None, section: None, events, sample: None };
        let longest = match self.sampling {
            Sampling::Period(period) => {
                let phase = state.time;
                flow.advance(state, T::constant(period), p, &mut next).ok()?;
                state.time = phase;
                return Some(());
            }
            Sampling::Event { guard, mode, longest } => {
                next.at = Some((guard, mode));
                longest
            }
            Sampling::Section { longest, scales } => {
                next.section = Some(Section::through(self.system, self.p, base, scales));
                longest
            }
        };
        flow.advance(state, T::constant(longest), p, &mut next).ok()?;
        *state = next.sample?;
        Some(())
    }

    /// Whether the motion from a state returns to this state after `q` samples.
    fn closes(
        &self,
        flow: &mut HybridFlow<f64>,
        start: &HybridState<f64>,
        q: usize,
        scales: &StateScales,
    ) -> bool {
        let (mut state, mode) = (start.clone(), start.mode);
        let moved = (0..q)
            .try_for_each(|_| self.advance(flow, &mut state, (start, self.p), &mut Vec::new()));
        let near =
            || scales.distance(mode, &state.x, &start.x) <= SAME * scales.size(mode, &start.x);
        moved.is_some() && state.mode == mode && near()
    }

    /// Returns the cycle of `q` samples that begins in a state; `None` if its events differ from
    /// the expected ones.
    fn cycle(
        &self,
        flow: &mut HybridFlow<f64>,
        start: HybridState<f64>,
        q: usize,
        numbers: &[(usize, bool)],
    ) -> Option<Cycle> {
        let (mut state, mut events) = (start.clone(), Vec::new());
        let periods = match self.sampling {
            Sampling::Period(period) => {
                events = flow.events(&mut state, period * q as f64, self.p).ok()?;
                q
            }
            _ => {
                for _ in 0..q {
                    self.advance(flow, &mut state, (&start, self.p), &mut events)?;
                }
                1
            }
        };
        if !events.iter().map(|event| (event.guard, event.accumulation)).eq(numbers.iter().copied())
        {
            return None;
        }
        // A cycle begins with the event of its first sample, if any.
        if let Sampling::Event { .. } = self.sampling {
            events.rotate_right(1);
            events[0].time = start.time;
        }
        let duration = state.time - start.time;
        Some(Cycle::through(&events, (&start, state.x), duration, periods))
    }
}

/// An observer that finds the next sample of a motion.
struct Next<'e, T> {
    /// The guard and the mode of the event at which motion is sampled.
    at: Option<(usize, usize)>,
    section: Option<Section<T>>,
    events: &'e mut Vec<Event<T>>,
    sample: Option<HybridState<T>>,
}

impl<T: EventNumber> HybridObserver<T> for Next<'_, T> {
    fn step<F: FieldIn<T>>(&mut self, _mode: usize, step: &mut Step<F, T>, end: T) {
        if let Some(section) = &mut self.section {
            self.sample = section.crossing(step, end);
        }
    }

    fn ends(&self) -> bool {
        self.sample.is_some()
    }

    fn event(&mut self, event: &Event<T>) -> ControlFlow<()> {
        self.events.push(event.clone());
        if self.at == Some((event.guard, event.mode)) && !event.accumulation {
            let (mode, time, x) = (event.next, event.time, event.after.clone());
            self.sample = Some(HybridState { mode, time, x });
        }
        // Motion with events is not sampled on sections.
        let lost = self.section.take().is_some();
        if lost || self.ends() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }
}
