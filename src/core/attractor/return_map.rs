//! Poincaré maps of autonomous hybrid systems, sampled at an event.

use super::error::StroboscopicError;
use super::period::{Layout, Period, Recorder, Seen};
use super::stroboscopic::StroboscopicMap;
use crate::core::hybrid::{
    Event, EventNumber, GuardOf, HybridEquations, HybridFlow, HybridObserver, HybridSettings,
    HybridState, Member, time_scale,
};
use crate::core::ode::Step;
use crate::core::problem::{FieldIn, Forcing, Watchable, position};
use num_dual::Dual64;
use std::ops::ControlFlow;

/// Heuristic: the time, in units of the time scale, after which states are compared with earlier
/// ones to detect a motion at rest.
const LOOK: f64 = 50.0;
/// Discretisation: a motion counts as being at rest if no state changes by more than this bound over
/// the time [`LOOK`], in units of the state's scale; the bound is larger than the errors of flows.
const MOVED: f64 = 1e-9;
/// Heuristic: the default longest waiting time for a return, in units of the time scale.
const LONGEST: f64 = 10_000.0;

/// The motion of an autonomous hybrid system, sampled just after every event of a given name: the
/// Poincaré map at the event. A period of a return map is one return: the period of a cycle is a
/// number of returns, and the Lyapunov exponent is a growth rate per return. Motion at rest is
/// sampled after 50 time scales; it counts as a cycle of one return in which the sampling event
/// does not occur, and its exponent is `None`.
///
/// ```
/// use tangency::core::attractor::{AttractorSearch, ReturnMap};
/// use tangency::core::hybrid::{HybridSettings, HybridState};
/// use tangency::hybrid_system;
/// hybrid_system! {
///     /// The voltage `v' = 1 − v/2` rises to `1 + a z`, where it drops to 0, and `z` to a third of itself.
///     struct Lamp [a] {
///         mode dark [v, z] {
///             d/dt v = -v * 0.5 + 1.0;
///             d/dt z = T::zero();
///             event flash: a * z - v + 1.0 => dark { v: T::zero(), z: z / 3.0 };
///         }
///     }
/// }
/// let mut lamp = ReturnMap::of(&Lamp, HybridSettings::default(), &[], "flash")?;
/// let start = HybridState { mode: 0, time: 0.0, x: vec![0.0, 0.3] };
/// let found = AttractorSearch::default().follow(&mut lamp, start, &[0.1])?;
/// assert_eq!(found.periods, Some(1));
/// // Each return divides deviations by three.
/// assert!((found.exponent.expect("an exponent").value + 3.0_f64.ln()).abs() < 1e-9);
/// # Ok::<(), tangency::core::attractor::StroboscopicError>(())
/// ```
pub struct ReturnMap<'a> {
    real: HybridFlow<'a, f64>,
    dual: HybridFlow<'a, Dual64>,
    seen: Seen<'a>,
    /// The number of the event after which motion is sampled.
    event: usize,
    /// The longest waiting time for the sampling event, in units of the time scale.
    longest: f64,
}

impl<'a> ReturnMap<'a> {
    /// Creates the return map of a system for an event, and records the named measures of every
    /// return.
    ///
    /// # Errors
    /// [`StroboscopicError::Forced`] if the system has a forcing, so that its period map must be
    /// used; `NoMeasure` if the system has no such event or measure; `Hybrid` if a setting is
    /// invalid.
    pub fn of(
        system: &'a dyn HybridEquations,
        settings: HybridSettings,
        measures: &[String],
        event: &str,
    ) -> Result<Self, StroboscopicError> {
        if system.forcing() != Forcing::None {
            return Err(StroboscopicError::Forced(event.into()));
        }
        let seen = Seen::of(system, measures)?;
        Ok(ReturnMap {
            real: HybridFlow::new(system, settings.clone())?,
            dual: HybridFlow::new(system, settings)?,
            event: position("event", event, &seen.layout.events)?,
            longest: LONGEST,
            seen,
        })
    }

    /// Sets the longest waiting time for the sampling event, in units of the time scale: 10 000 by
    /// default.
    pub fn waiting(mut self, longest: f64) -> Self {
        self.longest = longest;
        self
    }
}

