//! Slots, which store the simulated motions in progress.

use super::member::Member;
use crate::core::hybrid::chatter::Series;
use crate::core::hybrid::crowding::Crowd;
use crate::core::hybrid::error::HybridError;
use crate::core::hybrid::simulation::{HybridState, HybridStatistics};
use crate::core::linalg::refill;
use crate::core::ode::{LaneState, Sign};
use crate::core::scalar::Scalar;
use std::ops::ControlFlow;

/// A slot, which stores one simulated motion in progress.
pub(super) struct Slot<T: Scalar> {
    pub member: usize,
    pub duration: T,
    /// The state at the start of the motion's present leg (the part of the motion since its last
    /// event).
    pub state: HybridState<T>,
    pub p: Vec<T>,
    /// The real parts of the motion's parameters.
    pub real_p: Vec<f64>,
    pub end: T,
    pub statistics: HybridStatistics,
    pub crowd: Crowd,
    pub series: Vec<Series<T>>,
    pub pace: Option<f64>,
    /// The last time at which each timed event of the motion occurred.
    pub fired: Vec<f64>,
    pub lane_state: LaneState<T>,
    /// The known signs of the guards of the motion's mode.
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

/// The next action for one of the simulated motions.
#[derive(Clone, Copy)]
pub(super) enum Next {
    /// The duration begins.
    Start,
    /// A leg begins.
    Leg,
    /// The next leg of the motion (the part up to its next event) is simulated separately from the
    /// other motions.
    Alone,
    /// The duration of the motion has passed.
    Finish,
}

/// The outcome of an action for a motion: the motion continues in the lanes, or it has ended.
pub(super) type Outcome = Result<ControlFlow<()>, HybridError>;
