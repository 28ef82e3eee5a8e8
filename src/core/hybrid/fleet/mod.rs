//! Many motions of one system at once, the flows of which step abreast in the lanes of a vector register.

mod berth;
mod steps;

use self::berth::{Berth, Next, Outcome};
use super::erased::HybridEquations;
use super::error::HybridError;
use super::event::Event;
use super::simulation::{HybridFlow, HybridSettings, HybridState, HybridStatistics};
use crate::core::flow::{Abreast, LANES, Outlook};
use std::ops::ControlFlow;

/// So many motions are under way at the same time: with a few modes, most find others in theirs to go abreast.
const UNDER_WAY: usize = 64;

/// One of many motions.
#[derive(Clone, Debug, PartialEq)]
pub struct Member {
    /// Where it is.
    pub state: HybridState<f64>,
    /// The parameters.
    pub p: Vec<f64>,
}

/// Sees many motions, each by its number.
pub trait FleetObserver {
    /// An event of a member.
    fn event(&mut self, _member: usize, _event: &Event<f64>) {}

    /// The duration of a member has passed. It goes on for the same duration from the state as it is left here, or
    /// ends.
    fn arrived(
        &mut self,
        member: usize,
        state: &mut HybridState<f64>,
        statistics: &HybridStatistics,
    ) -> ControlFlow<()>;
}

/// The motions of many members of one system, each as if it were alone: what becomes of a member is the same to the
/// last bit whatever others there are, and in whichever order.
///
/// It is what [`HybridFlow`] finds, but for rounding. Steps are taken, and guards are seen to keep clear of zero, for
/// eight members at a time that are in the same mode; where a guard may vanish, one member is looked at alone. A
/// system says by [`in_lanes`](HybridSystem::in_lanes) that its equations can be evaluated so. Otherwise, and by an
/// implicit method, members are followed one after the other.
///
/// ```
/// use std::ops::ControlFlow;
/// use tangency::core::hybrid::{Fleet, FleetObserver, HybridSettings, HybridState, HybridStatistics, Member};
/// use tangency::problems::mita::Actuator;
/// /// Follows every member for two periods.
/// struct Twice([usize; 20]);
/// impl FleetObserver for Twice {
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
/// let mut members: Vec<Member> = (0..20).map(member).collect();
/// let (mut fleet, mut twice) = (Fleet::new(&Actuator, HybridSettings::default())?, Twice([0; 20]));
/// let period = std::f64::consts::PI / 0.5;
/// let results = fleet.advance(&mut members, |_| period, &mut twice);
/// assert!(results.iter().all(Result::is_ok) && twice.0 == [2; 20]);
/// # Ok::<(), tangency::core::hybrid::HybridError>(())
/// ```
pub struct Fleet<'a> {
    worker: HybridFlow<'a, f64>,
    abreast: Option<Abreast>,
    /// What is seen of the guards of a mode in the last step.
    outlooks: Vec<Outlook>,
    /// The guards to be looked at alone.
    loud: Vec<usize>,
    berths: Vec<Berth>,
}

impl<'a> Fleet<'a> {
    /// The motions of a system with these settings.
    ///
    /// # Errors
    /// [`HybridError::Settings`] if a setting of the flow has no meaning.
    pub fn new(
        system: &'a dyn HybridEquations,
        settings: HybridSettings,
    ) -> Result<Self, HybridError> {
        let worker = HybridFlow::new(system, settings)?;
        let abreast = Abreast::new(&settings.flow).filter(|_| system.in_lanes());
        let (outlooks, loud, berths) = Default::default();
        Ok(Fleet { worker, abreast, outlooks, loud, berths })
    }

    /// Moves all members on, each for its duration, and again as long as the observer says so. Where an error ends
    /// the motion of a member, its state is that after its last event.
    ///
    /// # Errors
    /// For each member, as [`HybridFlow::advance`].
    pub fn advance(
        &mut self,
        members: &mut [Member],
        duration: impl Fn(&Member) -> f64,
        observer: &mut impl FleetObserver,
    ) -> Vec<Result<(), HybridError>> {
        let mut waiting = 0..members.len();
        let mut harbour = Harbour {
            queues: self.worker.modes.iter().map(|_| Vec::new()).collect(),
            free: (0..UNDER_WAY).collect(),
            results: members.iter().map(|_| Ok(())).collect(),
            members,
        };
        self.berths.resize_with(UNDER_WAY, Berth::new);
        loop {
            while let Some(number) = harbour.free.pop() {
                let Some(member) = waiting.next() else { break };
                let boarding = &harbour.members[member];
                self.berths[number].board(member, boarding, duration(boarding));
                let outcome = self.go(number, Next::Depart, observer);
                harbour.go_on(number, &self.berths[number], outcome);
            }
            let Some((mode, abreast, count)) = harbour.longest() else { break };
            let errors = self.attempt(mode, &abreast[..count]);
            for (lane, berth) in abreast[..count].iter().enumerate() {
                let outcome = self.judge(mode, (lane, *berth), errors[lane], observer);
                harbour.go_on(*berth, &self.berths[*berth], outcome);
            }
        }
        harbour.results
    }
}

/// Which berths wait in which mode, which are free, and what has become of the members.
struct Harbour<'m> {
    /// Berths by the mode of their members.
    queues: Vec<Vec<usize>>,
    free: Vec<usize>,
    members: &'m mut [Member],
    results: Vec<Result<(), HybridError>>,
}

impl Harbour<'_> {
    /// The mode in which most are waiting, and as many of them as go abreast.
    fn longest(&mut self) -> Option<(usize, [usize; LANES], usize)> {
        let modes = self.queues.iter_mut().enumerate().filter(|(_, queue)| !queue.is_empty());
        let (mode, queue) = modes.max_by_key(|(_, queue)| queue.len())?;
        let count = queue.len().min(LANES);
        let mut abreast = [0; LANES];
        abreast[..count].copy_from_slice(&queue[queue.len() - count..]);
        queue.truncate(queue.len() - count);
        Some((mode, abreast, count))
    }

    /// Puts a member into the queue of its mode, or back where it came from.
    fn go_on(&mut self, number: usize, berth: &Berth, outcome: Outcome) {
        if let Ok(ControlFlow::Continue(())) = outcome {
            self.queues[berth.state.mode].push(number);
            return;
        }
        self.members[berth.member].state.clone_from(&berth.state);
        self.results[berth.member] = outcome.map(|_| ());
        self.free.push(number);
    }
}
