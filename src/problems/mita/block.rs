//! The block of Mita's actuator on its spring, with the frame at rest.

use crate::core::failure::OutOfDomain;
use crate::core::problem::{Forcing, Names, VectorField};
use crate::core::scalar::Scalar;
use std::f64::consts::PI;

/// The block within a frame at rest, without impacts. Its displacement `q₂` and velocity `u₂`
/// satisfy equations 4.1 and 4.2 of Zhao's dissertation for `u₁ = 0`:
///
/// ```text
///     q₂' = u₂,    u₂' = V² sin²ωt/(1 − q₂)² − q₂ − c u₂
/// ```
///
/// The forcing of the block has the period `π/ω` because the force is proportional to the square of
/// the voltage. The field is singular at `q₂ = 1`, where the block touches the electrode; the front
/// stopper at 0.5 is not part of this field.
///
/// The states are `displacement` and `velocity`; the parameters are `voltage`, `frequency` and
/// `damping`.
///
/// ```
/// use tangency::core::problem::VectorField;
/// use tangency::problems::mita::Block;
/// let mut f = [0.0; 2];
/// // At t = π/2ω the voltage is V = 0.2.
/// Block.field(std::f64::consts::PI, &[0.5, 1.0], &[0.2, 0.5, 0.04], &mut f);
/// assert!((f[1] - (0.2_f64.powi(2) / 0.25 - 0.5 - 0.04)).abs() < 1e-15);
/// assert!(Block.domain(&[1.0, 0.0], &[0.2, 0.5, 0.04]).is_err());
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Block;

impl Block {
    /// The default values of the block's parameters.
    pub const DEFAULTS: [f64; 3] = [0.01, 0.45, 0.04];
}

/// Returns the force `R = V² sin²ωt/(1 − q₂)² − q₂ − c u₂` between block and frame, for a voltage,
/// a frequency and a damping.
#[inline(always)]
pub(super) fn force<T: Scalar>(t: T, q: T, u: T, [voltage, frequency, damping]: [&T; 3]) -> T {
    let ratio = (*frequency * t).sin() * voltage / (T::one() - q);
    ratio * ratio - q - u * damping
}

impl VectorField for Block {
    fn names(&self) -> Names {
        Names::new(["displacement", "velocity"], ["voltage", "frequency", "damping"])
    }

    fn defaults(&self) -> Vec<f64> {
        Self::DEFAULTS.into()
    }

    fn field<T: Scalar>(&self, t: T, x: &[T], p: &[T], f: &mut [T]) {
        f[0] = x[1];
        f[1] = force(t, x[0], x[1], [&p[0], &p[1], &p[2]]);
    }

    fn forcing(&self) -> Forcing {
        Forcing::Periodic { phase: PI }
    }

    fn period<T: Scalar>(&self, p: &[T]) -> T {
        p[1].recip() * PI
    }

    fn domain(&self, x: &[f64], p: &[f64]) -> Result<(), OutOfDomain> {
        if x[0] >= 1.0 {
            let remedy = "the block touches the electrode at 1: bound `max_displacement` below it";
            return Err(OutOfDomain::new("displacement", x[0], remedy));
        }
        if p[1] <= 0.0 {
            return Err(OutOfDomain::new("frequency", p[1], "the frequency must be positive"));
        }
        Ok(())
    }
}
