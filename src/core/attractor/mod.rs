//! Attractors: what motions settle on, by brute force.
//!
//! A motion that is sampled once in every period is a map from state to state, `x ↦ F(x, p)`: the motion of a
//! hybrid system under a forcing ([`PeriodMap`]), or a map in itself. Both are a [`StroboscopicMap`].
//!
//! [`AttractorSearch`] follows it through a transient and records what comes then. Where motion comes back, `F^q(x) ≈ x`
//! with the same events, the periodic point is improved by Newton's method with the matrix
//!
//! ```text
//!     M = ∂F^q/∂x,
//! ```
//!
//! whose eigenvalues are the multipliers `μ`. The largest Lyapunov exponent, per period, is
//!
//! ```text
//!     λ = ln max|μ| / q    (periodic),        λ = lim 1/N Σ ln |v_{k+1}|/|v_k|,  v_{k+1} = ∂F/∂x v_k    (otherwise).
//! ```
//!
//! All derivatives are those of the motion itself on dual numbers: at events they are carried over as the
//! saltation matrix would.

mod crisis;
mod error;
mod exponent;
mod period;
mod period_map;
mod search;

pub use crisis::{Crisis, CrisisSearch};
pub use error::StroboscopicError;
pub use exponent::Exponent;
pub use period::{EventRecord, Period};
pub use period_map::PeriodMap;
pub use search::{Attractor, AttractorSearch};

use crate::core::hybrid::{HybridState, Member, Mode};
use num_dual::Dual64;
use std::ops::ControlFlow;

/// What is seen of a motion, by name.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Layout {
    /// The modes with the names of their states.
    pub modes: Vec<Mode>,
    /// The names of all events, by their numbers.
    pub events: Vec<String>,
    /// The names of what is measured in a period.
    pub measures: Vec<String>,
}

/// Sees a period of one of many trajectories: the trajectory's number, the period if periods are recorded, and the
/// state at its end. The trajectory goes on or ends.
pub type EachPeriod<'a> =
    dyn FnMut(usize, Option<Period>, &HybridState<f64>) -> ControlFlow<()> + 'a;

/// Sees the image of state and tangent vector after a period of one of many trajectories, by its number; may scale
/// the tangent vector. The trajectory goes on or ends.
pub type EachTangent<'a> = dyn FnMut(usize, &mut HybridState<Dual64>) -> ControlFlow<()> + 'a;

/// What becomes of each of many trajectories.
pub type Outcomes = Vec<Result<(), StroboscopicError>>;

/// A map from state to state: a motion sampled stroboscopically, once a forcing period, or a map in itself.
///
/// States are those of a hybrid system, whose time is that of the sample: a map in itself has one mode, and its time
/// is zero.
pub trait StroboscopicMap {
    /// The names of modes, events and measures.
    fn layout(&self) -> &Layout;

    /// Follows the motion for one period.
    ///
    /// # Errors
    /// [`StroboscopicError`] if the motion ends before.
    fn advance(&mut self, state: &mut HybridState<f64>, p: &[f64])
    -> Result<(), StroboscopicError>;

    /// Follows the motion for one period and keeps what happens in it.
    ///
    /// # Errors
    /// As [`advance`](Self::advance).
    fn record(
        &mut self,
        state: &mut HybridState<f64>,
        p: &[f64],
    ) -> Result<Period, StroboscopicError>;

    /// Follows the motion for one period with a tangent vector, the derivatives of the state, which becomes its
    /// image: `v ↦ ∂F/∂x v`.
    ///
    /// # Errors
    /// As [`advance`](Self::advance).
    fn push_forward(
        &mut self,
        state: &mut HybridState<Dual64>,
        p: &[f64],
    ) -> Result<(), StroboscopicError>;

    /// Follows many trajectories period by period, each until `each` ends it. What becomes of a trajectory does not
    /// depend on the others, to the last bit. By default they are followed one by one.
    fn advance_all(
        &mut self,
        members: &mut [Member<f64>],
        recorded: bool,
        each: &mut EachPeriod,
    ) -> Outcomes {
        let follow = |(k, Member { state, p }): (usize, &mut Member<f64>)| loop {
            let period = match recorded {
                true => Some(self.record(state, p)?),
                false => self.advance(state, p).map(|()| None)?,
            };
            if each(k, period, state).is_break() {
                return Ok(());
            }
        };
        members.iter_mut().enumerate().map(follow).collect()
    }

    /// Follows many trajectories with a tangent vector each, as [`advance_all`](Self::advance_all). Parameters have
    /// no derivatives.
    fn push_forward_all(
        &mut self,
        members: &mut [Member<Dual64>],
        each: &mut EachTangent,
    ) -> Outcomes {
        let follow = |(k, Member { state, p }): (usize, &mut Member<Dual64>)| {
            let p: Vec<f64> = p.iter().map(|p| p.re).collect();
            loop {
                self.push_forward(state, &p)?;
                if each(k, state).is_break() {
                    return Ok(());
                }
            }
        };
        members.iter_mut().enumerate().map(follow).collect()
    }
}
