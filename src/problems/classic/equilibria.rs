//! Test problems in one unknown, for Newton's iteration and for continuation steps.

use crate::core::failure::OutOfDomain;
use crate::zero_problem;

zero_problem! {
    /// `λ/(1 − u)² = u`, the parallel-plate actuator in its units of length and force; pull-in
    /// occurs at `u = 1/3`, `λ = 4/27`.
    ///
    /// ```
    /// use tangency::core::problem::ZeroProblem;
    /// use tangency::problems::classic::ParallelPlate;
    /// let mut r = [1.0_f64];
    /// ParallelPlate.residual(&[1.0 / 3.0], &[4.0 / 27.0], &mut r);
    /// assert!(r[0].abs() < 1e-15 && ParallelPlate.domain(&[1.0], &[0.0]).is_err());
    /// ```
    pub struct ParallelPlate [u; load] {
        0 = load / (T::one() - u).powi(2) - u;
        fn domain(&self, u: &[f64], _p: &[f64]) -> Result<(), OutOfDomain> {
            if u[0] < 1.0 {
                return Ok(());
            }
            Err(OutOfDomain::new("u", u[0], "the plate touches the electrode at u = 1"))
        }
    }
}

zero_problem! {
    /// `x² = μ² + ε²`: two branches whose distance at `μ = 0` is `2ε`; near `μ = 0`, each branch
    /// turns by a right angle, with the curvature `1/ε`. The two branches cross only for `ε = 0`;
    /// for other `ε` the point midway between them belongs to neither branch.
    ///
    /// ```
    /// use tangency::core::problem::ZeroProblem;
    /// use tangency::problems::classic::Hyperbola;
    /// let mut r = [1.0];
    /// Hyperbola.residual(&[5.0], &[3.0, 4.0], &mut r);
    /// assert_eq!(r, [0.0]);
    /// ```
    pub struct Hyperbola [x; mu, epsilon] {
        0 = x * x - mu * mu - epsilon * epsilon;
    }
}
