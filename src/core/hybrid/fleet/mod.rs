//! Batched simulation: many motions of one system, whose flows step together in the lanes of a vector
//! register.

mod abreast;
mod member;
mod slot;
mod steps;

use self::abreast::Abreast;
pub use self::abreast::FleetNumber;
pub use self::member::Member;
use self::slot::{Next, Outcome, Slot};
use super::erased::HybridEquations;
use super::error::HybridError;
use super::event::Event;
use super::leg::GuardOf;
use super::simulation::{HybridFlow, HybridSettings, HybridState, HybridStatistics};
use crate::core::ode::{EventForecast, Step};
use crate::core::problem::{FieldIn, Watchable};
use crate::core::scalar::{LaneWidth, MOST_LANES, Scalar};
use std::ops::ControlFlow;

/// Heuristic: the number of motions in progress; in a system with a few modes, most motions then
/// share their mode with others. The number of motions in progress affects only the run time.
const UNDER_WAY: usize = 64;

/// An observer of many motions, identified by their indices.
pub trait FleetObserver<T: Scalar> {
    /// Whether the observer also observes integration steps, which makes batched steps slower.
    fn sees_steps(&self) -> bool {
        false
    }

    /// Observes an integration step of one of the motions, in the same way as
    /// [`HybridObserver::step`](super::event::HybridObserver::step).
    fn step<F: FieldIn<T>>(
        &mut self,
        _member: usize,
        _mode: usize,
        _step: &mut Step<F, T>,
        _end: T,
    ) {
    }

    /// Observes an event of one of the motions.
    fn event(&mut self, _member: usize, _event: &Event<T>) {}

    /// Observes a motion at the end of its duration. If the method returns `Continue`, the motion
    /// continues for the same duration from the possibly modified state; otherwise the motion ends.
    fn arrived(
        &mut self,
        member: usize,
        state: &mut HybridState<T>,
        statistics: &HybridStatistics,
    ) -> ControlFlow<()>;
}

/// A simulation of many motions of one system, which are independent of each other: the result for
/// each motion is bit-identical for all sets and orders of simulated motions.
///
/// Results agree with [`HybridFlow`] up to rounding errors, both for `f64` and for `Dual64`.
/// Several motions in the same mode are advanced together by vector instructions. One test shows,
/// for all motions that are advanced together, which guards stay clear of zero; a motion with a
/// guard that could vanish is examined separately.
/// [`in_lanes`](super::system::HybridSystem::in_lanes) declares that a system's equations can be
/// evaluated in lanes. If the system's equations cannot be evaluated in lanes, or if the
/// integration method is implicit, the motions are simulated one after another.
///
/// ```
/// use std::ops::ControlFlow;
/// use tangency::core::hybrid::{Fleet, FleetObserver, HybridSettings, HybridState, HybridStatistics, Member};
/// use tangency::problems::mita::Actuator;
/// /// Simulates every member for two periods.
/// struct Twice([usize; 20]);
/// impl FleetObserver<f64> for Twice {
///     fn arrived(&mut self, k: usize, state: &mut HybridState<f64>, _: &HybridStatistics) -> ControlFlow<()> {
///         self.0[k] += 1;
///         state.time = 0.0;
///         if self.0[k] < 2 { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
///     }
/// }
/// let member = |k: usize| {
///     let mut p = Actuator::DEFAULTS.to_vec();
///     p[0] = 0.3 + 0.01 * k as f64;
///     Member { state: HybridState { mode: Actuator::STICK, time: 0.0, x: vec![0.0; 2] }, p }
/// };
/// let mut members: Vec<Member<f64>> = (0..20).map(member).collect();
/// let (mut fleet, mut twice) = (Fleet::new(&Actuator, HybridSettings::default())?, Twice([0; 20]));
/// let period = std::f64::consts::PI / 0.5;
/// let results = fleet.advance(&mut members, |_| period, &mut twice);
/// assert!(results.iter().all(Result::is_ok) && twice.0 == [2; 20]);
/// # Ok::<(), tangency::core::hybrid::HybridError>(())
/// ```
pub struct Fleet<'a, T: FleetNumber> {
    worker: HybridFlow<'a, T>,
    stepper: Option<Box<dyn Abreast<T>>>,
    /// The forecasts of the zeros of a mode's guards in the last integration step.
    forecasts: Vec<EventForecast>,
    /// The guards that need a separate search for zeros in the last integration step.
    candidates: Vec<usize>,
    slots: Vec<Slot<T>>,
}

