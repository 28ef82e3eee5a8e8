//! Any of the systems with known answers, as one type: what is generic over systems is compiled
//! once for all.

use super::belt::Belt;
use super::bouncing_ball::BouncingBall;
use super::coulomb::Coulomb;
use super::dry_impact::DryImpact;
use super::piecewise::Piecewise;
use super::rebound::Rebound;
use tangency::core::hybrid::filippov::Filippov;
use tangency::core::hybrid::{Guard, HybridSystem, Mode};
use tangency::core::problem::Forcing;
use tangency::core::scalar::Scalar;
use tangency::problems::classic::ImpactOscillator;
use tangency::problems::mita::Actuator;

#[derive(Clone, Copy, Debug)]
pub enum Reference {
    Actuator,
    Belt,
    BouncingBall,
    Coulomb,
    DryImpact,
    ImpactOscillator,
    Piecewise,
    Rebound,
}

/// What the system says.
macro_rules! of {
    ($reference:expr, $system:ident => $answer:expr) => {
        match $reference {
            Reference::Actuator => of!(Actuator, $system, $answer),
            Reference::Belt => of!(Filippov(Belt), $system, $answer),
            Reference::BouncingBall => of!(BouncingBall, $system, $answer),
            Reference::Coulomb => of!(Coulomb, $system, $answer),
            Reference::DryImpact => of!(DryImpact, $system, $answer),
            Reference::ImpactOscillator => of!(ImpactOscillator, $system, $answer),
            Reference::Piecewise => of!(Piecewise, $system, $answer),
            Reference::Rebound => of!(Rebound, $system, $answer),
        }
    };
    ($value:expr, $system:ident, $answer:expr) => {{
        let $system = $value;
        $answer
    }};
}

impl HybridSystem for Reference {
    as_another!(self, of);
}
