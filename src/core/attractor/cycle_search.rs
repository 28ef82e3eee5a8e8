//! Periodic motions found by simulation: what they go through, and where.
//!
//! Under a forcing of period `T` a motion is sampled once in every period, and is periodic where
//! mode and state are those of `q` periods before, and the same events came in both; where events
//! come just at the sampling, it is sampled later in the period. Without forcing it is sampled just
//! after the events of one guard. As long as no event has come, it is sampled on a section through
//! a point `x₀` of it, across the motion there,
//!
//! ```text
//!     ⟨f(x₀), x − x₀⟩ = 0,  growing,
//! ```
//!
//! and the time of return is the period. If it does not return to the point itself within some
//! crossings, a section is laid through the last of them: transients go on dying out meanwhile.

use super::repetition::{Nearness, Repetition, StateScales, is_least};
use super::section::Section;
use crate::core::hybrid::{
    Cycle, CycleLeg, Event, HybridEquations, HybridError, HybridFlow, HybridObserver, HybridState,
};
use crate::core::ode::Step;
use crate::core::problem::{FieldIn, Forcing};
use std::ops::ControlFlow;

/// (H) An event that is nearer than this part of the period to the time of a sample comes with the
/// sample: motion is sampled later then.
const AT_EVENT: f64 = 1e-3;

/// Why a simulation has found no periodic motion.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CycleSearchError {
    /// The motion ends.
    #[error(transparent)]
    Motion(#[from] HybridError),
    /// The motion does not repeat.
    #[error(
        "the motion has not repeated in {returns} returns, compared over up to {max_period}: the nearest was at a \
         distance of {distance:.1e}, above the tolerance {tolerance:.1e}; simulate longer (`transient`, `returns`, \
         `longest`), or elsewhere if it is not periodic"
    )]
    Unsettled {
        /// The number of returns.
        returns: usize,
        /// The largest number of returns in a cycle.
        max_period: usize,
        /// The smallest distance, as [`CycleSearch::tolerance`] measures it.
        distance: f64,
        /// The largest distance of a motion that repeats.
        tolerance: f64,
    },
    /// A motion without forcing neither passes an event nor returns to a section across it.
    #[error(
        "no event and no return came within a time of {0}: the motion has settled on an equilibrium, or leaves; \
         raise `longest` if it is slow, or simulate elsewhere"
    )]
    NoReturn(f64),
}

/// The search for periodic motion by simulation: how long to look, and when a motion repeats.
///
/// It works on any hybrid system; a vector field is one as
/// [`orbit::Smooth`](crate::core::orbit::Smooth). Cycles are found in their least period.
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
    /// A motion repeats when it comes back this near, in units of its largest state; of motion
    /// without events, in units of its diameter. Correction does the rest.
    pub tolerance: f64,
    /// The largest number of periods of the forcing, or of returns, in a cycle.
    pub max_period: usize,
    /// The number of periods, or returns, that are searched.
    pub returns: usize,
    /// The longest time in which they are searched without forcing, in units of time.
    pub longest: f64,
}

impl Default for CycleSearch {
    /// A transient of 100, then 1000 returns, up to 16 in a cycle, within a time of 10 000, and a
    /// tolerance of 1e-6.
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
    /// Follows a motion until it repeats. It begins in the mode that the system says
    /// ([`HybridFlow::initial`]).
    ///
    /// ```
    /// use tangency::core::attractor::CycleSearch;
    /// use tangency::core::hybrid::{HybridFlow, HybridSettings, HybridState};
    /// use tangency::core::orbit::Smooth;
    /// use tangency::problems::classic::{ImpactOscillator, Lure};
    /// // Impacts once in every period of the forcing.
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
    /// [`CycleSearchError`] if the motion ends, does not return, or does not repeat.
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

