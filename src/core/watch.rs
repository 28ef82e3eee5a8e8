//! Scalars watched along a trajectory.
//!
//! Extrema and zeros of a scalar `h(t, x(t), p)` tell where a state is largest, how near a motion comes to a
//! surface, and where it meets it. Derivatives of `h` along the motion come from dual numbers.

use super::scalar::Scalar;

/// A scalar `h(t, x, p)` of a trajectory, stated once, differentiated nowhere.
///
/// ```
/// use tangency::core::scalar::Scalar;
/// use tangency::core::watch::{State, Watch};
/// /// The distance of a pendulum's bob, of angle `x₀`, to the ceiling.
/// struct Clearance;
/// impl Watch for Clearance {
///     fn value<T: Scalar>(&self, _t: T, x: &[T], p: &[T]) -> T {
///         p[0] * x[0].cos()
///     }
/// }
/// assert_eq!(Clearance.value(0.0, &[0.0, 1.0], &[2.0]), 2.0);
/// assert_eq!(State(1).value(0.0, &[0.0, 1.0], &[2.0]), 1.0);
/// ```
pub trait Watch {
    /// `h(t, x, p)`.
    fn value<T: Scalar>(&self, t: T, x: &[T], p: &[T]) -> T;

    /// The state that is watched, if it is nothing else: its slopes are known without any evaluation.
    fn state(&self) -> Option<usize> {
        None
    }
}

/// One state.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct State(pub usize);

impl Watch for State {
    fn value<T: Scalar>(&self, _t: T, x: &[T], _p: &[T]) -> T {
        x[self.0]
    }

    fn state(&self) -> Option<usize> {
        Some(self.0)
    }
}
