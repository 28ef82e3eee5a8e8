//! Search for periodic motions by simulation.
//!
//! Under a forcing of period `T`, a motion is sampled once a period; if events coincide with the
//! sampling times, these times are shifted to a later phase of the period. Without forcing, a
//! motion is sampled just after every event of one guard. Before the first event, an unforced
//! motion is sampled where it crosses the plane normal to it at one of its points `x₀`,
//!
//! ```text
//!     ⟨f(x₀), x − x₀⟩ = 0,  increasing.
//! ```
//!
//! From time to time the plane at which motion is sampled is replaced by a plane through a later
//! point of the motion, since transients continue to decay. A motion counts as periodic if its mode
//! and state equal the mode and state `q` samples earlier, and if its last `q` samples have the
//! same events as the `q` samples before them. Without forcing, the time between two samples at
//! which the motion repeats is the period. If a motion approaches a cycle so slowly that its
//! samples do not repeat, the cycle is computed by Newton's method.

use super::repetition::{Repetition, StateScales};
use super::section::Section;
use super::slow_cycle::{Sampling, SlowCycle};
use crate::core::equilibrium::{equilibrium_near, place_in_words};
use crate::core::hybrid::{
    Cycle, Event, HybridEquations, HybridError, HybridFlow, HybridObserver, HybridState, time_scale,
};
use crate::core::ode::Step;
use crate::core::problem::{FieldIn, Forcing};
use std::ops::ControlFlow;

/// Heuristic: an event counts as coincident with a sample if the time between them is less than
/// this fraction of the period; the motion is then sampled at a later phase.
const AT_EVENT: f64 = 1e-3;

/// Reasons why a simulation found no periodic motion.
#[derive(Clone, Debug, PartialEq, miette::Diagnostic, thiserror::Error)]
#[non_exhaustive]
pub enum CycleSearchError {
    /// The motion ends.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Motion(#[from] HybridError),
    /// The motion does not repeat within the maximal number of returns to its section or sampling
    /// event.
    #[error(
        "no cycle was found in {returns} returns of the motion: the state at a return was compared \
         with the states at up to {max_period} earlier returns, and the smallest distance was \
         {distance:.1e}, above the tolerance {tolerance:.1e}"
    )]
    #[diagnostic(help(
        "simulate longer (`--settle`, `CycleSearch::transient`), or start at another state; if the \
         motion is not periodic, sweep the parameter (`tangency sweep`)"
    ))]
    Unsettled {
        /// The number of returns of the motion that were compared.
        returns: usize,
        /// The maximal number of returns in a cycle.
        max_period: usize,
        /// The smallest distance between two compared states, in the units of
        /// [`CycleSearch::tolerance`].
        distance: f64,
        /// The largest distance between two states that count as equal.
        tolerance: f64,
    },
    /// The motion decays to a state of rest: the distance that it travels between two returns
    /// shrinks to zero.
    #[error(
        "the motion comes to rest at t = {time:.6}: in units of the scales, the diameter of the \
         motion between two returns is {last:.1e}, and the largest diameter before was \
         {largest:.1e}; simulating longer does not help"
    )]
    #[diagnostic(help(
        "start the simulation at another state, or trace the equilibrium instead of a cycle"
    ))]
    Rest {
        /// The time at which the motion last returned to its section or sampling event.
        time: f64,
        /// The largest distance that the motion reached, during its last return, from the state at
        /// the start of this return, in units of the states' scales.
        last: f64,
        /// The larger of two lengths, in units of the states' scales: the largest diameter of the
        /// motion during an earlier return, and the distance of the motion from its start.
        largest: f64,
    },
    /// The motion comes to rest at an equilibrium.
    #[error(
        "the motion comes to rest at t = {time:.6}, {place}: simulating longer \
         does not help"
    )]
    #[diagnostic(help(
        "start the simulation at another state, or trace the equilibrium from the final state \
         (`solution: equilibrium` in a scene)"
    ))]
    Equilibrium {
        /// The time at the end of the simulation, at which the motion rests.
        time: f64,
        /// A text with the states at which the motion rests and, if the system has several modes,
        /// the mode.
        place: String,
        /// The mode.
        mode: usize,
        /// The equilibrium.
        states: Vec<f64>,
    },
    /// A motion without forcing returns neither to an event nor to a section.
    #[error(
        "the motion returned neither to an event nor to a Poincaré section within a time of {0}: \
         the motion is slow, or escapes to infinity"
    )]
    #[diagnostic(help(
        "for a slow motion, simulate longer (a longer `transient`, `--settle`); or start elsewhere"
    ))]
    NoReturn(f64),
}

