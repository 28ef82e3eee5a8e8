//! Flows in the plane whose bifurcations are known exactly.

use tangency::core::problem::{Dynamics, Names, VectorField, ZeroProblem};
use tangency::core::scalar::Scalar;

/// `x' = a − (b + 1) x + x² y`, `y' = b x − x² y`: a Hopf point at `b = 1 + a²`, of frequency `a`.
pub struct Brusselator;

impl VectorField for Brusselator {
    fn names(&self) -> Names {
        Names::new(["x", "y"], ["a", "b"])
    }
    fn field<T: Scalar>(&self, _t: T, x: &[T], p: &[T], f: &mut [T]) {
        let reaction = x[0] * x[0] * x[1];
        f[0] = p[0] - (p[1] + 1.0) * x[0] + reaction;
        f[1] = p[1] * x[0] - reaction;
    }
}

/// `x' = y, y' = a + b y + x² + x y`: equilibria `x = ±√−a`, of which those with `x > 0` are
/// saddles. The trace of `F_z` is `b + x`.
pub struct BogdanovTakens;

impl ZeroProblem for BogdanovTakens {
    fn names(&self) -> Names {
        Names::new(["x", "y"], ["a", "b"])
    }
    fn dynamics(&self) -> Dynamics {
        Dynamics::Flow
    }
    fn residual<T: Scalar>(&self, u: &[T], p: &[T], r: &mut [T]) {
        r[0] = u[1];
        r[1] = p[0] + p[1] * u[1] + u[0] * u[0] + u[0] * u[1];
    }
}
