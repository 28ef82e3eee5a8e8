//! Event-driven simulation.

use super::chatter::{Accumulation, Series};
use super::erased::{EventNumber, HybridEquations};
use super::error::{After, HybridError};
use super::event::{Event, HybridObserver};
use super::landing::{Landing, Lookout};
use super::leg::GuardOf;
use super::scales::{guard_scale, time_scale};
use super::system::{Guard, Mode};
use crate::core::flow::{Flow, NEGATIVE, Roots, Settings, Statistics};
use crate::core::scalar::Scalar;
use crate::core::watch::Watchable;
use std::ops::ControlFlow;

/// Time stands still while it moves by less than this, in units of its scale.
pub(super) const INSTANT: f64 = 1e-9;

/// Tolerances and limits of a hybrid motion.
///
/// ```
/// use tangency::core::hybrid::HybridSettings;
/// let settings = HybridSettings { at_once: 50, ..HybridSettings::default() };
/// assert!(settings.accumulation == 1e-4 && settings.flow.relative == 1e-12);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HybridSettings {
    /// The settings of the flow in each mode.
    pub flow: Settings,
    /// Events that would accumulate within this time, in units of its scale, are not followed one by one: motion goes
    /// on from their accumulation.
    pub accumulation: f64,
    /// How many events may come at once.
    pub at_once: usize,
}

impl Default for HybridSettings {
    /// A flow by the method of order 8 with a tolerance of 1e-12; accumulations within 1e-4; 1000 events at
    /// once.
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
    /// The states of the mode.
    pub x: Vec<T>,
}

/// What a motion has cost, and how many events there were.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct HybridStatistics {
    /// The cost of the flows.
    pub flow: Statistics,
    /// The number of events, accumulations included.
    pub events: usize,
    /// The number of accumulations.
    pub accumulations: usize,
}

/// The motion of a hybrid system in one scalar type, with all buffers.
///
/// An event is located where a guard falls through zero, inside steps as well, and its time is solved for in
/// the scalar type itself: time and state after it carry derivatives, which the reset passes on. The derivative
/// of a motion through an event is therefore that of the saltation matrix, which is stated nowhere.
///
/// ```
/// use num_dual::Dual64;
/// use tangency::core::hybrid::{HybridFlow, HybridSettings, HybridState};
/// # use tangency::core::{hybrid::{Guard, HybridSystem, Mode}, scalar::Scalar};
/// # struct Ball;
/// # impl HybridSystem for Ball {
/// #     fn modes(&self) -> Vec<Mode> { vec![Mode::new("flight", ["height", "velocity"])] }
/// #     fn guards(&self) -> Vec<Guard> { vec![Guard::new("bounce", [0])] }
/// #     fn parameters(&self) -> Vec<String> { vec!["gravity".into(), "restitution".into()] }
/// #     fn field<T: Scalar>(&self, _mode: usize, _t: T, x: &[T], p: &[T], f: &mut [T]) {
/// #         (f[0], f[1]) = (x[1], -p[0]);
/// #     }
/// #     fn guard<T: Scalar>(&self, _g: usize, _mode: usize, _t: T, x: &[T], _p: &[T]) -> T { x[0] }
/// #     fn reset<T: Scalar>(
/// #         &self, _guard: usize, _modes: (usize, usize), _t: T, x: &[T], p: &[T], after: &mut [T],
/// #     ) {
/// #         (after[0], after[1]) = (x[0], -p[1] * x[1]);
/// #     }
/// #     fn next_mode(&self, _g: usize, _mode: usize, _t: f64, _x: &[f64], _p: &[f64]) -> usize { 0 }
/// # }
/// // A ball falls from 1/2 and is thrown back; how its velocity at t = 1.5 depends on where it fell from:
/// let mut flow = HybridFlow::new(&Ball, HybridSettings::default())?;
/// let (height, zero) = (Dual64::from(0.5).derivative(), Dual64::from(0.0));
/// let mut ball = HybridState { mode: 0, time: zero, x: vec![height, zero] };
/// let p = [1.0, 0.5].map(Dual64::from);
/// let statistics = flow.advance(&mut ball, 1.5.into(), &p, &mut ())?;
/// // It meets the ground at √(2h), and v(1.5) = √(2h)/2 − (1.5 − √(2h)).
/// assert!((ball.x[1].eps - 1.5).abs() < 1e-10 && statistics.events == 1);
/// # Ok::<(), tangency::core::hybrid::HybridError>(())
/// ```
pub struct HybridFlow<'a, T: Scalar> {
    pub(super) system: &'a dyn HybridEquations,
    pub(super) modes: Vec<Mode>,
    pub(super) guards: Vec<Guard>,
    /// The guards of each mode.
    pub(super) watched: Vec<Vec<usize>>,
    pub(super) settings: HybridSettings,
    pub(super) flow: Flow<T>,
    pub(super) roots: Vec<Roots<T, GuardOf<'a>>>,
    /// The last events of each guard in each mode.
    pub(super) series: Vec<Series<T>>,
    pub(super) event: Event<T>,
    /// How long the step was in which the last leg ended.
    pub(super) pace: Option<f64>,
    /// The scale of time.
    pub(super) unit: f64,
    /// Real parts of a state.
    pub(super) x: Vec<f64>,
    /// Real parts of the parameters.
    pub(super) p: Vec<f64>,
}

