//! A ball on a table that moves as `Γ sin t`, in units of time `1/ω` and of length `g/ω²`:
//! `y'' = −1`.
//!
//! A ball that leaves the table at `t` with the velocity `v` over the ground reaches it again after
//! `τ`, and is thrown back by the part `e` of its speed over the table. With one impact in `n`
//! periods, `τ = 2πn` and `v = πn`, impacts come at the phase with `Γ cos t = πn (1 − e)/(1 + e)`.
//! There the map from `(t, v)` to the next has the derivative
//! `[[1, 1 + e], [−(1 + e) S, e² − (1 + e)² S]]` with `S = Γ sin t`.

use std::f64::consts::{PI, TAU};
use tangency::core::hybrid::{Guard, HybridSystem, Mode};
use tangency::core::problem::Forcing;
use tangency::core::scalar::Scalar;

/// Modes `flight` and `contact`, in which the ball moves with the table; parameters `acceleration`
/// Γ and `restitution` e. Without restitution it is in contact at once where the table presses.
#[derive(Clone, Copy, Debug)]
pub struct BouncingBall;

impl BouncingBall {
    pub const FLIGHT: usize = 0;
    pub const CONTACT: usize = 1;
    pub const IMPACT: usize = 0;
    pub const LEAVE: usize = 1;
}

impl HybridSystem for BouncingBall {
    fn modes(&self) -> Vec<Mode> {
        vec![Mode::new("flight", ["height", "velocity"]), Mode::new("contact", ["height"])]
    }
    fn guards(&self) -> Vec<Guard> {
        vec![
            Guard::new("impact", [Self::FLIGHT]).accumulating_to(Self::CONTACT),
            Guard::new("leave", [Self::CONTACT]),
        ]
    }
    fn parameters(&self) -> Vec<String> {
        vec!["acceleration".into(), "restitution".into()]
    }
    fn field<T: Scalar>(&self, mode: usize, t: T, x: &[T], p: &[T], f: &mut [T]) {
        if mode == Self::FLIGHT {
            f[0] = x[1];
            f[1] = -T::one();
        } else {
            f[0] = p[0] * t.cos();
        }
    }
    fn guard<T: Scalar>(&self, guard: usize, _mode: usize, t: T, x: &[T], p: &[T]) -> T {
        let table = p[0] * t.sin();
        // The table pushes by its acceleration −Γ sin t and the weight.
        if guard == Self::IMPACT { x[0] - table } else { T::one() - table }
    }
    fn reset<T: Scalar>(
        &self,
        guard: usize,
        (_, next): (usize, usize),
        t: T,
        x: &[T],
        p: &[T],
        after: &mut [T],
    ) {
        let table = p[0] * t.cos();
        after[0] = x[0];
        if next == Self::FLIGHT {
            after[1] = if guard == Self::IMPACT { table - p[1] * (x[1] - table) } else { table };
        }
    }
    fn next_mode(&self, guard: usize, _mode: usize, t: f64, _x: &[f64], p: &[f64]) -> usize {
        let sticks = guard == Self::IMPACT && p[1] == 0.0 && p[0] * t.sin() < 1.0;
        if sticks { Self::CONTACT } else { Self::FLIGHT }
    }
    fn forcing(&self) -> Forcing {
        Forcing::Periodic { phase: TAU }
    }
    fn period<T: Scalar>(&self, _p: &[T]) -> T {
        T::constant(TAU)
    }
}

/// Γ at the fold where orbits with one impact in `n` periods are born.
pub fn fold(n: usize, e: f64) -> f64 {
    n as f64 * PI * (1.0 - e) / (1.0 + e)
}

/// Γ where they double their period, at `S = 2 (1 + e²)/(1 + e)²`.
pub fn doubling(n: usize, e: f64) -> f64 {
    fold(n, e).hypot(2.0 * (1.0 + e * e) / (1.0 + e).powi(2))
}

/// The orbit with one impact in `n` periods that doubles its period (`0 ≤ t ≤ π/2`): the time of
/// the impact and the velocity of launch.
pub fn orbit(n: usize, gamma: f64, e: f64) -> [f64; 2] {
    [(fold(n, e) / gamma).acos(), n as f64 * PI]
}

/// Trace and determinant of the derivative from launch to launch on that orbit.
pub fn map(n: usize, gamma: f64, e: f64) -> [f64; 2] {
    let s = gamma * orbit(n, gamma, e)[0].sin();
    [1.0 + e * e - (1.0 + e).powi(2) * s, e * e]
}

/// Over a resting table: when a ball released at rest at a height has come to rest, after
/// infinitely many impacts, by the geometric series of its times of flight.
pub fn rest(height: f64, e: f64) -> f64 {
    (2.0 * height).sqrt() * (1.0 + e) / (1.0 - e)
}

/// When a ball at rest on the table is thrown off, for `Γ > 1`: the table's acceleration is that of
/// weight.
pub fn leave(gamma: f64) -> f64 {
    gamma.recip().asin()
}
