//! Filippov systems: two fields, a switching surface between them, and sliding on it.

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

/// The names of modes and of the event on the surface. An event that ends sliding has the name of the
/// next mode.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FilippovNames {
    /// Motion above the surface.
    pub above: String,
    /// Motion below the surface.
    pub below: String,
    /// Motion on the surface.
    pub sliding: String,
    /// The event at which motion reaches the surface.
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
    /// The names `above`, `below`, `sliding` and `surface`.
    fn default() -> Self {
        FilippovNames::new("above", "below", "sliding", "surface")
    }
}

/// A Filippov system: a field on each side of a surface `h(t, x, p) = 0`, and sliding on the
/// surface where both fields point towards it. [`Filippov`] converts it to a hybrid system: the
/// normal velocities `L_f h = h_t + h_x f` of the two fields, computed by automatic
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
    /// The names of the states, shared by all modes.
    fn states(&self) -> Vec<String>;

    /// The names of the parameters.
    fn parameters(&self) -> Vec<String>;

    /// The default values of all parameters, in order; empty without default values.
    fn defaults(&self) -> Vec<f64> {
        Vec::new()
    }

    /// The names of modes and events.
    fn names(&self) -> FilippovNames {
        FilippovNames::default()
    }

    /// The switching surface: a function that vanishes on it, positive above and negative below.
    /// Its gradient must not vanish there.
    fn surface<T: Scalar>(&self, t: T, x: &[T], p: &[T]) -> T;

    /// Computes the field on a side, also used on the surface, into `f` (of the same length as
    /// `x`).
    fn field<T: Scalar>(&self, side: Side, t: T, x: &[T], p: &[T], f: &mut [T]);

    /// Computes the field of sliding motion and writes it into `f`: by default Filippov's
    /// [`convex_combination`] of the two fields. A different field must keep motion on the surface:
    /// its normal velocity `h_t + h_x f` must vanish there, which is checked at the start and end
    /// of sliding.
    fn sliding<T: Scalar>(&self, t: T, x: &[T], p: &[T], f: &mut [T]) {
        convex_combination(self, t, x, p, f);
    }

    /// A function that is positive while sliding cannot leave to a side: by default the speed at
    /// which the field of that side approaches the surface ([`held_by_field`]). Sliding ends at its
    /// zero; a motion that reaches the surface from the other side crosses if the function is
    /// negative. Static friction larger than kinetic friction prolongs sliding.
    fn holds<T: Scalar>(&self, side: Side, t: T, x: &[T], p: &[T]) -> T {
        held_by_field(self, side, t, x, p)
    }

    /// The forcing; by default none.
    fn forcing(&self) -> Forcing {
        Forcing::None
    }

    /// The period of a periodic [`forcing`](Self::forcing); for an autonomous system, the unit of
    /// time in scenes.
    fn period<T: Scalar>(&self, _p: &[T]) -> T {
        T::one()
    }

    /// Typical sizes of times and states; needed if they are far from 1.
    fn scales(&self, _p: &[f64]) -> Scales {
        Scales::default()
    }

    /// The names of monitors.
    fn monitors(&self) -> Vec<String> {
        Vec::new()
    }

    /// Computes a monitor, by its position among [`monitors`](Self::monitors).
    fn monitor<T: Scalar>(&self, _monitor: usize, _t: T, _x: &[T], _p: &[T]) -> T {
        T::from(f64::NAN)
    }

    /// The measures that are recorded for orbits: by default the extremes of every state, and the
    /// mean and extremes of every monitor.
    fn measures(&self) -> Vec<(String, Measure)> {
        Measure::by_default(self.states(), self.monitors())
    }

    /// Rejects states outside the domain of the fields.
    fn domain(&self, _x: &[f64], _p: &[f64]) -> Result<(), OutOfDomain> {
        Ok(())
    }
}