/// A motion under way: where it ends, and what it has cost.
pub(super) struct Run<'a, T, O> {
    pub end: T,
    pub p: &'a [T],
    pub observer: &'a mut O,
    pub statistics: HybridStatistics,
    /// When time moved last, and how many events have come since.
    pub still: (f64, usize),
}

impl<'a, T: EventNumber> HybridFlow<'a, T>
where
    GuardOf<'a>: Watchable<T>,
{
    /// The motion of a system with these settings.
    ///
    /// # Errors
    /// [`HybridError::Settings`] if a setting of the flow has no meaning.
    pub fn new(
        system: &'a dyn HybridEquations,
        settings: HybridSettings,
    ) -> Result<Self, HybridError> {
        let (modes, guards) = (system.modes(), system.guards());
        let roots = (0..guards.len())
            .map(|guard| Roots::of(GuardOf { system, guard, mode: 0, scale: 1.0 }));
        let roots = roots.collect();
        let series = (0..guards.len() * modes.len()).map(|_| Series::new()).collect();
        let (flow, event) = (Flow::new(settings.flow)?, Event::empty());
        let (pace, x, p) = Default::default();
        let of_mode = |mode| (0..guards.len()).filter(|g| guards[*g].ends(mode)).collect();
        let watched = (0..modes.len()).map(of_mode).collect();
        Ok(HybridFlow {
            system,
            modes,
            guards,
            watched,
            settings,
            flow,
            roots,
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

    /// The modes.
    pub fn modes(&self) -> &[Mode] {
        &self.modes
    }

    /// The guards.
    pub fn guards(&self) -> &[Guard] {
        &self.guards
    }

    /// Moves a state on for a time, by way of all events, which the observer sees; it may end the motion just
    /// after one, or with a step. Where an error ends the motion, the state is that after the last event.
    ///
    /// # Errors
    /// [`HybridError`] if the motion ends before: its flow does, a mode begins where a guard is negative, or
    /// events accumulate where no mode is named that follows.
    pub fn advance(
        &mut self,
        state: &mut HybridState<T>,
        duration: T,
        p: &[T],
        observer: &mut impl HybridObserver<T>,
    ) -> Result<HybridStatistics, HybridError> {
        self.begin(state, duration, p)?;
        let (end, statistics) = (state.time + duration, HybridStatistics::default());
        let mut run = Run { end, p, observer, statistics, still: (state.time.real(), 0) };
        while (end - state.time).real() > 0.0 {
            let Some(landing) = self.leg(state, &mut run)? else { break };
            if self.land(landing, state, &mut run)?.is_break() {
                break;
            }
        }
        Ok(run.statistics)
    }

    /// All events within a time, in their order.
    ///
    /// # Errors
    /// As [`advance`](Self::advance).
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

    /// Refuses what cannot begin.
    pub(super) fn begin(
        &mut self,
        state: &HybridState<T>,
        duration: T,
        p: &[T],
    ) -> Result<(), HybridError> {
        self.series.iter_mut().for_each(|series| series.events = 0);
        self.pace = None;
        let (time, mode, modes) = (state.time.real(), state.mode, self.modes.len());
        let Some(Mode { name, states }) = self.modes.get(mode) else {
            return Err(HybridError::NoMode { time, mode, modes, after: After::default() });
        };
        if duration.real() < 0.0 {
            return Err(HybridError::Backward { duration: duration.real() });
        }
        if self.p.len() != p.len() {
            let expected = self.system.parameters().len();
            if p.len() != expected {
                let (what, mode, found) = ("parameters", name.clone(), p.len());
                return Err(HybridError::Length { what, mode, found, expected });
            }
        }
        if state.x.len() != states.len() {
            let (mode, found, expected) = (name.clone(), state.x.len(), states.len());
            return Err(HybridError::Length { what: "states", mode, found, expected });
        }
        self.p.clear();
        self.p.extend(p.iter().map(T::real));
        self.unit = time_scale(self.system, &self.p);
        self.inside(state, None)
    }

    /// Refuses a state, just after an event or at the start, at which a guard of its mode is negative.
    fn inside(&mut self, state: &HybridState<T>, event: Option<usize>) -> Result<(), HybridError> {
        self.x.clear();
        self.x.extend(state.x.iter().map(T::real));
        let time = state.time.real();
        for &g in &self.watched[state.mode] {
            let value = self.system.guard(g, state.mode, time, &self.x, &self.p);
            if value < 0.0 && value < -NEGATIVE * self.scale_of(g, state.mode, time) {
                let mode = self.modes[state.mode].name.clone();
                let after = After(event.map(|event| self.guards[event].name.clone()));
                let guard = self.guards[g].name.clone();
                return Err(HybridError::Outside { time, mode, guard, value, after });
            }
        }
        Ok(())
    }

    /// The scale of a guard where the state is that in `x`.
    pub(super) fn scale_of(&self, guard: usize, mode: usize, time: f64) -> f64 {
        guard_scale(self.system, (guard, mode), (time, &self.x), &self.p)
    }

    /// Follows the flow of one mode to its end, or to that of the motion.
    pub(super) fn leg<O: HybridObserver<T>>(
        &mut self,
        state: &mut HybridState<T>,
        run: &mut Run<T, O>,
    ) -> Result<Option<Landing<T>>, HybridError> {
        let (system, mode, left) = (self.system, state.mode, run.end - state.time);
        self.prepare_leg(left.real());
        self.x.clear();
        self.x.extend(state.x.iter().map(T::real));
        for k in 0..self.watched[mode].len() {
            let guard = self.watched[mode][k];
            let scale = self.scale_of(guard, mode, state.time.real());
            self.roots[guard].restart(GuardOf { system, guard, mode, scale });
        }
        let HybridFlow { flow, roots, event, pace, p, watched, unit, .. } = self;
        let (watched, unit) = (&watched[mode], *unit);
        let mut lookout =
            Lookout { system, mode, watched, roots, event, pace, p, unit, leg: (state.time, left) };
        let (mut landing, mut last) = (None, run.end);
        lookout.event.before.clear();
        lookout.event.before.extend_from_slice(&state.x);
        let field = T::in_mode(system, mode, T::zero());
        let outcome = flow.observe(&field, state.time, left, &mut state.x, run.p, |step| {
            landing = lookout.landing(step);
            let end = landing.map_or(T::one(), |landing| landing.root.fraction);
            run.observer.step(mode, step, end);
            let ended = run.observer.ends();
            if ended {
                last = step.time(T::one());
            }
            if ended || landing.is_some() {
                ControlFlow::Break(())
            } else {
                ControlFlow::Continue(())
            }
        });
        match (landing, outcome) {
            (landing, Ok(statistics)) => {
                run.statistics.flow = sum(run.statistics.flow, statistics);
                if landing.is_none() {
                    state.time = last;
                }
                Ok(landing)
            }
            // The step went on beyond the event.
            (Some(landing), Err(_)) => Ok(Some(landing)),
            (None, Err(source)) => {
                state.x.copy_from_slice(&self.event.before);
                Err(HybridError::Flow { mode: self.modes[mode].name.clone(), source })
            }
        }
    }

    /// Passes an event, and the accumulation of such events if it is near.
    pub(super) fn land<O: HybridObserver<T>>(
        &mut self,
        Landing { guard, root }: Landing<T>,
        state: &mut HybridState<T>,
        run: &mut Run<T, O>,
    ) -> Result<ControlFlow<()>, HybridError> {
        (self.event.guard, self.event.mode) = (guard, state.mode);
        (self.event.approach, self.event.accumulation) = (-root.rate.real(), false);
        self.stands_still(run)?;
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
        let next = self.system.next_mode(guard, self.event.mode, time_of_event, &self.x, &self.p);
        if self.pass(next, state, run)?.is_break() {
            return Ok(ControlFlow::Break(()));
        }
        match time.filter(|time| time.real() <= run.end.real()) {
            Some(time) => self.settle(accumulation, time, state, run),
            None => Ok(ControlFlow::Continue(())),
        }
    }

    /// The position of the series of a guard in a mode.
    pub(super) fn series_of(&self, guard: usize, mode: usize) -> usize {
        mode * self.guards.len() + guard
    }

    /// Real parts of the state before the event.
    fn real_event(&mut self) {
        self.x.clear();
        self.x.extend(self.event.before.iter().map(T::real));
    }

    /// Resets the state to the next mode and shows the event.
    pub(super) fn pass<O: HybridObserver<T>>(
        &mut self,
        next: usize,
        state: &mut HybridState<T>,
        run: &mut Run<T, O>,
    ) -> Result<ControlFlow<()>, HybridError> {
        let event = &mut self.event;
        let Some(mode) = self.modes.get(next) else {
            let after = After(Some(self.guards[event.guard].name.clone()));
            let (time, modes) = (event.time.real(), self.modes.len());
            (state.time, state.x) = (event.time, event.before.clone());
            return Err(HybridError::NoMode { time, mode: next, modes, after });
        };
        event.next = next;
        event.after.clear();
        event.after.resize(mode.states.len(), T::zero());
        let (guard, modes, time) = (event.guard, (event.mode, next), event.time);
        self.system.reset(guard, modes, time, &event.before, run.p, &mut event.after);
        (state.mode, state.time) = (next, time);
        state.x.clear();
        state.x.extend_from_slice(&event.after);
        run.statistics.events += 1;
        let outcome = run.observer.event(event);
        self.inside(state, Some(guard))?;
        Ok(outcome)
    }

    /// Refuses too many events without progress of time.
    fn stands_still<O>(&self, run: &mut Run<T, O>) -> Result<(), HybridError> {
        let (time, (since, count)) = (self.event.time.real(), run.still);
        run.still = if time - since > INSTANT * self.unit { (time, 0) } else { (since, count + 1) };
        if run.still.1 <= self.settings.at_once {
            return Ok(());
        }
        Err(HybridError::Standstill {
            time,
            mode: self.modes[self.event.mode].name.clone(),
            guard: self.guards[self.event.guard].name.clone(),
            events: run.still.1,
            span: time - since,
        })
    }
}

/// The cost of two flows.
pub(super) fn sum(a: Statistics, b: Statistics) -> Statistics {
    Statistics {
        evaluations: a.evaluations + b.evaluations,
        accepted: a.accepted + b.accepted,
        rejected: a.rejected + b.rejected,
    }
}
