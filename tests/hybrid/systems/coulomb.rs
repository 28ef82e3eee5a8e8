//! The forced oscillator with Coulomb's friction, `x'' + x + F sgn x' = cos βt` (J. P. Den
//! Hartog, *Trans. ASME* 53:107, 1931).

use std::f64::consts::{PI, TAU};
use tangency::core::scalar::Scalar;
use tangency::hybrid_system;

hybrid_system! {
    /// Modes `forward`, `backward` and `stick`; parameters `frequency` β and `friction` F.
    pub struct Coulomb [frequency, friction; t] {
        period = frequency.recip() * TAU;
        mode forward [displacement, velocity] {
            let force = (frequency * t).cos() - displacement;
            d/dt displacement = velocity;
            d/dt velocity = force - friction;
            event high: velocity
                => forward { displacement, velocity: T::zero() } if force - friction,
                    backward { displacement, velocity: T::zero() } if -force - friction,
                    stick { displacement };
        }
        mode backward [displacement, velocity] {
            let force = (frequency * t).cos() - displacement;
            d/dt displacement = velocity;
            d/dt velocity = force + friction;
            event low: -velocity
                => forward { displacement, velocity: T::zero() } if force - friction,
                    backward { displacement, velocity: T::zero() } if -force - friction,
                    stick { displacement };
        }
        mode stick [displacement] {
            let force = (frequency * t).cos() - displacement;
            d/dt displacement = T::zero();
            event pull: friction - force => forward { displacement, velocity: T::zero() };
            event push: friction + force => backward { displacement, velocity: T::zero() };
        }
    }
}

impl Coulomb {
    pub const FORWARD: usize = 0;
    pub const BACKWARD: usize = 1;
    pub const STICK: usize = 2;
    /// The end of backward motion.
    pub const LOW: usize = 1;
    /// The end of rest by a force backwards.
    pub const PUSH: usize = 3;
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