impl<'a, T: FleetNumber> Fleet<'a, T>
where
    GuardOf<'a>: Watchable<T>,
{
    /// Creates a simulation of a system with these settings.
    ///
    /// # Errors
    /// [`HybridError::Settings`] if a setting of the simulation is invalid.
    pub fn new(
        system: &'a dyn HybridEquations,
        settings: HybridSettings,
    ) -> Result<Self, HybridError> {
        Self::with(system, settings, system.in_lanes())
    }

    /// Creates a simulation whose vector registers differ from the system's choice, for comparison. If
    /// the vector registers are unavailable, the motions are simulated one after another.
    ///
    /// # Errors
    /// The same errors as [`new`](Self::new).
    pub fn in_lanes(
        system: &'a dyn HybridEquations,
        settings: HybridSettings,
        width: LaneWidth,
    ) -> Result<Self, HybridError> {
        Self::with(system, settings, system.in_lanes().map(|_| width))
    }

    fn with(
        system: &'a dyn HybridEquations,
        settings: HybridSettings,
        width: Option<LaneWidth>,
    ) -> Result<Self, HybridError> {
        let worker = HybridFlow::new(system, settings.clone())?;
        let stepper = width.and_then(|width| T::abreast(width, &settings.flow));
        let (forecasts, candidates, slots) = Default::default();
        Ok(Fleet { worker, stepper, forecasts, candidates, slots })
    }

    /// Returns the number of motions that are advanced together; 1 if the motions are simulated one
    /// after another.
    pub fn lanes(&self) -> usize {
        self.stepper.as_ref().map_or(1, |stepper| stepper.lanes())
    }

    /// Advances every motion by its duration, repeatedly while the observer returns `Continue`. If
    /// an error ends a motion, its state is the state after its last event.
    ///
    /// # Errors
    /// Every motion has its own result, with the errors of [`HybridFlow::advance`].
    pub fn advance(
        &mut self,
        members: &mut [Member<T>],
        duration: impl Fn(&Member<T>) -> T,
        observer: &mut impl FleetObserver<T>,
    ) -> Vec<Result<(), HybridError>> {
        let mut waiting = 0..members.len();
        let mut scheduler = Scheduler {
            queues: self.worker.modes.iter().map(|_| Vec::new()).collect(),
            free: (0..UNDER_WAY).collect(),
            results: members.iter().map(|_| Ok(())).collect(),
            members,
        };
        self.slots.resize_with(UNDER_WAY, Slot::new);
        self.stepper.iter_mut().for_each(|stepper| stepper.vacate());
        let lanes = self.lanes();
        loop {
            while let Some(number) = scheduler.free.pop() {
                let Some(member) = waiting.next() else { break };
                let loaded = &scheduler.members[member];
                self.slots[number].load(member, loaded, duration(loaded));
                let outcome = self.go(number, Next::Start, observer);
                scheduler.go_on(number, &self.slots[number], outcome);
            }
            let Some((mode, abreast, count)) = scheduler.longest(lanes) else { break };
            let errors = self.attempt(mode, &abreast[..count]);
            for (lane, slot) in abreast[..count].iter().enumerate() {
                let outcome = self.classify(mode, (lane, *slot), errors[lane], observer);
                scheduler.go_on(*slot, &self.slots[*slot], outcome);
            }
        }
        scheduler.results
    }
}

/// The slots (places for simulated motions) that wait in each mode, the free slots, and the results
/// of the motions that have ended.
struct Scheduler<'m, T> {
    /// The slots whose motions wait for an integration step, grouped by the mode of their motions.
    queues: Vec<Vec<usize>>,
    free: Vec<usize>,
    members: &'m mut [Member<T>],
    results: Vec<Result<(), HybridError>>,
}

impl<T: Scalar> Scheduler<'_, T> {
    /// Returns the mode with the largest number of waiting motions, and the slots of at most as
    /// many of these motions as the registers have lanes.
    fn longest(&mut self, lanes: usize) -> Option<(usize, [usize; MOST_LANES], usize)> {
        let modes = self.queues.iter_mut().enumerate().filter(|(_, queue)| !queue.is_empty());
        let (mode, queue) = modes.max_by_key(|(_, queue)| queue.len())?;
        let count = queue.len().min(lanes);
        let mut abreast = [0; MOST_LANES];
        abreast[..count].copy_from_slice(&queue[queue.len() - count..]);
        queue.truncate(queue.len() - count);
        Some((mode, abreast, count))
    }

    /// Queues a motion in its mode, or, if the motion has ended, stores its state and its result.
    fn go_on(&mut self, number: usize, slot: &Slot<T>, outcome: Outcome) {
        if let Ok(ControlFlow::Continue(())) = outcome {
            self.queues[slot.state.mode].push(number);
            return;
        }
        self.members[slot.member].state.clone_from(&slot.state);
        self.results[slot.member] = outcome.map(|_| ());
        self.free.push(number);
    }
}
