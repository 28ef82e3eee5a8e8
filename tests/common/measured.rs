//! Problems that tests solve and benchmarks time.

use tangency::core::problem::{Names, ZeroProblem};
use tangency::core::scalar::Scalar;
use tangency::zero_problem;

zero_problem! {
    /// CO oxidation (Bykov), `q₂` and `k` free.
    pub struct Oxidation [x, y, s; q2, k] {
        let z = T::one() - x - y - s;
        0 = z * z * 5.0 - x * x * 2.0 - x * y * 10.0;
        0 = q2 * z - y * 0.1 - x * y * 10.0;
        0 = (z - k * s) * 0.0675;
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
