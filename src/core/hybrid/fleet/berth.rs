//! Where a member is while it is under way.

use super::Member;
use crate::core::flow::{Course, Sign};
use crate::core::hybrid::chatter::Series;
use crate::core::hybrid::error::HybridError;
use crate::core::hybrid::simulation::{HybridState, HybridStatistics};
use std::ops::ControlFlow;

/// A member under way.
pub(super) struct Berth {
    pub member: usize,
    pub duration: f64,
    /// The state where its leg began.
    pub state: HybridState<f64>,
    pub p: Vec<f64>,
    pub end: f64,
    pub statistics: HybridStatistics,
    pub still: (f64, usize),
    pub series: Vec<Series<f64>>,
    pub pace: Option<f64>,
    pub course: Course,
    /// What is known of the guards of its mode.
    pub signs: Vec<Sign>,
}

impl Berth {
    pub fn new() -> Self {
        Berth {
            member: 0,
            duration: 0.0,
            state: HybridState { mode: 0, time: 0.0, x: Vec::new() },
            p: Vec::new(),
            end: 0.0,
            statistics: HybridStatistics::default(),
            still: (0.0, 0),
            series: Vec::new(),
            pace: None,
            course: Course::new(),
            signs: Vec::new(),
        }
    }

    pub fn board(&mut self, number: usize, member: &Member, duration: f64) {
        (self.member, self.duration) = (number, duration);
        self.state.clone_from(&member.state);
        self.p.clone_from(&member.p);
    }
}

/// What is to be done with a member.
#[derive(Clone, Copy)]
pub(super) enum Next {
    /// Its duration begins.
    Depart,
    /// A leg begins.
    Leg,
    /// A leg is followed without the others.
    Alone,
    /// Its duration has passed.
    Arrive,
}

/// What becomes of a member after something was done with it: it goes on in the lanes, or has ended.
pub(super) type Outcome = Result<ControlFlow<()>, HybridError>;
