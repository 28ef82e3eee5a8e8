//! Filippov systems: two vector fields, separated by a switching surface, and sliding motion on the
//! surface.

mod modes;
mod normal;

pub use modes::Filippov;
pub use normal::{convex_combination, held_by_field};

use super::system::Scales;
use crate::core::failure::OutOfDomain;
use crate::core::problem::{Forcing, Measure};
use crate::core::scalar::Scalar;

/// A side of the switching surface `h = 0`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// `h > 0`.
    Above,
    /// `h < 0`.
    Below,
}

impl Side {
    /// The opposite side.
    pub fn other(self) -> Self {
        match self {
            Side::Above => Side::Below,
            Side::Below => Side::Above,
        }
    }
}

/// The names of the modes and of the event at the switching surface. An event that ends sliding is
/// named after the next mode.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FilippovNames {
    /// The name of the mode above the surface.
    pub above: String,
    /// The name of the mode below the surface.
    pub below: String,
    /// The name of the mode of sliding on the surface.
    pub sliding: String,
    /// The name of the event at which motion reaches the surface.
    pub surface: String,
}

impl FilippovNames {
    /// Creates names of the modes `above`, `below` and `sliding`, and of the event on the surface.
    pub fn new(above: &str, below: &str, sliding: &str, surface: &str) -> Self {
        let [above, below, sliding, surface] = [above, below, sliding, surface].map(String::from);
        FilippovNames { above, below, sliding, surface }
    }
}

impl Default for FilippovNames {
    /// Returns the default names `above`, `below`, `sliding` and `surface`.
    fn default() -> Self {
        FilippovNames::new("above", "below", "sliding", "surface")
    }
}

/// A Filippov system: a vector field on each side of a surface `h(t, x, p) = 0`, and sliding on the
/// surface where both fields point towards it. [`Filippov`] converts the system to a hybrid system,
/// in which the normal velocities `L_f h = h_t + h_x f` of the two fields, computed by automatic
/// differentiation, determine sliding, crossing and the end of sliding.
///
/// ```
/// use tangency::core::hybrid::HybridSystem;
/// use tangency::core::hybrid::filippov::{Filippov, FilippovSystem, Side};
/// use tangency::core::scalar::Scalar;
/// /// A mass on a belt of velocity 1, `x'' + x = −F sgn(x' − 1)`.
/// struct Belt;
/// impl FilippovSystem for Belt {
///     fn states(&self) -> Vec<String> {
///         vec!["x".into(), "v".into()]
///     }
///     fn parameters(&self) -> Vec<String> {
///         vec!["F".into()]
///     }
///     fn surface<T: Scalar>(&self, _t: T, x: &[T], _p: &[T]) -> T {
///         x[1] - 1.0
///     }
///     fn field<T: Scalar>(&self, side: Side, _t: T, x: &[T], p: &[T], f: &mut [T]) {
///         (f[0], f[1]) = (x[1], -x[0] + if side == Side::Above { -p[0] } else { p[0] });
///     }
/// }
/// // The mass sticks to the belt as long as the spring force is smaller than the friction.
/// let mut f = [0.0; 2];
/// HybridSystem::field(&Filippov(Belt), Filippov::<Belt>::SLIDING, 0.0, &[0.3, 1.0], &[0.5], &mut f);
/// assert_eq!(f, [1.0, 0.0]);
/// let next = |x: f64| Filippov(Belt).next_mode(0, Filippov::<Belt>::BELOW, 0.0, &[x, 1.0], &[0.5]);
/// assert_eq!((next(0.3), next(-0.7)), (Filippov::<Belt>::SLIDING, Filippov::<Belt>::ABOVE));
/// ```
pub trait FilippovSystem: Send + Sync {
    /// Returns the names of the states, which are the same in all modes.
    fn states(&self) -> Vec<String>;

    /// The names of the parameters.
    fn parameters(&self) -> Vec<String>;

    /// Returns the default values of all parameters, in order; an empty list if the system has no
    /// default values.
    fn defaults(&self) -> Vec<f64> {
        Vec::new()
    }

    /// Returns the names of the modes and of the event at the surface.
    fn names(&self) -> FilippovNames {
        FilippovNames::default()
    }

    /// Computes the function that defines the switching surface: zero on the surface, positive
    /// above it and negative below it. The gradient of this function must not vanish on the
    /// surface.
    fn surface<T: Scalar>(&self, t: T, x: &[T], p: &[T]) -> T;

    /// Computes the vector field on a side of the surface, including the surface itself, into `f`,
    /// which has the same length as `x`.
    fn field<T: Scalar>(&self, side: Side, t: T, x: &[T], p: &[T], f: &mut [T]);

    /// Computes the field of sliding motion and writes it into `f`; the default is Filippov's
    /// [`convex_combination`] of the two fields. An overriding field must be tangent to the
    /// surface: its normal velocity `h_t + h_x f` must vanish on the surface, which is checked at
    /// the start and end of sliding.
    fn sliding<T: Scalar>(&self, t: T, x: &[T], p: &[T], f: &mut [T]) {
        convex_combination(self, t, x, p, f);
    }

    /// Computes a function that is positive while sliding motion cannot leave the surface to the
    /// given side; the default is the speed at which the field of that side approaches the surface
    /// ([`held_by_field`]). Sliding ends at a zero of this function; a motion that reaches the
    /// surface from the other side crosses it if the function is negative. An overriding function
    /// can model static friction larger than kinetic friction, which prolongs sliding.
    fn holds<T: Scalar>(&self, side: Side, t: T, x: &[T], p: &[T]) -> T {
        held_by_field(self, side, t, x, p)
    }

    /// Returns the kind of forcing; none by default.
    fn forcing(&self) -> Forcing {
        Forcing::None
    }

    /// Returns the period of a periodic [`forcing`](Self::forcing); in an autonomous system, the
    /// unit of time in scene files.
    fn period<T: Scalar>(&self, _p: &[T]) -> T {
        T::one()
    }

    /// Returns the typical sizes of times and states, which must be given if they are far from 1.
    fn scales(&self, _p: &[f64]) -> Scales {
        Scales::default()
    }

    /// Returns the names of the monitors.
    fn monitors(&self) -> Vec<String> {
        Vec::new()
    }

    /// Computes the value of a monitor, given its index in [`monitors`](Self::monitors).
    fn monitor<T: Scalar>(&self, _monitor: usize, _t: T, _x: &[T], _p: &[T]) -> T {
        T::from(f64::NAN)
    }

    /// Returns the measures that are recorded for orbits; the default is the extremes of every
    /// state, and the mean and extremes of every monitor.
    fn measures(&self) -> Vec<(String, Measure)> {
        Measure::by_default(self.states(), self.monitors())
    }

    /// Returns an error for states outside the domain of the fields.
    fn domain(&self, _x: &[f64], _p: &[f64]) -> Result<(), OutOfDomain> {
        Ok(())
    }
}
