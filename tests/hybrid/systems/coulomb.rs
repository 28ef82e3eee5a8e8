//! The forced oscillator with Coulomb's friction, `x'' + x + F sgn x' = cos βt` (J. P. Den
//! Hartog, *Trans. ASME* 53:107, 1931).

use std::f64::consts::{PI, TAU};
use tangency::core::hybrid::{Guard, HybridSystem, Mode};
use tangency::core::problem::Forcing;
use tangency::core::scalar::Scalar;

/// Modes `forward`, `backward` and `stick`; parameters `frequency` β and `friction` F.
#[derive(Clone, Copy, Debug)]
pub struct Coulomb;

impl Coulomb {
    pub const FORWARD: usize = 0;
    pub const BACKWARD: usize = 1;
    pub const STICK: usize = 2;
    /// The end of forward motion.
    pub const HIGH: usize = 0;
    /// The end of backward motion.
    pub const LOW: usize = 1;
    /// The end of rest by a force forwards.
    pub const PULL: usize = 2;
    /// The end of rest by a force backwards.
    pub const PUSH: usize = 3;
}

impl HybridSystem for Coulomb {
    fn modes(&self) -> Vec<Mode> {
        let states = ["displacement", "velocity"];
        let stick = Mode::new("stick", ["displacement"]);
        vec![Mode::new("forward", states), Mode::new("backward", states), stick]
    }
    fn guards(&self) -> Vec<Guard> {
        vec![
            Guard::new("high", [Self::FORWARD]),
            Guard::new("low", [Self::BACKWARD]),
            Guard::new("pull", [Self::STICK]),
            Guard::new("push", [Self::STICK]),
        ]
    }
    fn parameters(&self) -> Vec<String> {
        vec!["frequency".into(), "friction".into()]
    }
    fn field<T: Scalar>(&self, mode: usize, t: T, x: &[T], p: &[T], f: &mut [T]) {
        if mode == Self::STICK {
            f[0] = T::zero();
            return;
        }
        let friction = if mode == Self::FORWARD { p[1] } else { -p[1] };
        f[0] = x[1];
        f[1] = (p[0] * t).cos() - x[0] - friction;
    }
    fn guard<T: Scalar>(&self, guard: usize, _mode: usize, t: T, x: &[T], p: &[T]) -> T {
        let force = (p[0] * t).cos() - x[0];
        match guard {
            Self::HIGH => x[1],
            Self::LOW => -x[1],
            Self::PULL => p[1] - force,
            _ => p[1] + force,
        }
    }
    fn reset<T: Scalar>(
        &self,
        _g: usize,
        (_, next): (usize, usize),
        _t: T,
        x: &[T],
        _p: &[T],
        after: &mut [T],
    ) {
        after[0] = x[0];
        if next != Self::STICK {
            after[1] = T::zero();
        }
    }
    fn may_follow(&self, guard: usize, _mode: usize) -> Vec<usize> {
        match guard {
            Self::PULL => vec![Self::FORWARD],
            Self::PUSH => vec![Self::BACKWARD],
            _ => vec![Self::FORWARD, Self::BACKWARD, Self::STICK],
        }
    }
    /// The force beyond friction, forwards and backwards.
    fn decision<T: Scalar>(
        &self,
        position: usize,
        _guard: usize,
        _mode: usize,
        t: T,
        x: &[T],
        p: &[T],
    ) -> T {
        let force = (p[0] * t).cos() - x[0];
        if position == 0 { force - p[1] } else { -force - p[1] }
    }
    fn forcing(&self) -> Forcing {
        Forcing::Periodic { phase: TAU }
    }
    fn period<T: Scalar>(&self, p: &[T]) -> T {
        p[0].recip() * TAU
    }
}

/// Den Hartog's function `H = sin(π/β)/(β (1 + cos(π/β)))`.
pub fn hartog(beta: f64) -> f64 {
    let turn = PI / beta;
    turn.sin() / (beta * (1.0 + turn.cos()))
}

/// The amplitude of the motion that never stops.
pub fn amplitude(beta: f64, friction: f64) -> f64 {
    let response = 1.0 / (1.0 - beta * beta);
    (response.powi(2) - (friction * hartog(beta)).powi(2)).sqrt()
}

/// The backward half of that motion, displacement and velocity so long after its start at the
/// amplitude `X`, at the phase `φ` of the force with `cos φ = X/V`, `sin φ = −F H/V`:
/// `x = V cos(φ + βs) + F − F cos s − F tan(π/2β) sin s`.
pub fn backward<T: Scalar>(beta: f64, friction: f64, after: T) -> [T; 2] {
    let response = 1.0 / (1.0 - beta * beta);
    let (phase, slope) = (phase(beta, friction), friction * (0.5 * PI / beta).tan());
    let (free, forced) = (after.sin_cos(), (after * beta + phase).sin_cos());
    [
        forced.1 * response + friction - free.1 * friction - free.0 * slope,
        -forced.0 * (response * beta) + free.0 * friction - free.1 * slope,
    ]
}

/// The phase `φ` of the force where the motion turns backward.
pub fn phase(beta: f64, friction: f64) -> f64 {
    let response = 1.0 / (1.0 - beta * beta);
    let sine = -friction * hartog(beta) / response;
    sine.atan2(amplitude(beta, friction) / response)
}
