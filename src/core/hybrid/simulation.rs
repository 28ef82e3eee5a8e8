//! Event-driven simulation of hybrid systems.

use super::chatter::Series;
use super::crowding::Crowd;
use super::erased::{EventNumber, HybridEquations};
use super::error::HybridError;
use super::event::{Event, HybridObserver};
use super::event_locator::{EventLocator, INSTANT, LocatedEvent};
use super::leg::GuardOf;
use super::scales::{guard_scale, time_scale};
use super::system::{Guard, Mode};
use super::timed::{Timed, at_once};
use crate::core::failure::FlowError;
use crate::core::linalg::refill;
use crate::core::ode::{Flow, NEGATIVE, Roots, Settings, Statistics};
use crate::core::problem::{Forcing, Watchable};
use crate::core::scalar::Scalar;
use std::ops::ControlFlow;

/// Heuristic: the largest integration step, as a fraction of the forcing's period: if a field
/// vanishes, the integrator cannot see how fast the guards change.
const PART_OF_PERIOD: f64 = 0.125;

/// Heuristic: the growth of a state, relative to its size at the start (at least 1), above which a
/// failed integration step shows that the solution is unbounded.
const GROWN: f64 = 1e6;

/// The tolerances and limits of a hybrid simulation.
///
/// ```
/// use tangency::core::hybrid::HybridSettings;
/// let settings = HybridSettings { at_once: 50, ..HybridSettings::default() };
/// assert!(settings.accumulation == 1e-4 && settings.flow.relative == 1e-12);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct HybridSettings {
    /// The settings of the integration of the flow in each mode.
    pub flow: Settings,
    /// The time, in units of the time scale, within which events that accumulate are not simulated
    /// one by one: motion then continues from their accumulation.
    pub accumulation: f64,
    /// The largest number of simultaneous events before the simulation ends with an error.
    pub at_once: usize,
}

impl Default for HybridSettings {
    /// The default settings: the method of order 8 with a tolerance of 1e-12; accumulations within
    /// 1e-4; at most 1000 simultaneous events.
    fn default() -> Self {
        HybridSettings { flow: Settings::default(), accumulation: 1e-4, at_once: 1000 }
    }
}

/// A state of a hybrid system: a mode, a time, and the states of the mode.
#[derive(Clone, Debug, PartialEq)]
pub struct HybridState<T> {
    /// The mode.
    pub mode: usize,
    /// The time.
    pub time: T,
    /// The values of the mode's states.
    pub x: Vec<T>,
}

impl<T: Copy> HybridState<T> {
    /// Returns the mode, the time and the states as a tuple.
    pub(super) fn place(&self) -> (usize, T, &[T]) {
        (self.mode, self.time, &self.x)
    }
}

/// The cost of a simulated motion, and the number of its events.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct HybridStatistics {
    /// The total cost of integrating the flows.
    pub flow: Statistics,
    /// The number of events, including accumulations.
    pub events: usize,
    /// The number of accumulations of infinitely many events.
    pub accumulations: usize,
    /// The number of events at which another guard of the mode vanished simultaneously; the event then
    /// belongs to the guard that is defined first.
    pub together: usize,
}

/// A simulator of a hybrid system in one scalar type, with its buffers.
///
/// An event is located where a guard falls through zero, also inside integration steps. The time of the
/// event is computed in the scalar type, so that time and state at the event carry derivatives, which the
/// reset propagates. Derivatives of a motion through an event therefore agree with the saltation matrix,
/// although this matrix is not computed.
///
/// ```
/// use num_dual::Dual64;
/// use tangency::core::hybrid::{HybridFlow, HybridSettings, HybridState};
/// use tangency::problems::classic::ImpactOscillator;
/// // Without force and loss, x = v₀ sin t up to the stop at 0.8, and then back to 0 at the time 2 asin(0.8/v₀).
/// // The derivative of x at that time by v₀ follows, for v₀ = 1.
/// let mut flow = HybridFlow::new(&ImpactOscillator, HybridSettings::default())?;
/// let (time, zero, speed) = (2.0 * 0.8_f64.asin(), Dual64::from(0.0), Dual64::from(1.0).derivative());
/// let mut mass = HybridState { mode: ImpactOscillator::FLIGHT, time: zero, x: vec![zero, speed] };
/// let p = [0.0, 1.0, 1.0, 0.0, 0.8].map(Dual64::from);
/// let statistics = flow.advance(&mut mass, time.into(), &p, &mut ())?;
/// assert!((mass.x[0].eps + 8.0 / 3.0).abs() < 1e-10 && statistics.events == 1);
/// # Ok::<(), tangency::core::hybrid::HybridError>(())
/// ```
pub struct HybridFlow<'a, T: Scalar> {
    pub(super) system: &'a dyn HybridEquations,
    pub(super) modes: Vec<Mode>,
    pub(super) guards: Vec<Guard>,
    /// The guards of each mode, except guards with events at given times.
    pub(super) watched: Vec<Vec<usize>>,
    pub(super) timed: Timed,
    pub(in crate::core) settings: HybridSettings,
    pub(super) flow: Flow<T>,
    pub(super) roots: Vec<Roots<T>>,
    /// The scales of the guards in the current leg (part of the motion between two events).
    pub(super) scales: Vec<f64>,
    /// For each guard in each mode, the last events of this guard.
    pub(super) series: Vec<Series<T>>,
    pub(super) event: Event<T>,
    /// The length of the integration step in which the last leg (part of the motion between two
    /// events) ended.
    pub(super) pace: Option<f64>,
    /// The time scale of the system.
    pub(super) unit: f64,
    /// The real parts of a state.
    pub(super) x: Vec<f64>,
    /// The real parts of the parameters.
    pub(super) p: Vec<f64>,
}

