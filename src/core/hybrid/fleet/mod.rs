//! Many motions of one system at once, the flows of which step abreast in the lanes of a vector
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

/// (H) The number of motions that are under way at the same time: with a few modes, most find
/// others in theirs to go abreast. Only time depends on it.
const UNDER_WAY: usize = 64;

/// Sees many motions, each by its number.
pub trait FleetObserver<T: Scalar> {
    /// Whether steps are shown as well, which makes those abreast slower.
    fn sees_steps(&self) -> bool {
        false
    }

    /// A step of a member, as [`HybridObserver::step`](super::event::HybridObserver::step).
    fn step<F: FieldIn<T>>(
        &mut self,
        _member: usize,
        _mode: usize,
        _step: &mut Step<F, T>,
        _end: T,
    ) {
    }

    /// An event of a member.
    fn event(&mut self, _member: usize, _event: &Event<T>) {}

    /// The duration of a member has passed. It goes on for the same duration from the state as it
    /// is left here, or ends.
    fn arrived(
        &mut self,
        member: usize,
        state: &mut HybridState<T>,
        statistics: &HybridStatistics,
    ) -> ControlFlow<()>;
}

/// The motions of many members of one system, each as if it were alone: what becomes of a member is
/// the same to the last bit whatever others there are, and in whichever order.
///
/// It is what [`HybridFlow`] finds, but for rounding, for `f64` and for `Dual64`. Steps are taken,
/// and guards are seen to keep clear of zero, for several members at a time that are in the same
/// mode; where a guard may vanish, one member is looked at alone. A system says by
/// [`in_lanes`](super::system::HybridSystem::in_lanes) that its equations can be evaluated so.
/// Otherwise, and by an implicit method, members are followed one after the other.
///
/// ```
/// use std::ops::ControlFlow;
/// use tangency::core::hybrid::{Fleet, FleetObserver, HybridSettings, HybridState, HybridStatistics, Member};
/// use tangency::problems::mita::Actuator;
/// /// Follows every member for two periods.
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
    /// What is seen of the guards of a mode in the last step.
    forecasts: Vec<EventForecast>,
    /// The guards to be looked at alone.
    candidates: Vec<usize>,
    slots: Vec<Slot<T>>,
}

impl<'a, T: FleetNumber> Fleet<'a, T>
where
    GuardOf<'a>: Watchable<T>,
{
    /// The motions of a system with these settings.
    ///
    /// # Errors
    /// [`HybridError::Settings`] if a setting of the flow has no meaning.
    pub fn new(
        system: &'a dyn HybridEquations,
        settings: HybridSettings,
    ) -> Result<Self, HybridError> {
        Self::with(system, settings, system.in_lanes())
    }

    /// The same in the lanes of other registers than the system states, for comparison. Without
    /// these registers members are followed one after the other.
    ///
    /// # Errors
    /// As [`new`](Self::new).
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

    /// How many members step abreast; 1 if they are followed one after the other.
    pub fn lanes(&self) -> usize {
        self.stepper.as_ref().map_or(1, |stepper| stepper.lanes())
    }

    /// Moves all members on, each for its duration, and again as long as the observer says so.
    /// Where an error ends the motion of a member, its state is that after its last event.
    ///
    /// # Errors
    /// For each member, as [`HybridFlow::advance`].
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

/// Which slots wait in which mode, which are free, and what has become of the members.
struct Scheduler<'m, T> {
    /// Berths by the mode of their members.
    queues: Vec<Vec<usize>>,
    free: Vec<usize>,
    members: &'m mut [Member<T>],
    results: Vec<Result<(), HybridError>>,
}

impl<T: Scalar> Scheduler<'_, T> {
    /// The mode in which most are waiting, and as many of them as go abreast.
    fn longest(&mut self, lanes: usize) -> Option<(usize, [usize; MOST_LANES], usize)> {
        let modes = self.queues.iter_mut().enumerate().filter(|(_, queue)| !queue.is_empty());
        let (mode, queue) = modes.max_by_key(|(_, queue)| queue.len())?;
        let count = queue.len().min(lanes);
        let mut abreast = [0; MOST_LANES];
        abreast[..count].copy_from_slice(&queue[queue.len() - count..]);
        queue.truncate(queue.len() - count);
        Some((mode, abreast, count))
    }

    /// Puts a member into the queue of its mode, or back where it came from.
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
