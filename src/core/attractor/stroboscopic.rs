//! Stroboscopic maps from state to state.

use super::error::StroboscopicError;
use super::period::{Layout, Period};
use crate::core::hybrid::{HybridState, Member};
use num_dual::Dual64;
use std::ops::ControlFlow;

/// A callback that is called after each period of each trajectory; it receives the number of the
/// trajectory, the record of the period if requested, and the state at the end of the period. The
/// returned control flow determines whether the trajectory continues.
pub type EachPeriod<'a> =
    dyn FnMut(usize, Option<Period>, &HybridState<f64>) -> ControlFlow<()> + 'a;

/// A callback that is called after each period of each trajectory; it receives the number of the
/// trajectory, and the trajectory's state with the tangent vector, which the callback may scale.
/// The returned control flow determines whether the trajectory continues.
pub type EachTangent<'a> = dyn FnMut(usize, &mut HybridState<Dual64>) -> ControlFlow<()> + 'a;

/// The outcome of each of many trajectories: `Ok`, or the error with which the trajectory ended.
pub type Outcomes = Vec<Result<(), StroboscopicError>>;

/// A map from state to state: a motion sampled stroboscopically, once a forcing period, or a
/// discrete map.
///
/// States are states of a hybrid system, and their time is the time of the sample; the states of a
/// discrete map have mode 0 and time zero.
pub trait StroboscopicMap {
    /// Returns the names of the modes, events and measures.
    fn layout(&self) -> &Layout;

    /// Converts a state of a mode to the initial state of a motion; the default implementation
    /// returns the given state unchanged.
    fn initial(&self, state: HybridState<f64>, _p: &[f64]) -> HybridState<f64> {
        state
    }

    /// Returns the scales of a mode's states, which are used to compare motions; the default is
    /// empty, so that all scales are 1.
    fn scales(&self, _mode: usize, _p: &[f64]) -> Vec<f64> {
        Vec::new()
    }

    /// Advances the motion by one period.
    ///
    /// # Errors
    /// [`StroboscopicError`] if the motion ends before the end of the period.
    fn advance(&mut self, member: &mut Member<f64>) -> Result<(), StroboscopicError>;

    /// Advances the motion by one period and records it.
    fn record(&mut self, member: &mut Member<f64>) -> Result<Period, StroboscopicError>;

    /// Advances the motion by one period with a tangent vector `v`, stored in the derivatives of
    /// the state: `v ↦ ∂F/∂x v`. The derivatives of the parameters are zero.
    fn push_forward(&mut self, member: &mut Member<Dual64>) -> Result<(), StroboscopicError>;

    /// Whether the motion rests in a recorded period, which means that it has reached an attractor.
    /// If motion rests, its tangent vectors can be advanced without limit, and their growth is
    /// unknown. False by default.
    fn rests(&self, _period: &Period) -> bool {
        false
    }

    /// Advances many trajectories period by period; a trajectory ends when the callback `each`
    /// returns `Break`. The result of each trajectory is bitwise independent of the others. The
    /// default implementation simulates the trajectories one by one.
    fn advance_all(
        &mut self,
        members: &mut [Member<f64>],
        recorded: bool,
        each: &mut EachPeriod,
    ) -> Outcomes {
        advance_each(self, members, recorded, each)
    }

    /// Advances many trajectories, each with a tangent vector, as
    /// [`advance_all`](Self::advance_all) advances states.
    fn push_forward_all(
        &mut self,
        members: &mut [Member<Dual64>],
        each: &mut EachTangent,
    ) -> Outcomes {
        push_forward_each(self, members, each)
    }
}

/// Advances several trajectories one by one.
pub(super) fn advance_each(
    map: &mut (impl StroboscopicMap + ?Sized),
    members: &mut [Member<f64>],
    recorded: bool,
    each: &mut EachPeriod,
) -> Outcomes {
    let follow = |(k, member): (usize, &mut Member<f64>)| loop {
        let period = match recorded {
            true => Some(map.record(member)?),
            false => map.advance(member).map(|()| None)?,
        };
        if each(k, period, &member.state).is_break() {
            return Ok(());
        }
    };
    members.iter_mut().enumerate().map(follow).collect()
}

/// Advances several trajectories, each with a tangent vector, one by one.
pub(super) fn push_forward_each(
    map: &mut (impl StroboscopicMap + ?Sized),
    members: &mut [Member<Dual64>],
    each: &mut EachTangent,
) -> Outcomes {
    let follow = |(k, member): (usize, &mut Member<Dual64>)| loop {
        map.push_forward(member)?;
        if each(k, &mut member.state).is_break() {
            return Ok(());
        }
    };
    members.iter_mut().enumerate().map(follow).collect()
}