    /// Samples the motion once in every period of the forcing.
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
        let mut repetition = Repetition::new(self.max_period, self.tolerance, scales.clone());
        for k in 0..skipped.saturating_add(self.returns) {
            // From the same time in every period: long times have fewer digits.
            state.time = phase;
            let before = state.clone();
            let mut sample = Sample::new(&before, scales);
            flow.advance(&mut state, period, p, &mut sample)?;
            if k < skipped {
                continue;
            }
            if let Some(later) = sample.later(period) {
                flow.advance(&mut state, later, p, &mut ())?;
                phase = state.time;
                repetition = Repetition::new(self.max_period, self.tolerance, scales.clone());
                continue;
            }
            let Sample { guards, largest, diameter, .. } = sample;
            let last = scales.size(state.mode, &state.x);
            let size = if guards.is_empty() { diameter } else { largest.max(last) };
            let found = repetition.push(before.clone(), guards, &state, size);
            if let Some(q) = found.filter(|q| repetition.is_least(*q, &state)) {
                state.time = phase;
                let (start, duration) = (state.clone(), period * q as f64);
                let events = flow.events(&mut state, duration, p)?;
                let cycle = Cycle::through(&events, duration, q)
                    .unwrap_or_else(|| Cycle::smooth(start, duration, state.x, q));
                return Ok(Cycle { distance: repetition.nearness.least, ..cycle });
            }
        }
        Err(self.unsettled(self.returns, repetition.nearness))
    }

    /// Samples the motion just after every event of the guard that comes first, and before that on
    /// a section.
    fn returning(
        &self,
        flow: &mut HybridFlow<f64>,
        mut state: HybridState<f64>,
        p: &[f64],
    ) -> Result<Cycle, CycleSearchError> {
        flow.advance(&mut state, self.transient, p, &mut ())?;
        let system = flow.system();
        let scales = StateScales::of(system, p);
        let mut returns = Returns {
            search: self,
            system,
            p,
            section: Some(Section::through(system, p, state.clone(), scales.clone())),
            events: Vec::new(),
            positions: Vec::new(),
            count: 0,
            nearness: Nearness::new(scales.clone()),
            scales,
            cycle: None,
        };
        flow.advance(&mut state, self.longest, p, &mut returns)?;
        let Returns { events, count, nearness, cycle, .. } = returns;
        cycle.ok_or_else(|| match events.is_empty() && count == 0 {
            true => CycleSearchError::NoReturn(self.longest),
            false => self.unsettled(count, nearness),
        })
    }

    fn unsettled(&self, returns: usize, nearness: Nearness) -> CycleSearchError {
        let CycleSearch { max_period, tolerance, .. } = *self;
        CycleSearchError::Unsettled { returns, max_period, distance: nearness.least, tolerance }
    }
}

/// What happens in one period of the forcing.
struct Sample<'a> {
    start: &'a HybridState<f64>,
    scales: &'a StateScales,
    guards: Vec<usize>,
    /// When the events come.
    times: Vec<f64>,
    /// The size of the largest state after an event.
    largest: f64,
    /// The largest distance from the start before the first event.
    diameter: f64,
}

impl<'a> Sample<'a> {
    fn new(start: &'a HybridState<f64>, scales: &'a StateScales) -> Self {
        let (guards, times) = Default::default();
        Sample { start, scales, guards, times, largest: 0.0, diameter: 0.0 }
    }

    /// How much later motion should be sampled, if an event comes just where it is sampled now, and
    /// rounding decides in which period: in the middle of the longest time without events.
    fn later(&self, period: f64) -> Option<f64> {
        let (first, last) = (*self.times.first()?, *self.times.last()?);
        let near = AT_EVENT * period;
        let start = self.start.time;
        if first - start > near && start + period - last > near {
            return None;
        }
        let inner = self.times.windows(2).map(|pair| (pair[1] - pair[0], pair[0]));
        let gaps = inner.chain([(first + period - last, last)]);
        let (longest, since) = gaps.max_by(|a, b| a.0.total_cmp(&b.0))?;
        let later = (since + longest / 2.0 - start).rem_euclid(period);
        (longest / 2.0 > near).then_some(later)
    }
}