/// Heuristic: a motion counts as coming to rest if its diameter during a return shrinks to this
/// fraction of a reference length: its diameter during an earlier return, or its distance from the
/// start.
const SHRUNK: f64 = 1e-6;

/// Rounding: a state is at rest if it differs from its equilibrium by less than this fraction of its
/// size.
const STILL: f64 = 1e-9;

/// The settings of the search for periodic motion by simulation.
///
/// The search applies to any hybrid system, and to vector fields by means of
/// [`orbit::Smooth`](crate::core::orbit::Smooth). Cycles are found with their minimal period.
///
/// ```
/// use tangency::core::attractor::CycleSearch;
/// let patient = CycleSearch { transient: 1000.0, ..CycleSearch::default() };
/// assert!(patient.tolerance == 1e-6 && patient.max_period == 16);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CycleSearch {
    /// The duration of the transient, in units of time, before the search begins.
    pub transient: f64,
    /// The largest distance between two states that count as equal, in units of the largest state;
    /// for motion without events, in units of the diameter of the motion. The continuation of a
    /// branch corrects the cycle to a smaller tolerance.
    pub tolerance: f64,
    /// The maximal number of forcing periods in a cycle, or of returns if the system has no
    /// forcing.
    pub max_period: usize,
    /// The maximal number of forcing periods that the search simulates, or of returns if the system
    /// has no forcing.
    pub returns: usize,
    /// The maximal duration of the search for a system without forcing, in units of the system's
    /// time scale ([`Scales`](crate::core::hybrid::Scales)). The search lasts at least as long as the
    /// transient.
    pub longest: f64,
}

impl Default for CycleSearch {
    /// The default settings: a transient of 100 time units, then at most 1000 returns within 10 000
    /// time scales, at most 16 returns in a cycle, and a tolerance of 1e-6.
    fn default() -> Self {
        CycleSearch {
            transient: 100.0,
            tolerance: 1e-6,
            max_period: 16,
            returns: 1000,
            longest: 1e4,
        }
    }
}

impl CycleSearch {
    /// Simulates a motion until it repeats. The motion begins in the system's initial mode
    /// ([`HybridFlow::initial`]).
    ///
    /// ```
    /// use tangency::core::attractor::CycleSearch;
    /// use tangency::core::hybrid::{HybridFlow, HybridSettings, HybridState};
    /// use tangency::core::orbit::Smooth;
    /// use tangency::problems::classic::{ImpactOscillator, Lure};
    /// // One impact per forcing period.
    /// let mut flow = HybridFlow::new(&ImpactOscillator, HybridSettings::default())?;
    /// let start = HybridState { mode: ImpactOscillator::FLIGHT, time: 0.0, x: vec![0.0, 0.0] };
    /// let cycle = CycleSearch::default().find(&mut flow, start, &[5.0, 2.2, 0.8, 0.1, 1.0])?;
    /// assert_eq!((cycle.count(&ImpactOscillator, "impact"), cycle.periods), (1, 1));
    /// assert!((cycle.duration() - std::f64::consts::TAU / 2.2).abs() < 1e-6);
    /// // A cycle of a vector field is one leg.
    /// let mut flow = HybridFlow::new(&Smooth(Lure), HybridSettings::default())?;
    /// let start = HybridState { mode: 0, time: 0.0, x: vec![0.1, 0.0, 0.0] };
    /// let cycle = CycleSearch::default().find(&mut flow, start, &[0.8, 1.0])?;
    /// assert!(cycle.legs.len() == 1 && (cycle.duration() - 6.3).abs() < 0.1);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`CycleSearchError`] if the motion ends, does not return to its section or event, or does
    /// not repeat.
    pub fn find(
        &self,
        flow: &mut HybridFlow<f64>,
        start: HybridState<f64>,
        p: &[f64],
    ) -> Result<Cycle, CycleSearchError> {
        let start = flow.initial(start, p);
        flow.begin(&start, 0.0, p)?;
        match flow.system().forcing() {
            Forcing::Periodic { .. } => self.strobed(flow, start, flow.system().period(p), p),
            Forcing::None => self.returning(flow, start, p),
        }
    }

