//! The Prothero–Robinson equation, a test problem for stiff solvers.

use crate::core::problem::{Names, VectorField};
use crate::core::scalar::Scalar;

/// `x' = −λ(x − cos t) − sin t`, with the slow solution `x = cos t` for every rate λ (A. Prothero
/// and A. Robinson, *Math. Comp.* 28, 1974).
///
/// ```
/// use tangency::core::ode::{Flow, Scheme, Settings};
/// use tangency::problems::classic::ProtheroRobinson;
/// let mut flow = Flow::<f64>::new(Settings::new(Scheme::Rodas5P, 1e-10))?;
/// let mut x = [1.0];
/// flow.advance(&ProtheroRobinson, 0.0, 2.0, &mut x, &[1e6])?;
/// assert!((x[0] - 2.0_f64.cos()).abs() < 1e-8);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct ProtheroRobinson;

impl VectorField for ProtheroRobinson {
    fn names(&self) -> Names {
        Names::new(["x"], ["rate"])
    }

    fn field<T: Scalar>(&self, t: T, x: &[T], p: &[T], f: &mut [T]) {
        let (sin, cos) = t.sin_cos();
        f[0] = -p[0] * (x[0] - cos) - sin;
    }
}
