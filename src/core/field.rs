//! Vector fields: `x' = f(t, x, p)`, stated once, differentiated nowhere.

use super::scalar::Scalar;
use super::zero::{LeftDomain, Names};

/// A vector field `f(t, x, p)` with named states and parameters: autonomous, or forced with a period.
///
/// ```
/// use tangency::core::{field::VectorField, scalar::Scalar, zero::Names};
/// /// A linear oscillator under a force of frequency ω: `x'' + c x' + x = cos ωt`.
/// struct Oscillator;
/// impl VectorField for Oscillator {
///     fn names(&self) -> Names {
///         Names::new(["x", "v"], ["frequency", "damping"])
///     }
///     fn field<T: Scalar>(&self, t: T, x: &[T], p: &[T], f: &mut [T]) {
///         f[0] = x[1];
///         f[1] = (p[0] * t).cos() - x[0] - p[1] * x[1];
///     }
///     fn period<T: Scalar>(&self, p: &[T]) -> Option<T> {
///         Some(p[0].recip() * std::f64::consts::TAU)
///     }
/// }
/// let mut f = [0.0; 2];
/// Oscillator.field(0.0, &[0.5, 2.0], &[1.0, 0.1], &mut f);
/// assert_eq!(f, [2.0, 1.0 - 0.5 - 0.2]);
/// ```
pub trait VectorField {
    /// The names of the states and of the parameters; their number is the field's size.
    fn names(&self) -> Names;

    /// The field `f(t, x, p)`, written into `f` (as long as `x`).
    fn field<T: Scalar>(&self, t: T, x: &[T], p: &[T], f: &mut [T]);

    /// The period of the forcing; `None` if the field is autonomous.
    fn period<T: Scalar>(&self, _p: &[T]) -> Option<T> {
        None
    }

    /// Refuses states at which the field has no meaning.
    ///
    /// # Errors
    /// [`LeftDomain`] with the quantity, its value and the domain.
    fn domain(&self, _x: &[f64], _p: &[f64]) -> Result<(), LeftDomain> {
        Ok(())
    }
}
