//! Slots, which store the members in progress.

use super::member::Member;
use crate::core::hybrid::chatter::Series;
use crate::core::hybrid::crowding::Crowd;
use crate::core::hybrid::error::HybridError;
use crate::core::hybrid::simulation::{HybridState, HybridStatistics};
use crate::core::linalg::refill;
use crate::core::ode::{LaneState, Sign};
use crate::core::scalar::Scalar;
use std::ops::ControlFlow;

/// A slot, which stores one member in progress.
pub(super) struct Slot<T: Scalar> {
    pub member: usize,
    pub duration: T,
    /// The state at the start of the member's present leg.
    pub state: HybridState<T>,
    pub p: Vec<T>,
    /// The real parts of the member's parameters.
    pub real_p: Vec<f64>,
    pub end: T,
    pub statistics: HybridStatistics,
    pub crowd: Crowd,
    pub series: Vec<Series<T>>,
    pub pace: Option<f64>,
    /// The last time at which each timed event of the member occurred.
    pub fired: Vec<f64>,
    pub lane_state: LaneState<T>,
    /// The known signs of the guards of the member's mode.
    pub signs: Vec<Sign>,
}

impl<T: Scalar> Slot<T> {
    pub fn new() -> Self {
        Slot {
            member: 0,
            duration: T::zero(),
            state: HybridState { mode: 0, time: T::zero(), x: Vec::new() },
            p: Vec::new(),
            real_p: Vec::new(),
            end: T::zero(),
            statistics: HybridStatistics::default(),
            crowd: Crowd::from(0.0),
            series: Vec::new(),
            pace: None,
            fired: Vec::new(),
            lane_state: LaneState::new(),
            signs: Vec::new(),
        }
    }

    pub fn load(&mut self, number: usize, member: &Member<T>, duration: T) {
        (self.member, self.duration) = (number, duration);
        self.state.clone_from(&member.state);
        self.p.clone_from(&member.p);
        refill(&mut self.real_p, member.p.iter().map(T::real));
    }
}

/// The next action for a member of a fleet.
#[derive(Clone, Copy)]
pub(super) enum Next {
    /// The duration begins.
    Start,
    /// A leg begins.
    Leg,
    /// The member of the fleet simulates its next leg alone, separately from the other members.
    Alone,
    /// The duration of the member has passed.
    Finish,
}

/// The outcome of an action for a member: the member continues in the lanes, or its motion has
/// ended.
pub(super) type Outcome = Result<ControlFlow<()>, HybridError>;
