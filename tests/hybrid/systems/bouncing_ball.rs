//! A ball on a table that moves as `Γ sin t`, in units of time `1/ω` and of length `g/ω²`:
//! `y'' = −1`.
//!
//! A ball that leaves the table at `t` with the velocity `v` over the ground reaches it again after
//! `τ`, and is thrown back by the part `e` of its speed over the table. With one impact in `n`
//! periods, `τ = 2πn` and `v = πn`, impacts come at the phase with `Γ cos t = πn (1 − e)/(1 + e)`.
//! There the map from `(t, v)` to the next has the derivative
//! `[[1, 1 + e], [−(1 + e) S, e² − (1 + e)² S]]` with `S = Γ sin t`.

use std::f64::consts::{PI, TAU};
use tangency::hybrid_system;

hybrid_system! {
    /// Modes `flight` and `contact`, in which the ball moves with the table; parameters `acceleration`
    /// Γ and `restitution` e. Without restitution it is in contact at once where the table presses.
    pub struct BouncingBall [acceleration, restitution; t] {
        let (table, rate) = (acceleration * t.sin(), acceleration * t.cos());
        period = T::constant(TAU);
        mode flight [height, velocity] {
            d/dt height = velocity;
            d/dt velocity = -T::one();
            event impact: height - table
                => flight { height, velocity: rate - restitution * (velocity - rate) };
            accumulates to contact { height };
        }
        mode contact [height] {
            d/dt height = rate;
            // The table pushes by its acceleration −Γ sin t and the weight.
            event leave: T::one() - table => flight { height, velocity: rate };
        }
        fn next_mode(&self, guard: usize, _mode: usize, t: f64, _x: &[f64], p: &[f64]) -> usize {
            let sticks = guard == Self::IMPACT && p[1] == 0.0 && p[0] * t.sin() < 1.0;
            if sticks { Self::CONTACT } else { Self::FLIGHT }
        }
    }
}

impl BouncingBall {
    pub const FLIGHT: usize = 0;
    pub const CONTACT: usize = 1;
    pub const IMPACT: usize = 0;
    pub const LEAVE: usize = 1;
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
