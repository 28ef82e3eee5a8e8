//! Where an orbit touches a guard.

use super::error::GrazingError;
use crate::core::field::Forcing;
use crate::core::hybrid::HybridEquations;
use crate::core::orbit::Leg;

/// A point of a grazing orbit: time and state of the touch, what follows an event there at once, and how the
/// orbit returns to it.
///
/// ```
/// use tangency::core::grazing::GrazingPoint;
/// use tangency::core::orbit::{HybridOrbit, Itinerary};
/// use tangency::problems::classic::ImpactOscillator;
/// // Without impacts, at resonance x = A sin t/(c ω): it grazes for A = c d, at t = π/2.
/// let orbit = HybridOrbit::of(ImpactOscillator, Itinerary::smooth(ImpactOscillator::FLIGHT, 1));
/// let point = GrazingPoint::of(&orbit, &[0.0, 1.0], &[0.1, 1.0, 0.8, 0.1, 1.0])?;
/// assert!((point.time - std::f64::consts::FRAC_PI_2).abs() < 1e-9);
/// assert!((point.x[0] - 1.0).abs() < 1e-12 && point.guard == ImpactOscillator::IMPACT);
/// // After an impact the flight goes on at once; the orbit returns in one leg of 2π.
/// assert!(point.following.is_empty() && point.legs.len() == 1);
/// # Ok::<(), tangency::core::grazing::GrazingError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct GrazingPoint {
    /// The guard that is touched.
    pub guard: usize,
    /// The mode that would end there.
    pub mode: usize,
    /// When (under forcing).
    pub time: f64,
    /// The state.
    pub x: Vec<f64>,
    /// All parameters.
    pub p: Vec<f64>,
    /// The legs that last no time, from the event of the guard to where motion goes on in the mode.
    pub following: Vec<Leg>,
    /// The legs of the orbit from the touch to the next one, with their durations; the last one ends by the
    /// touch.
    pub legs: Vec<(Leg, f64)>,
    /// The periods of the forcing that the orbit takes.
    pub periods: usize,
}

impl GrazingPoint {
    /// Refuses a point whose numbers do not belong to a system.
    pub(super) fn check(&self, system: &dyn HybridEquations) -> Result<(), GrazingError> {
        if let Forcing::Periodic { phase } = system.forcing()
            && !(phase > 0.0 && phase.is_finite())
        {
            return Err(GrazingError::Phase(phase));
        }
        let (modes, guards) = (system.modes(), system.guards());
        let (all_modes, all_guards) = (modes.len(), guards.len());
        let legs = self.legs.iter().map(|(leg, _)| leg).chain(&self.following);
        let fits = |holds, what, found, expected, meant| match holds {
            true => Ok(()),
            false => Err(GrazingError::Mismatch { what, found, expected, meant }),
        };
        let below = |what, found, all, meant| fits(found < all, what, found, all, meant);
        let same =
            |what, found, expected, meant| fits(found == expected, what, found, expected, meant);
        let ends = |guard: usize, mode: usize| match guards[guard].ends(mode) {
            true => Ok(()),
            false => Err(GrazingError::NoEnd {
                guard: guards[guard].name.clone(),
                mode: modes[mode].name.clone(),
            }),
        };
        for leg in legs {
            below("a leg is in mode", leg.mode, all_modes, "is the number of modes")?;
            let Some(exit) = leg.exit else { continue };
            below("a leg ends by guard", exit, all_guards, "is the number of guards")?;
            ends(exit, leg.mode)?;
        }
        below("it is in mode", self.mode, all_modes, "is the number of modes")?;
        below("it touches guard", self.guard, all_guards, "is the number of guards")?;
        ends(self.guard, self.mode)?;
        let states = modes[self.mode].states.len();
        same("its states number", self.x.len(), states, "are those of the mode")?;
        let parameters = system.parameters().len();
        same("its parameters number", self.p.len(), parameters, "are those of the system")?;
        // A point without a leg is as one whose first leg is in no mode.
        let first = self.legs.first().map_or(all_modes, |(leg, _)| leg.mode);
        same("its first leg is in mode", first, self.mode, "is the touched one")
    }
}
