//! An impact oscillator whose restitution falls with the speed of the impact, so that its map from
//! impact to impact changes areas by other factors at other speeds.

use super::impact_oscillator::ClosedForm;
use std::f64::consts::{PI, TAU};
use tangency::hybrid_system;

pub const FREQUENCY: f64 = 2.2;
const RESTITUTION: f64 = 0.9;
const FALL: f64 = 0.03;

hybrid_system! {
    /// `x'' = A cos ωt − x − c x'` with `v⁺ = −(e₀ − κ v²) v` at `x = 1`; parameters `damping` c,
    /// which may be negative, and `amplitude` A.
    pub struct Rebound [damping, amplitude; t] {
        period = T::from(TAU / FREQUENCY);
        mode flight [displacement, velocity] {
            d/dt displacement = velocity;
            d/dt velocity = amplitude * (t * FREQUENCY).cos() - displacement - damping * velocity;
            event impact: -displacement + 1.0 => flight {
                displacement,
                velocity: velocity * (velocity * velocity * FALL - RESTITUTION),
            };
        }
    }
}

impl Rebound {
    pub const FLIGHT: usize = 0;
    pub const IMPACT: usize = 0;
}

/// The damping at which the map from impact to impact keeps areas at a fixed point of the incoming
/// speed `u`: `(e₀ − κu²)(e₀ − 3κu²) e^{−cT} = 1`.
pub fn critical(u: f64) -> f64 {
    let factor = (RESTITUTION - FALL * u * u) * (RESTITUTION - 3.0 * FALL * u * u);
    0.5 * FREQUENCY / PI * factor.ln()
}

/// The orbit of an incoming speed is one with a constant restitution.
pub fn orbit(u: f64, damping: f64) -> ClosedForm {
    ClosedForm::new(FREQUENCY, RESTITUTION - FALL * u * u, damping, 1.0)
}