impl HybridObserver<f64> for Sample<'_> {
    fn step<F: FieldIn<f64>>(&mut self, mode: usize, step: &mut Step<F, f64>, _end: f64) {
        if self.guards.is_empty() {
            let distance = self.scales.distance(mode, step.end(), &self.start.x);
            self.diameter = self.diameter.max(distance);
        }
    }

    fn event(&mut self, event: &Event<f64>) -> ControlFlow<()> {
        self.guards.push(event.guard);
        self.times.push(event.time);
        self.largest = self.largest.max(self.scales.size(event.next, &event.after));
        ControlFlow::Continue(())
    }
}

/// The search among returns: to a guard, or to a section as long as no event has come.
struct Returns<'a> {
    search: &'a CycleSearch,
    system: &'a dyn HybridEquations,
    p: &'a [f64],
    section: Option<Section>,
    events: Vec<Event<f64>>,
    /// The positions of those events at which motion is sampled.
    positions: Vec<usize>,
    /// The number of returns.
    count: usize,
    nearness: Nearness,
    scales: StateScales,
    cycle: Option<Cycle>,
}

impl Returns<'_> {
    /// After how many returns, the cycle's number, the motion has come back to an event.
    fn returned(&mut self, event: &Event<f64>) -> Option<usize> {
        let CycleSearch { tolerance, max_period, .. } = *self.search;
        let Returns { events, positions, nearness, .. } = self;
        let back = |nearness: &Nearness, q: usize| {
            let old = &events[positions[positions.len() - q]];
            let alike = old.next == event.next;
            if alike {
                nearness.distance(old.next, &old.after, &event.after)
            } else {
                f64::INFINITY
            }
        };
        let most = max_period.min(positions.len());
        let found = nearness.first(most, tolerance, back);
        found.filter(|q| is_least(*q, |q| back(nearness, q)))
    }

    /// The legs from an event to the last one.
    fn cycle_from(&self, first: usize) -> Cycle {
        let events = &self.events[first..];
        let legs =
            events.windows(2).map(|pair| CycleLeg::between(&pair[0], &pair[1], 0.0)).collect();
        Cycle { start: events[0].time, legs, periods: 1, distance: self.nearness.least }
    }
}

impl HybridObserver<f64> for Returns<'_> {
    fn ends(&self) -> bool {
        self.cycle.is_some() || self.count >= self.search.returns
    }

    fn step<F: FieldIn<f64>>(&mut self, _mode: usize, step: &mut Step<F, f64>, end: f64) {
        let Some(section) = &mut self.section else { return };
        let Some(state) = section.crossing(step, end) else { return };
        let CycleSearch { tolerance, max_period, .. } = *self.search;
        let crossings = section.distances.len();
        let distance = section.distances[crossings - 1];
        self.count += 1;
        self.nearness.least = self.nearness.least.min(distance);
        let returned = distance <= tolerance;
        if returned && is_least(crossings, |q| section.distances[q - 1]) {
            let (start, duration) = (section.start.clone(), state.time - section.start.time);
            let cycle = Cycle::smooth(start, duration, state.x, 1);
            self.cycle = Some(Cycle { distance, ..cycle });
        } else if returned || crossings >= max_period {
            *section = Section::through(self.system, self.p, state, self.scales.clone());
        }
    }

    fn event(&mut self, event: &Event<f64>) -> ControlFlow<()> {
        if self.section.take().is_some() {
            (self.count, self.nearness) = (0, Nearness::new(self.scales.clone()));
        }
        self.nearness.extend(self.scales.size(event.next, &event.after));
        let same = |first: &Event<f64>| (first.guard, first.mode) == (event.guard, event.mode);
        let sampled = self.events.first().is_none_or(same) && !event.accumulation;
        let found = if sampled { self.returned(event) } else { None };
        let first = found.map(|q| self.positions[self.positions.len() - q]);
        if sampled {
            self.count = self.positions.len();
            self.positions.push(self.events.len());
        }
        self.events.push(event.clone());
        self.cycle = first.map(|first| self.cycle_from(first));
        if self.ends() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }
}
