//! Problems that tests solve and benchmarks time.

use tangency::core::problem::{Names, ZeroProblem};
use tangency::core::scalar::Scalar;

/// CO oxidation (Bykov), `q₂` and `k` free.
pub struct Oxidation;

impl ZeroProblem for Oxidation {
    fn names(&self) -> Names {
        Names::new(["x", "y", "s"], ["q2", "k"])
    }
    fn residual<T: Scalar>(&self, u: &[T], p: &[T], r: &mut [T]) {
        let (x, y, s, q2, k) = (u[0], u[1], u[2], p[0], p[1]);
        let z = T::one() - x - y - s;
        r[0] = z * z * 5.0 - x * x * 2.0 - x * y * 10.0;
        r[1] = q2 * z - y * 0.1 - x * y * 10.0;
        r[2] = (z - k * s) * 0.0675;
    }
}

/// Central differences of `u'' + λeᵘ = 0`, `u(0) = u(1) = 0`.
pub struct Bratu(pub usize);

impl ZeroProblem for Bratu {
    fn names(&self) -> Names {
        Names::new([("u", self.0)], ["lambda"]).with_monitors(["middle"])
    }
    fn residual<T: Scalar>(&self, u: &[T], p: &[T], r: &mut [T]) {
        let n = self.0;
        let inverse = ((n + 1) * (n + 1)) as f64;
        let at = |i: usize| if i == 0 || i > n { T::zero() } else { u[i - 1] };
        for i in 1..=n {
            r[i - 1] = (at(i - 1) - at(i) * 2.0 + at(i + 1)) * inverse + p[0] * at(i).exp();
        }
    }
    fn monitors<T: Scalar>(&self, u: &[T], _p: &[T], values: &mut [T]) {
        values[0] = u[self.0 / 2];
    }
}
