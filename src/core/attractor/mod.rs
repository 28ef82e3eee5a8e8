//! Attractors: what motions settle on, by brute force.
//!
//! A motion that is looked at once in every period is a map from state to state, `x ↦ F(x, p)`: the motion of a
//! hybrid system under a forcing ([`Stroboscope`]), or a map in itself. Anything of this kind is [`Strobed`].
//!
//! [`Settling`] follows it through a transient and looks at what comes then. Where motion comes back, `F^q(x) ≈ x`
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
mod settling;
mod stroboscope;

pub use crisis::{Crisis, CrisisSearch};
pub use error::StrobeError;
pub use exponent::Exponent;
pub use period::{Happening, Period};
pub use settling::{Settled, Settling};
pub use stroboscope::Stroboscope;

use crate::core::hybrid::{HybridState, Mode};

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

/// A motion that is looked at once in every period.
///
/// States are those of a hybrid system, whose time is that of the look: a map in itself has one mode, and its time
/// is zero.
pub trait Strobed {
    /// What is seen of it, by name.
    fn layout(&self) -> &Layout;

    /// Follows the motion for one period.
    ///
    /// # Errors
    /// [`StrobeError`] if the motion ends before.
    fn advance(&mut self, state: &mut HybridState<f64>, p: &[f64]) -> Result<(), StrobeError>;

    /// Follows the motion for one period and keeps what happens in it.
    ///
    /// # Errors
    /// As [`advance`](Self::advance).
    fn record(&mut self, state: &mut HybridState<f64>, p: &[f64]) -> Result<Period, StrobeError>;

    /// Follows the motion for one period with a tangent vector, which becomes its image: `v ↦ ∂F/∂x v`.
    ///
    /// # Errors
    /// As [`advance`](Self::advance).
    fn push_forward(
        &mut self,
        state: &mut HybridState<f64>,
        tangent: &mut Vec<f64>,
        p: &[f64],
    ) -> Result<(), StrobeError>;
}
