//! Where a member is while it is under way.

use super::member::Member;
use crate::core::hybrid::chatter::Series;
use crate::core::hybrid::crowding::Crowd;
use crate::core::hybrid::error::HybridError;
use crate::core::hybrid::simulation::{HybridState, HybridStatistics};
use crate::core::linalg::refill;
use crate::core::ode::{LaneState, Sign};
use crate::core::scalar::Scalar;
use std::ops::ControlFlow;

/// A member under way.
pub(super) struct Slot<T: Scalar> {
    pub member: usize,
    pub duration: T,
    /// The state where its leg began.
    pub state: HybridState<T>,
    pub p: Vec<T>,
    /// Real parts of the parameters.
    pub real_p: Vec<f64>,
    pub end: T,
    pub statistics: HybridStatistics,
    pub crowd: Crowd,
    pub series: Vec<Series<T>>,
    pub pace: Option<f64>,
    /// When each event at given times came last.
    pub fired: Vec<f64>,
    pub lane_state: LaneState<T>,
    /// What is known of the guards of its mode.
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

/// What is to be done with a member.
#[derive(Clone, Copy)]
pub(super) enum Next {
    /// Its duration begins.
    Start,
    /// A leg begins.
    Leg,
    /// A leg is followed without the others.
    Alone,
    /// Its duration has passed.
    Finish,
}

/// What becomes of a member after something was done with it: it goes on in the lanes, or has
/// ended.
pub(super) type Outcome = Result<ControlFlow<()>, HybridError>;
