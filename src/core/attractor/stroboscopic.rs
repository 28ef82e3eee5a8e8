//! Stroboscopic maps from state to state.

use super::error::StroboscopicError;
use super::period::{Layout, Period};
use crate::core::hybrid::{HybridState, Member};
use num_dual::Dual64;
use std::ops::ControlFlow;

/// Called after a period of one of many trajectories, with its number, the period if recorded, and
/// the state at its end. The result determines whether the trajectory continues.
pub type EachPeriod<'a> =
    dyn FnMut(usize, Option<Period>, &HybridState<f64>) -> ControlFlow<()> + 'a;

/// Called after a period of one of many trajectories, with its number, state and tangent vector;
/// may scale the tangent vector. The result determines whether the trajectory continues.
pub type EachTangent<'a> = dyn FnMut(usize, &mut HybridState<Dual64>) -> ControlFlow<()> + 'a;

/// The outcome of each of many trajectories.
pub type Outcomes = Vec<Result<(), StroboscopicError>>;

/// A map from state to state: a motion sampled stroboscopically, once a forcing period, or a
/// discrete map.
///
/// States belong to a hybrid system, and their time is the time of the sample; a discrete map has
/// one mode, and its time is zero.
pub trait StroboscopicMap {
    /// The names of modes, events and measures.
    fn layout(&self) -> &Layout;

    /// Returns the initial state of a motion for a given state of a mode; by default the same
    /// state.
    fn initial(&self, state: HybridState<f64>, _p: &[f64]) -> HybridState<f64> {
        state
    }

    /// The scales of a mode's states, used to compare motions; empty if all are 1, the default.
    fn scales(&self, _mode: usize, _p: &[f64]) -> Vec<f64> {
        Vec::new()
    }

    /// Advances the motion by one period.
    ///
    /// # Errors
    /// [`StroboscopicError`] if the motion ends before, here and below.
    fn advance(&mut self, member: &mut Member<f64>) -> Result<(), StroboscopicError>;

    /// Advances the motion by one period and records it.
    fn record(&mut self, member: &mut Member<f64>) -> Result<Period, StroboscopicError>;

    /// Advances the motion by one period with a tangent vector, the derivatives of the state: `v ↦
    /// ∂F/∂x v`. Parameters have no derivatives.
    fn push_forward(&mut self, member: &mut Member<Dual64>) -> Result<(), StroboscopicError>;

    /// Whether motion rests in a recorded period, so that no search is needed. The steps of a
    /// tangent vector are then not limited, and its growth is unknown. False by default.
    fn rests(&self, _period: &Period) -> bool {
        false
    }

    /// Follows many trajectories period by period, each until `each` ends it. The result of a
    /// trajectory does not depend on the others, to the last bit. By default they are followed one
    /// by one.
    fn advance_all(
        &mut self,
        members: &mut [Member<f64>],
        recorded: bool,
        each: &mut EachPeriod,
    ) -> Outcomes {
        advance_each(self, members, recorded, each)
    }

    /// Follows many trajectories with a tangent vector each, as [`advance_all`](Self::advance_all).
    fn push_forward_all(
        &mut self,
        members: &mut [Member<Dual64>],
        each: &mut EachTangent,
    ) -> Outcomes {
        push_forward_each(self, members, each)
    }
}

/// Follows trajectories one by one.
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

/// Follows trajectories with a tangent vector each, one by one.
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
