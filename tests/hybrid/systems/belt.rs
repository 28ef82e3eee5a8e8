//! A mass of 1 on a spring of stiffness 1, on a belt of velocity `v`, with dry friction: `|friction| ≤ F_s`
//! while it moves with the belt, and `F_k` towards the belt's velocity while it does not.
//!
//! With `Δ = F_s − F_k` the mass leaves the belt at `x = F_s`, moves as `x = F_k + Δ cos t + v sin t`, and
//! has the belt's velocity again where `x − F_k` has the opposite sign, at `x = 2 F_k − F_s`, from which the
//! belt carries it back over `2Δ`.

use std::f64::consts::TAU;
use tangency::core::hybrid::{Guard, HybridSystem, Mode};
use tangency::core::scalar::Scalar;

/// Modes `stick`, `slower` and `faster` than the belt; parameters `static_friction`, `kinetic_friction`,
/// `belt`.
#[derive(Clone, Copy, Debug)]
pub struct Belt;

impl Belt {
    pub const STICK: usize = 0;
    pub const SLOWER: usize = 1;
    pub const FASTER: usize = 2;
    /// The spring pulls the mass off the belt backwards.
    pub const SLIP: usize = 0;
    /// The spring pushes the mass off the belt forwards.
    pub const OVERTAKE: usize = 1;
    /// The belt's velocity is reached from below.
    pub const CATCH: usize = 2;
}

impl HybridSystem for Belt {
    fn modes(&self) -> Vec<Mode> {
        let states = ["displacement", "velocity"];
        let stick = Mode::new("stick", ["displacement"]);
        vec![stick, Mode::new("slower", states), Mode::new("faster", states)]
    }
    fn guards(&self) -> Vec<Guard> {
        vec![
            Guard::new("slip", [Self::STICK]),
            Guard::new("overtake", [Self::STICK]),
            Guard::new("catch", [Self::SLOWER]),
            Guard::new("slow", [Self::FASTER]),
        ]
    }
    fn parameters(&self) -> Vec<String> {
        ["static_friction", "kinetic_friction", "belt"].map(String::from).into()
    }
    fn field<T: Scalar>(&self, mode: usize, _t: T, x: &[T], p: &[T], f: &mut [T]) {
        let [kinetic, belt] = [p[1], p[2]];
        if mode == Self::STICK {
            f[0] = belt;
            return;
        }
        f[0] = x[1];
        f[1] = if mode == Self::SLOWER { kinetic - x[0] } else { -kinetic - x[0] };
    }
    fn guard<T: Scalar>(&self, guard: usize, _mode: usize, _t: T, x: &[T], p: &[T]) -> T {
        let [friction, belt] = [p[0], p[2]];
        match guard {
            Self::SLIP => friction - x[0],
            Self::OVERTAKE => friction + x[0],
            Self::CATCH => belt - x[1],
            _ => x[1] - belt,
        }
    }
    fn reset<T: Scalar>(
        &self,
        _g: usize,
        (_, next): (usize, usize),
        _t: T,
        x: &[T],
        p: &[T],
        after: &mut [T],
    ) {
        after[0] = x[0];
        if next != Self::STICK {
            after[1] = p[2];
        }
    }
    fn next_mode(&self, guard: usize, _mode: usize, _t: f64, x: &[f64], p: &[f64]) -> usize {
        let sticks = x[0].abs() <= p[0];
        match guard {
            Self::SLIP => Self::SLOWER,
            Self::OVERTAKE => Self::FASTER,
            _ if sticks => Self::STICK,
            Self::CATCH => Self::FASTER,
            _ => Self::SLOWER,
        }
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