/// An observer of a motion that stops the simulation when an event occurs.
struct Until<'s, R> {
    seen: &'s Seen<'s>,
    event: usize,
    inner: R,
    came: bool,
}

impl<T: EventNumber, R: HybridObserver<T>> HybridObserver<T> for Until<'_, R> {
    fn step<F: FieldIn<T>>(&mut self, mode: usize, step: &mut Step<F, T>, end: T) {
        self.inner.step(mode, step, end);
    }

    fn event(&mut self, event: &Event<T>) -> ControlFlow<()> {
        self.came = self.seen.numbers[event.guard] == self.event;
        match self.inner.event(event) {
            ControlFlow::Continue(()) if !self.came => ControlFlow::Continue(()),
            _ => ControlFlow::Break(()),
        }
    }
}

/// Advances a motion to the sampling event without recording the motion, and then resets the time
/// to its value at the start.
fn advanced<'a, T: EventNumber>(
    flow: &mut HybridFlow<'a, T>,
    member: &mut Member<T>,
    (seen, event): (&Seen, usize),
    longest: f64,
) -> Result<(), StroboscopicError>
where
    GuardOf<'a>: Watchable<T>,
{
    let begins = member.state.time;
    let came = returned(flow, member, &mut Until { seen, event, inner: (), came: false }, longest);
    member.state.time = begins;
    came
}

/// Advances a motion to the sampling event, or until it rests, for at most `longest` time scales.
fn returned<'a, T: EventNumber, R: HybridObserver<T>>(
    flow: &mut HybridFlow<'a, T>,
    Member { state, p }: &mut Member<T>,
    until: &mut Until<R>,
    longest: f64,
) -> Result<(), StroboscopicError>
where
    GuardOf<'a>: Watchable<T>,
{
    let event = until.seen.layout.events[until.event].clone();
    let real: Vec<f64> = p.iter().map(T::real).collect();
    let (system, unit) = (flow.system(), time_scale(flow.system(), &real));
    let (look, mut within) = (LOOK * unit, 0.0);
    while within < longest * unit {
        let (mode, x) = (state.mode, state.x.iter().map(T::real).collect::<Vec<f64>>());
        flow.advance(state, T::constant(look), p, until)?;
        if until.came {
            return Ok(());
        }
        within += look;
        let mut sizes = system.scales_of(mode, &real);
        sizes.resize(x.len(), 1.0);
        let moved = state.x.iter().zip(&x).zip(&sizes).map(|((a, b), s)| (a.real() - b).abs() / s);
        if state.mode == mode && moved.fold(0.0, f64::max) <= MOVED {
            // At rest, the event never occurs.
            return Ok(());
        }
    }
    Err(StroboscopicError::Late { event, within, units: within / unit })
}

impl StroboscopicMap for ReturnMap<'_> {
    fn layout(&self) -> &Layout {
        &self.seen.layout
    }

    fn initial(&self, state: HybridState<f64>, p: &[f64]) -> HybridState<f64> {
        self.real.initial(state, p)
    }

    fn scales(&self, mode: usize, p: &[f64]) -> Vec<f64> {
        self.seen.system.scales_of(mode, p)
    }

    fn advance(&mut self, member: &mut Member<f64>) -> Result<(), StroboscopicError> {
        advanced(&mut self.real, member, (&self.seen, self.event), self.longest)
    }

    fn record(&mut self, member: &mut Member<f64>) -> Result<Period, StroboscopicError> {
        let (seen, start) = (&self.seen, member.state.clone());
        let inner = Recorder::new(seen, &start);
        let mut until = Until { seen, event: self.event, inner, came: false };
        returned(&mut self.real, member, &mut until, self.longest)?;
        let recorded = until.inner.finish(&member.state, &member.p);
        member.state.time = start.time;
        Ok(recorded)
    }

    /// Whether motion rests in a recorded period: a period without rest ends with the sampling
    /// event.
    fn rests(&self, period: &Period) -> bool {
        period.events.is_empty()
    }

    fn push_forward(&mut self, member: &mut Member<Dual64>) -> Result<(), StroboscopicError> {
        advanced(&mut self.dual, member, (&self.seen, self.event), self.longest)
    }
}