    /// Returns the maximal duration of the search in a system without forcing, in units of time.
    pub(crate) fn longest_time(&self, system: &dyn HybridEquations, p: &[f64]) -> f64 {
        self.transient.max(self.longest * time_scale(system, p))
    }

    /// Samples the motion once a forcing period.
    fn strobed(
        &self,
        flow: &mut HybridFlow<f64>,
        mut state: HybridState<f64>,
        period: f64,
        p: &[f64],
    ) -> Result<Cycle, CycleSearchError> {
        let mut phase = state.time;
        let skipped = (self.transient / period).max(0.0) as usize;
        let scales = &StateScales::of(flow.system(), p);
        let begin = || Repetition::new(self.max_period, self.tolerance, scales.clone());
        let mut repetition = begin();
        // Under forcing, rest is periodic, so the size includes all motion before.
        let mut size = 0.0_f64;
        for k in 0..skipped.saturating_add(self.returns) {
            // Time restarts at the same value in every period, because large times lose digits.
            state.time = phase;
            let mut stretch = Stretch::from(state.clone(), scales);
            flow.advance(&mut state, period, p, &mut stretch)?;
            if k < skipped {
                continue;
            }
            if let Some(later) = stretch.later(period) {
                flow.advance(&mut state, later, p, &mut ())?;
                phase = state.time;
                repetition = begin();
                continue;
            }
            size = size.max(stretch.size(&state));
            let found = repetition.push(state.clone(), stretch.numbers(), size);
            if let Some(q) = found.filter(|q| repetition.is_least(*q)) {
                state.time = phase;
                let (start, duration) = (state.clone(), period * q as f64);
                let events = flow.events(&mut state, duration, p)?;
                let cycle = Cycle::through(&events, (&start, state.x), duration, q);
                return Ok(Cycle { distance: repetition.nearest, ..cycle });
            }
        }
        let slow = SlowCycle { system: flow.system(), sampling: Sampling::Period(period), p };
        slow.find(flow, &repetition).ok_or_else(|| self.unsettled(&repetition))
    }

    /// Samples the motion on a section until its first event, and then just after every event of
    /// the guard that caused the first event.
    fn returning(
        &self,
        flow: &mut HybridFlow<f64>,
        mut state: HybridState<f64>,
        p: &[f64],
    ) -> Result<Cycle, CycleSearchError> {
        let began = state.clone();
        flow.advance(&mut state, self.transient, p, &mut ())?;
        let (system, scales) = (flow.system(), &StateScales::of(flow.system(), p));
        let across = |state: &HybridState<f64>| Section::through(system, p, state, scales);
        let mut returns = Returns {
            search: self,
            across: &across,
            section: Some(across(&state)),
            at: None,
            stretch: Stretch::from(state.clone(), scales),
            events: Vec::new(),
            repetition: Repetition::new(self.max_period, self.tolerance, scales.clone()),
            cycle: None,
            diameters: [0.0; 2],
        };
        let longest = self.longest_time(system, p);
        flow.advance(&mut state, longest, p, &mut returns)?;
        let Returns { repetition, cycle, diameters: [last, largest], at, .. } = returns;
        let way =
            (began.mode == state.mode).then(|| scales.distance(state.mode, &state.x, &began.x));
        let largest = largest.max(way.unwrap_or_default());
        // Rounding errors at an equilibrium may repeat.
        let size = largest.max(scales.size(state.mode, &state.x));
        let moves = cycle.as_ref().is_some_and(|cycle| {
            last > SHRUNK * size
                || cycle.legs.iter().any(|leg| leg.exit.is_some())
                || !is_still(system, &state, p)
        });
        if !moves && let Some(rest) = at_equilibrium(system, &state, p, (scales, largest)) {
            return Err(rest);
        }
        if let Some(cycle) = cycle {
            return Ok(cycle);
        }
        if repetition.samples < 2 {
            return Err(CycleSearchError::NoReturn(longest));
        }
        if last <= SHRUNK * largest {
            return Err(CycleSearchError::Rest { time: state.time, last, largest });
        }
        let sampling = at.map_or(Sampling::Section { longest, scales }, |(guard, mode)| {
            Sampling::Event { guard, mode, longest }
        });
        let slow = SlowCycle { system, sampling, p };
        slow.find(flow, &repetition).ok_or_else(|| self.unsettled(&repetition))
    }

