//! A smooth field and a zero problem.

use tangency::prelude::*;

/// The Brusselator: `x' = a − (b + 1) x + x² y`, `y' = b x − x² y`, with a Hopf point at
/// `b = 1 + a²`.
pub struct Brusselator;

impl VectorField for Brusselator {
    fn names(&self) -> Names {
        Names::new(["x", "y"], ["a", "b"])
    }
    fn defaults(&self) -> Vec<f64> {
        vec![1.0, 1.5]
    }
    fn field<T: Scalar>(&self, _t: T, x: &[T], p: &[T], f: &mut [T]) {
        let made = x[0] * x[0] * x[1];
        f[0] = p[0] - (p[1] + 1.0) * x[0] + made;
        f[1] = p[1] * x[0] - made;
    }
}

/// A rigid rod under a load, held upright by a spring: `load · sin u = u`, which buckles at
/// `load = 1`. It has no default values, so that scenes must give them.
pub struct Rod;

impl ZeroProblem for Rod {
    fn names(&self) -> Names {
        Names::new(["angle"], ["load"]).with_monitors(["tilt".to_string()])
    }
    fn residual<T: Scalar>(&self, u: &[T], p: &[T], r: &mut [T]) {
        r[0] = p[0] * u[0].sin() - u[0];
    }
    fn monitors<T: Scalar>(&self, u: &[T], _p: &[T], values: &mut [T]) {
        values[0] = u[0];
    }
}
