//! Scalars that are watched along a trajectory for extrema and zeros.
//!
//! The extrema and zeros of a scalar `h(t, x(t), p)` give, for example, the largest value of a
//! state, the smallest distance of a motion from a surface, and the points at which the motion
//! reaches the surface. Derivatives of `h` along the motion come from dual numbers.

use crate::core::scalar::Scalar;
use num_dual::{Dual, Dual2, Dual2_64, Dual64};

/// A scalar `h(t, x, p)` along a trajectory, written once for all scalar types; derivatives come
/// from automatic differentiation.
///
/// ```
/// use tangency::core::scalar::Scalar;
/// use tangency::core::problem::{State, Watch};
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
    /// Computes the value of `h(t, x, p)`.
    fn value<T: Scalar>(&self, t: T, x: &[T], p: &[T]) -> T;

    /// Returns the size of a typical change of `h`, which is the unit of tolerances; not needed if
    /// `h` is a state, because the integrator then supplies the size.
    fn scale(&self) -> f64 {
        1.0
    }

    /// Returns the index of the state if `h` is a state; the derivatives of a state are known
    /// without an evaluation of `h`.
    fn state(&self) -> Option<usize> {
        None
    }
}

/// The negative `−h` of a watched scalar, which falls when the scalar rises.
pub(in crate::core) struct Opposite<'w, W>(pub &'w W);

impl<T: Scalar, W: WatchIn<T>> WatchIn<T> for Opposite<'_, W> {
    fn value_in(&self, t: T, x: &[T], p: &[T]) -> T {
        -self.0.value_in(t, x, p)
    }
}

impl<W: Watchable<f64>> Watchable<f64> for Opposite<'_, W> {
    fn size(&self) -> f64 {
        self.0.size()
    }
}

/// A scalar along a trajectory, given by its index: a state or a function.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Observable {
    /// A state.
    State(usize),
    /// A function of time, states and parameters, given by its index among the functions that the
    /// problem defines.
    Function(usize),
}

impl Observable {
    /// Returns the index of the state if the scalar is a state; `None` otherwise.
    pub fn state(self) -> Option<usize> {
        match self {
            Observable::State(i) => Some(i),
            Observable::Function(_) => None,
        }
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

/// A watched scalar in one scalar type. Every [`Watch`] implements this trait.
pub trait WatchIn<T> {
    /// Computes the value of `h(t, x, p)`.
    fn value_in(&self, t: T, x: &[T], p: &[T]) -> T;
}

impl<W: Watch, T: Scalar> WatchIn<T> for W {
    fn value_in(&self, t: T, x: &[T], p: &[T]) -> T {
        self.value(t, x, p)
    }
}

/// A watched scalar in the form in which an integrator with numbers `T` evaluates it, with slopes and
/// curvatures along the flow.
pub trait Watchable<T: Scalar>:
    WatchIn<f64> + WatchIn<Dual64> + WatchIn<Dual2_64> + WatchIn<Dual<T>> + WatchIn<Dual2<T>>
{
    /// Returns the size of a typical change of the scalar, if the scalar is not a state.
    fn size(&self) -> f64;

    /// Returns the index of the watched state if the scalar is a state.
    fn state_index(&self) -> Option<usize> {
        None
    }
}

impl<W: Watch, T: Scalar> Watchable<T> for W {
    fn size(&self) -> f64 {
        self.scale()
    }

    fn state_index(&self) -> Option<usize> {
        self.state()
    }
}

/// Returns the change of a function at a point if time and all states change by their scales;
/// returns 1 if this change is zero or not finite.
pub(in crate::core) fn change_by(
    (time, states): (f64, &[f64]),
    place: (f64, &[f64]),
    p: &[f64],
    value: impl Fn(Dual64, &[Dual64], &[Dual64]) -> Dual64,
) -> f64 {
    let (by_states, by_time) = gradient(place, p, value);
    let changes = by_states.iter().zip(states).map(|(slope, size)| size * slope.abs());
    let scale = changes.fold(time * by_time.abs(), |sum, change| sum + change);
    if scale.is_finite() && scale > 0.0 { scale } else { 1.0 }
}

/// Returns the derivatives of a function of time, states and parameters, with respect to the states
/// and with respect to time.
pub(in crate::core) fn gradient(
    (t, x): (f64, &[f64]),
    p: &[f64],
    value: impl Fn(Dual64, &[Dual64], &[Dual64]) -> Dual64,
) -> (Vec<f64>, f64) {
    let [mut x, p] = [x, p].map(|v| v.iter().map(|v| Dual64::from(*v)).collect::<Vec<_>>());
    let mut by_states = vec![0.0; x.len()];
    for (i, slope) in by_states.iter_mut().enumerate() {
        x[i].eps = 1.0;
        *slope = value(t.into(), &x, &p).eps;
        x[i].eps = 0.0;
    }
    (by_states, value(Dual64::new(t, 1.0), &x, &p).eps)
}