    fn unsettled(&self, repetition: &Repetition) -> CycleSearchError {
        let CycleSearch { max_period, tolerance, .. } = *self;
        let &Repetition { samples: returns, nearest: distance, .. } = repetition;
        CycleSearchError::Unsettled { returns, max_period, distance, tolerance }
    }
}

/// Whether every state of a motion differs from an equilibrium only by rounding errors of its own size.
fn is_still(system: &dyn HybridEquations, state: &HybridState<f64>, p: &[f64]) -> bool {
    let HybridState { mode, x, .. } = state;
    equilibrium_near(system, *mode, x, p).is_some_and(|rest| {
        let pairs = rest.iter().zip(x).zip(system.sizes_of(*mode, p));
        pairs.into_iter().all(|((rest, x), size)| (rest - x).abs() <= STILL * size.max(rest.abs()))
    })
}

/// Returns the equilibrium at which a motion has come to rest. The distance of the equilibrium from
/// the last state must be a small fraction of the distance travelled, or of the size of the
/// equilibrium.
fn at_equilibrium(
    system: &dyn HybridEquations,
    state: &HybridState<f64>,
    p: &[f64],
    (scales, largest): (&StateScales, f64),
) -> Option<CycleSearchError> {
    let (mode, time) = (state.mode, state.time);
    let states = equilibrium_near(system, mode, &state.x, p)?;
    let way = largest.max(scales.size(mode, &states));
    if scales.distance(mode, &states, &state.x) > SHRUNK * way {
        return None;
    }
    let place = place_in_words(system, mode, &states);
    Some(CycleSearchError::Equilibrium { time, place, mode, states })
}

/// The part of a motion since its last sample.
struct Stretch<'a> {
    scales: &'a StateScales,
    start: HybridState<f64>,
    events: Vec<Event<f64>>,
    /// The largest distance of the motion from its state at the last sample; the distance is
    /// measured only until the first event after this sample.
    diameter: f64,
}

impl<'a> Stretch<'a> {
    /// Starts recording the motion that follows a sample.
    fn from(start: HybridState<f64>, scales: &'a StateScales) -> Self {
        Stretch { scales, start, events: Vec::new(), diameter: 0.0 }
    }

    /// If the recorded motion has events, returns the size of the largest state after an event or
    /// at the end of the record; otherwise returns the diameter of the motion.
    fn size(&self, end: &HybridState<f64>) -> f64 {
        let after = self.events.iter().map(|event| self.scales.size(event.next, &event.after));
        let largest = after.reduce(f64::max);
        largest.map_or(self.diameter, |size| size.max(self.scales.size(end.mode, &end.x)))
    }

    /// Returns the guard of each recorded event, and whether infinitely many events accumulate
    /// there.
    fn numbers(&self) -> Vec<(usize, bool)> {
        self.events.iter().map(|event| (event.guard, event.accumulation)).collect()
    }