/// A motion in progress: its end time, its observer, and its cost so far.
pub(super) struct Run<'a, T, O> {
    pub end: T,
    pub p: &'a [T],
    pub observer: &'a mut O,
    pub statistics: HybridStatistics,
    pub crowd: Crowd,
}

impl<'a, T: EventNumber> HybridFlow<'a, T>
where
    GuardOf<'a>: Watchable<T>,
{
    /// Creates a simulator of a system with these settings.
    ///
    /// # Errors
    /// [`HybridError::Settings`] if a setting of the integration is invalid, [`HybridError::ChangesIn`]
    /// if the shortest time in which a guard changes is not positive.
    pub fn new(
        system: &'a dyn HybridEquations,
        settings: HybridSettings,
    ) -> Result<Self, HybridError> {
        let (modes, guards) = (system.modes(), system.guards());
        for Guard { name, changes_in, .. } in &guards {
            if let Some(time) = changes_in.filter(|time| time.is_nan() || *time <= 0.0) {
                return Err(HybridError::ChangesIn { guard: name.clone(), time });
            }
        }
        let roots = guards.iter().map(|_| Roots::default()).collect();
        let series = (0..guards.len() * modes.len()).map(|_| Series::new()).collect();
        let (flow, event, scales) =
            (Flow::new(settings.flow.clone())?, Event::empty(), vec![1.0; guards.len()]);
        let (pace, x, p) = Default::default();
        let vanishes = |guard: &Guard, mode: usize| guard.ends(mode) && !guard.is_timed();
        let of_mode = |mode| (0..guards.len()).filter(|g| vanishes(&guards[*g], mode)).collect();
        let watched = (0..modes.len()).map(of_mode).collect();
        let timed = Timed::among(&guards, modes.len());
        Ok(HybridFlow {
            system,
            modes,
            guards,
            watched,
            timed,
            settings,
            flow,
            roots,
            scales,
            series,
            event,
            pace,
            unit: 1.0,
            x,
            p,
        })
    }

    /// The system.
    pub fn system(&self) -> &'a dyn HybridEquations {
        self.system
    }

    /// Returns the initial state of a motion, with its mode replaced by the mode that the system selects
    /// ([`HybridSystem::initial_mode`](super::system::HybridSystem::initial_mode)).
    pub fn initial(&self, mut state: HybridState<T>, p: &[T]) -> HybridState<T> {
        let (mode, time) = (state.mode, state.time.real());
        // A wrong number of states is reported at the start of the motion.
        let lengths = |mode: &Mode| [mode.states.len(), self.system.parameters().len()];
        if self.modes.get(mode).map(lengths) == Some([state.x.len(), p.len()]) {
            let [x, p] = [&state.x, p].map(|all| all.iter().map(T::real).collect::<Vec<f64>>());
            state.mode = self.system.initial_mode(mode, time, &x, &p);
        }
        state
    }

    /// Advances a state by a duration, through all events within the duration. The observer is called at
    /// every integration step and at every event, and can end the motion just after an event or at the
    /// end of a step. If an error ends the motion, the state is set to the state after the last event,
    /// or just before the last event if no mode follows that event.
    ///
    /// # Errors
    /// [`HybridError`] if the motion ends early: the integration of its flow fails, a mode begins with a
    /// negative guard, or events accumulate without a mode for the subsequent motion.
    pub fn advance(
        &mut self,
        state: &mut HybridState<T>,
        duration: T,
        p: &[T],
        observer: &mut impl HybridObserver<T>,
    ) -> Result<HybridStatistics, HybridError> {
        self.begin(state, duration, p)?;
        let (end, statistics) = (state.time + duration, HybridStatistics::default());
        let crowd = Crowd::from(state.time.real());
        let mut run = Run { end, p, observer, statistics, crowd };
        while !self.timed.is_over(self.system, state.place(), run.end, p) {
            let Some(landing) = self.leg(state, &mut run)? else { break };
            if self.land(landing, state, &mut run)?.is_break() {
                break;
            }
        }
        let statistics = run.statistics;
        self.constrain(state, p);
        Ok(statistics)
    }

    /// Projects a state onto the invariant surface of its mode, so that deviations normal to the
    /// surface are lost.
    pub(super) fn constrain(&self, HybridState { mode, time, x }: &mut HybridState<T>, p: &[T]) {
        if self.modes[*mode].on_surface {
            T::fields(self.system).constrain_of(*mode, *time, x, p);
        }
    }

    /// Returns all events within a duration, in the order of time.
    ///
    /// # Errors
    /// The same errors as [`advance`](Self::advance).
    pub fn events(
        &mut self,
        state: &mut HybridState<T>,
        duration: T,
        p: &[T],
    ) -> Result<Vec<Event<T>>, HybridError> {
        let mut events = Vec::new();
        self.advance(state, duration, p, &mut |event: &Event<T>| {
            events.push(event.clone());
            ControlFlow::Continue(())
        })?;
        Ok(events)
    }

    /// Starts a motion, or returns an error if the motion cannot start from the given state.
    pub(in crate::core) fn begin(
        &mut self,
        state: &HybridState<T>,
        duration: T,
        p: &[T],
    ) -> Result<(), HybridError> {
        self.series.iter_mut().for_each(|series| series.events = 0);
        self.pace = None;
        let (time, mode, modes) = (state.time.real(), state.mode, self.modes.len());
        let Some(Mode { name, states, .. }) = self.modes.get(mode) else {
            return Err(HybridError::NoMode { time, mode, modes, after: String::new() });
        };
        if duration.real() < 0.0 {
            return Err(HybridError::Backward(duration.real()));
        }
        let same = |what, found, expected| match found == expected {
            true => Ok(()),
            false => Err(HybridError::Length { what, mode: name.clone(), found, expected }),
        };
        if self.p.len() != p.len() {
            same("parameters", p.len(), self.system.parameters().len())?;
        }
        same("states", state.x.len(), states.len())?;
        refill(&mut self.p, p.iter().map(T::real));
        self.unit = time_scale(self.system, &self.p);
        self.timed.begin(time);
        self.inside(state, None)
    }

    /// Returns an error if a guard of the mode is negative for a state at the start of a motion or just
    /// after an event.
    pub(super) fn inside(
        &mut self,
        state: &HybridState<T>,
        event: Option<usize>,
    ) -> Result<(), HybridError> {
        refill(&mut self.x, state.x.iter().map(T::real));
        let time = state.time.real();
        for &g in &self.watched[state.mode] {
            let value = self.system.guard(g, state.mode, time, &self.x, &self.p);
            if value < 0.0 && value < -NEGATIVE * self.scale_of(g, state.mode, time) {
                let mode = self.modes[state.mode].name.clone();
                let after = event.map_or_else(String::new, |event| self.after(event));
                let guard = self.guards[g].name.clone();
                return Err(HybridError::Outside { time, mode, guard, value, after });
            }
        }
        self.check_end(state.mode, time)
    }

    /// Returns an error if the mode must not begin or end at the given time and the state stored in
    /// `x`.
    pub(super) fn check_end(&self, mode: usize, time: f64) -> Result<(), HybridError> {
        self.system.domain_at_ends(mode, time, &self.x, &self.p).map_err(|left| {
            let source = FlowError::OutOfDomain { time, left };
            HybridError::Flow { mode: self.modes[mode].name.clone(), source }
        })
    }

    /// Returns the words "after event …," for error messages.
    pub(super) fn after(&self, event: usize) -> String {
        format!("after event {}, ", self.guards[event].name)
    }

    /// Returns the scale of a guard at the state stored in `x`.
    pub(super) fn scale_of(&self, guard: usize, mode: usize, time: f64) -> f64 {
        guard_scale(self.system, (guard, mode), (time, &self.x), &self.p)
    }

    /// Integrates the flow of one mode up to the end of the mode, or to the end of the motion.
    pub(super) fn leg<O: HybridObserver<T>>(
        &mut self,
        state: &mut HybridState<T>,
        run: &mut Run<T, O>,
    ) -> Result<Option<LocatedEvent<T>>, HybridError> {
        let (system, mode) = (self.system, state.mode);
        let timed = self.timed.next(system, state.place(), run.end, run.p);
        if let Some(timed) = timed.filter(|(_, left)| left.real() <= INSTANT * self.unit) {
            return Ok(Some(at_once(system, timed, state.place(), run.p, &mut self.event)));
        }
        let left = timed.map_or(run.end - state.time, |(_, left)| left);
        self.prepare_leg(mode, left.real());
        self.watch_guards(state);
        let HybridFlow { flow, roots, scales, event, pace, p, watched, unit, .. } = self;
        let (watched, unit) = (&watched[mode], *unit);
        let mut locator = EventLocator {
            system,
            mode,
            watched,
            roots,
            scales,
            event,
            pace,
            p,
            unit,
            leg: (state.time, left),
        };
        let (mut landing, mut last) = (None, state.time + left);
        let mut ended = false;
        locator.event.before.clone_from(&state.x);
        let field = T::in_mode(system, mode, T::zero());
        let outcome = flow.observe(&field, state.time, left, &mut state.x, run.p, |step| {
            landing = locator.locate(step);
            let end = landing.map_or(T::one(), |landing| landing.root.fraction);
            run.observer.step(mode, step, end);
            ended = run.observer.ends();
            if ended {
                last = step.time(T::one());
            }
            if ended || landing.is_some() {
                ControlFlow::Break(())
            } else {
                ControlFlow::Continue(())
            }
        });
        if let (None, false, Some((guard, _)), Ok(_)) = (landing, ended, timed, &outcome) {
            landing = Some(LocatedEvent::at_time(guard));
            (event.time, *pace) = (last, None);
            event.before.clone_from(&state.x);
        }
        match (landing, outcome) {
            (landing, Ok(statistics)) => {
                run.statistics.flow = sum(run.statistics.flow, statistics);
                if landing.is_none() {
                    state.time = last;
                }
                Ok(landing)
            }
            // The step continued beyond the event.
            (Some(landing), Err(_)) => Ok(Some(landing)),
            (None, Err(source)) => {
                let alone = self.modes.len() == 1 && self.guards.is_empty();
                let known = self.modes.first().filter(|_| alone);
                let unbounded =
                    known.and_then(|mode| unbounded(mode, [&self.event.before, &state.x], &source));
                state.x.copy_from_slice(&self.event.before);
                let mode = || self.modes[mode].name.clone();
                Err(unbounded.unwrap_or_else(|| HybridError::Flow { mode: mode(), source }))
            }
        }
    }

    /// Prepares the guards of a state's mode for event location.
    fn watch_guards(&mut self, state: &HybridState<T>) {
        refill(&mut self.x, state.x.iter().map(T::real));
        for k in 0..self.watched[state.mode].len() {
            let guard = self.watched[state.mode][k];
            self.scales[guard] = self.scale_of(guard, state.mode, state.time.real());
            self.roots[guard].restart();
        }
    }

    /// Prepares the integration of a leg (the part of the motion between two events) of at most
    /// this duration in a mode.
    pub(super) fn prepare_leg(&mut self, mode: usize, left: f64) {
        let period = match self.system.forcing() {
            Forcing::None => f64::INFINITY,
            Forcing::Periodic { .. } => self.system.period(&self.p),
        };
        let fastest = self.watched[mode].iter().filter_map(|guard| self.guards[*guard].changes_in);
        let longest = fastest.fold(PART_OF_PERIOD * period, f64::min);
        self.flow.settings.largest_step = self.settings.flow.largest_step.min(longest / left);
        // The step size carries over: the fields of different modes share the forcing and most forces.
        let pace = self.pace.map(|pace| (pace / left).min(1.0));
        self.flow.settings.first_step = pace.or(self.settings.flow.first_step);
    }
}

/// Returns the sum of the costs of two integrations.
pub(super) fn sum(a: Statistics, b: Statistics) -> Statistics {
    Statistics {
        evaluations: a.evaluations + b.evaluations,
        accepted: a.accepted + b.accepted,
        rejected: a.rejected + b.rejected,
    }
}

/// Returns the error of an integration that fails because the solution has become large, if the
/// system has a single mode and no events. The argument `ends` contains the states at the start and
/// after the last step.
fn unbounded<T: Scalar>(mode: &Mode, ends: [&[T]; 2], cause: &FlowError) -> Option<HybridError> {
    let (FlowError::StepTooSmall { time, .. } | FlowError::NotFinite { time, .. }) = cause else {
        return None;
    };
    let size = |x: &T| x.real().abs();
    let first = ends[0].iter().map(size).fold(1.0, f64::max);
    let largest = ends[1].iter().enumerate().max_by(|a, b| size(a.1).total_cmp(&size(b.1)));
    let (k, last) = largest?;
    let (time, state, value) = (*time, mode.states.get(k)?.clone(), last.real());
    let grows = value.is_finite() && value.abs() > GROWN * first;
    grows.then_some(HybridError::Unbounded { time, state, value })
}
