//! Maps from state to state.

use super::error::StroboscopicError;
use super::period::{Layout, Period};
use crate::core::hybrid::{HybridState, Member};
use num_dual::Dual64;
use std::ops::ControlFlow;

/// Sees a period of one of many trajectories: the trajectory's number, the period if periods are
/// recorded, and the state at its end. The trajectory goes on or ends.
pub type EachPeriod<'a> =
    dyn FnMut(usize, Option<Period>, &HybridState<f64>) -> ControlFlow<()> + 'a;

/// Sees the image of state and tangent vector after a period of one of many trajectories, by its
/// number; may scale the tangent vector. The trajectory goes on or ends.
pub type EachTangent<'a> = dyn FnMut(usize, &mut HybridState<Dual64>) -> ControlFlow<()> + 'a;

/// What becomes of each of many trajectories.
pub type Outcomes = Vec<Result<(), StroboscopicError>>;

/// A map from state to state: a motion sampled stroboscopically, once a forcing period, or a map in
/// itself.
///
/// States are those of a hybrid system, whose time is that of the sample: a map in itself has one
/// mode, and its time is zero.
pub trait StroboscopicMap {
    /// The names of modes, events and measures.
    fn layout(&self) -> &Layout;

    /// The state from which motion begins that is given as one of a mode: by default the same.
    fn initial(&self, state: HybridState<f64>, _p: &[f64]) -> HybridState<f64> {
        state
    }

    /// The scales of a mode's states, used to compare motions; empty if all are 1, the default.
    fn scales(&self, _mode: usize, _p: &[f64]) -> Vec<f64> {
        Vec::new()
    }

    /// Follows the motion for one period.
    ///
    /// # Errors
    /// [`StroboscopicError`] if the motion ends before, here and below.
    fn advance(&mut self, member: &mut Member<f64>) -> Result<(), StroboscopicError>;

    /// Follows the motion for one period and keeps what happens in it.
    fn record(&mut self, member: &mut Member<f64>) -> Result<Period, StroboscopicError>;

    /// Follows the motion for one period with a tangent vector, the derivatives of the state, which
    /// becomes its image: `v ↦ ∂F/∂x v`. Parameters have no derivatives.
    fn push_forward(&mut self, member: &mut Member<Dual64>) -> Result<(), StroboscopicError>;

    /// Whether motion rests in a recorded period: it stays what it is, and needs no search. Nothing
    /// limits the steps of a tangent vector then, so that its growth is not known. By default no.
    fn rests(&self, _period: &Period) -> bool {
        false
    }

    /// Follows many trajectories period by period, each until `each` ends it. What becomes of a
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
