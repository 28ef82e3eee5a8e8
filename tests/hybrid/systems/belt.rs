//! A mass of 1 on a spring of stiffness 1, on a belt of velocity `v`, with dry friction:
//! `|friction| ≤ F_s` while it moves with the belt, and `F_k` towards the belt's velocity while it
//! does not.
//!
//! With `Δ = F_s − F_k` the mass leaves the belt at `x = F_s`, moves as
//! `x = F_k + Δ cos t + v sin t`, and has the belt's velocity again where `x − F_k` has the
//! opposite sign, at `x = 2 F_k − F_s`, from which the belt carries it back over `2Δ`.

use std::f64::consts::TAU;
use tangency::core::hybrid::filippov::{Filippov, FilippovNames, FilippovSystem, Side};
use tangency::core::scalar::Scalar;

/// Modes `faster` than the belt, `slower`, and `stick`; parameters `static_friction`,
/// `kinetic_friction`, `belt`.
#[derive(Clone, Copy, Debug)]
pub struct Belt;

impl Belt {
    pub const SLOWER: usize = Filippov::<Belt>::BELOW;
    pub const STICK: usize = Filippov::<Belt>::SLIDING;
    /// The belt's velocity is reached.
    pub const CATCH: usize = 0;
    /// The spring pulls the mass off the belt backwards.
    pub const SLIP: usize = 2;
}

impl FilippovSystem for Belt {
    fn states(&self) -> Vec<String> {
        ["displacement", "velocity"].map(String::from).into()
    }
    fn parameters(&self) -> Vec<String> {
        ["static_friction", "kinetic_friction", "belt"].map(String::from).into()
    }
    fn names(&self) -> FilippovNames {
        FilippovNames::new("faster", "slower", "stick", "belt")
    }
    fn surface<T: Scalar>(&self, _t: T, x: &[T], p: &[T]) -> T {
        x[1] - p[2]
    }
    fn field<T: Scalar>(&self, side: Side, _t: T, x: &[T], p: &[T], f: &mut [T]) {
        let friction = if side == Side::Above { -p[1] } else { p[1] };
        (f[0], f[1]) = (x[1], friction - x[0]);
    }
    /// By static friction.
    fn holds<T: Scalar>(&self, side: Side, _t: T, x: &[T], p: &[T]) -> T {
        if side == Side::Above { p[0] + x[0] } else { p[0] - x[0] }
    }
}

/// The period of the orbit that sticks once and slips once.
pub fn period(friction: f64, kinetic: f64, belt: f64) -> f64 {
    let delta = friction - kinetic;
    TAU - 2.0 * (delta / belt).atan() + 2.0 * delta / belt
}

/// Its largest displacement.
pub fn largest(friction: f64, kinetic: f64, belt: f64) -> f64 {
    kinetic + (friction - kinetic).hypot(belt)
}

/// The displacement at which the mass sticks again.
pub fn stick(friction: f64, kinetic: f64) -> f64 {
    2.0 * kinetic - friction
}