    /// If an event coincides with the sample, returns the delay until a better sampling time, since
    /// rounding would decide to which period the event belongs. The better sampling time is the
    /// middle of the longest interval without events. Returns `None` if no event coincides with the
    /// sample.
    fn later(&self, period: f64) -> Option<f64> {
        let (first, last) = (self.events.first()?.time, self.events.last()?.time);
        let near = AT_EVENT * period;
        let start = self.start.time;
        if first - start > near && start + period - last > near {
            return None;
        }
        let inner = self.events.windows(2).map(|pair| (pair[1].time - pair[0].time, pair[0].time));
        let gaps = inner.chain([(first + period - last, last)]);
        let (longest, since) = gaps.max_by(|a, b| a.0.total_cmp(&b.0))?;
        let later = (since + longest / 2.0 - start).rem_euclid(period);
        (longest / 2.0 > near).then_some(later)
    }
}

impl HybridObserver<f64> for Stretch<'_> {
    fn step<F: FieldIn<f64>>(&mut self, mode: usize, step: &mut Step<F, f64>, _end: f64) {
        if self.events.is_empty() {
            let distance = self.scales.distance(mode, step.end(), &self.start.x);
            self.diameter = self.diameter.max(distance);
        }
    }

    fn event(&mut self, event: &Event<f64>) -> ControlFlow<()> {
        self.events.push(event.clone());
        ControlFlow::Continue(())
    }
}

/// The search for repetition among the returns of a motion; the motion returns to a guard or,
/// before its first event, to a section.
struct Returns<'a> {
    search: &'a CycleSearch,
    /// Creates the section across the motion through a given state.
    across: &'a dyn Fn(&HybridState<f64>) -> Section<f64>,
    section: Option<Section<f64>>,
    /// The guard and mode of the events at which motion is sampled.
    at: Option<(usize, usize)>,
    stretch: Stretch<'a>,
    /// All events from the first sample of the motion to its last sample.
    events: Vec<Event<f64>>,
    repetition: Repetition,
    cycle: Option<Cycle>,
    /// The diameter of the motion during its last return, measured up to the first event of this
    /// return, and the largest such diameter of all returns.
    diameters: [f64; 2],
}

impl Returns<'_> {
    /// Processes a sample of the motion; if the motion has repeated, stores the cycle.
    fn sample(&mut self, state: HybridState<f64>) {
        let next = Stretch::from(state.clone(), self.stretch.scales);
        let stretch = std::mem::replace(&mut self.stretch, next);
        let Returns { repetition, events, diameters: [last, largest], .. } = self;
        (*last, *largest) = (stretch.diameter, largest.max(stretch.diameter));
        let found = repetition.push(state.clone(), stretch.numbers(), stretch.size(&state));
        events.extend(stretch.events);
        self.cycle = found.filter(|q| repetition.is_least(*q)).map(|q| {
            let start = repetition.before(q);
            // A cycle begins with the event of its first sample, if any.
            let last = events.len().saturating_sub(1);
            let events = &events[last - repetition.events(q)..last];
            let duration = state.time - start.time;
            let cycle = Cycle::through(events, (start, state.x), duration, 1);
            Cycle { distance: repetition.nearest, ..cycle }
        });
    }
}

impl HybridObserver<f64> for Returns<'_> {
    fn ends(&self) -> bool {
        self.cycle.is_some() || self.repetition.samples >= self.search.returns
    }

    fn step<F: FieldIn<f64>>(&mut self, mode: usize, step: &mut Step<F, f64>, end: f64) {
        self.stretch.step(mode, step, end);
        let Some(section) = &mut self.section else { return };
        let Some(state) = section.crossing(step, end) else { return };
        if self.repetition.samples.is_multiple_of(2 * self.search.max_period) {
            *section = (self.across)(&state);
        }
        self.sample(state);
    }

    fn event(&mut self, event: &Event<f64>) -> ControlFlow<()> {
        let _ = self.stretch.event(event);
        self.section = None;
        let at = *self.at.get_or_insert((event.guard, event.mode));
        if at == (event.guard, event.mode) && !event.accumulation {
            self.sample(HybridState { mode: event.next, time: event.time, x: event.after.clone() });
        }
        if self.ends() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }
}
