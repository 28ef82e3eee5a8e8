//! Grazing points, at which an orbit touches the surface of a guard, and the surfaces at these
//! points.

use super::error::GrazingError;
use crate::core::hybrid::{
    FieldNumber, GuardNumber, HybridEquations, Moment, guard_scale, time_scale,
};
use crate::core::orbit::Leg;
use crate::core::problem::Forcing;
use num_dual::Dual;

/// Discretisation: the largest magnitude, in units of the scales, of the guard and of its rate at a
/// grazing point: grazings are located to 1e-10 or better, and a transverse event has a rate of
/// order 1.
pub(super) const TOUCHES: f64 = 1e-8;

/// A grazing point of an orbit: its time and state, the zero-length legs after an event at the
/// point (a leg is a part of the orbit between two events), and the legs by which the orbit returns
/// to the point.
///
/// ```
/// use tangency::core::local_map::GrazingPoint;
/// use tangency::core::orbit::{HybridOrbit, Itinerary};
/// use tangency::problems::classic::ImpactOscillator;
/// // Without impacts, at resonance x = A sin t/(c ω): it grazes for A = c d, at t = π/2.
/// let orbit = HybridOrbit::of(ImpactOscillator, Itinerary::smooth(ImpactOscillator::FLIGHT, 1))?;
/// let point = GrazingPoint::of(&orbit, &[0.0, 1.0], &[0.1, 1.0, 0.8, 0.1, 1.0])?;
/// assert!((point.time - std::f64::consts::FRAC_PI_2).abs() < 1e-9);
/// assert!((point.x[0] - 1.0).abs() < 1e-12 && point.guard == ImpactOscillator::IMPACT);
/// // After an impact the flight resumes immediately; the orbit returns in one leg of 2π.
/// assert!(point.following.is_empty() && point.legs.len() == 1);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct GrazingPoint {
    /// The grazed guard.
    pub guard: usize,
    /// The mode of the orbit at the grazing point, which an event of the guard would end.
    pub mode: usize,
    /// The time of grazing, relevant only under forcing.
    pub time: f64,
    /// The state at the grazing point.
    pub x: Vec<f64>,
    /// All parameters.
    pub p: Vec<f64>,
    /// The zero-length legs (parts of an orbit between two events) between an event of the guard
    /// and the return of motion to the mode of the grazing point.
    pub following: Vec<Leg>,
    /// The legs (parts of the orbit between two events) by which the orbit returns to the grazing
    /// point, with their durations; the last leg ends at the grazing point.
    pub legs: Vec<(Leg, f64)>,
    /// The number of forcing periods of the orbit.
    pub periods: usize,
}

impl GrazingPoint {
    /// Returns the grazing point as a [`Moment`] of a system's motion.
    pub(super) fn moment<'a>(&'a self, system: &'a dyn HybridEquations) -> Moment<'a, f64> {
        Moment { system, mode: self.mode, t: self.time, x: &self.x, p: &self.p }
    }

    /// Returns the scale of the grazed guard.
    pub(super) fn guard_scale(&self, system: &dyn HybridEquations) -> f64 {
        guard_scale(system, (self.guard, self.mode), (self.time, &self.x), &self.p)
    }

    /// Returns an error if the orbit does not touch the surface at the point.
    pub(super) fn touches(&self, system: &dyn HybridEquations) -> Result<(), GrazingError> {
        let touch = Surface::Guard(self.guard).moving(self.moment(system));
        let (value, rate, time) = (touch.re, touch.eps, self.time);
        let scale = self.guard_scale(system);
        let slow = TOUCHES * scale / time_scale(system, &self.p);
        if value.abs() <= TOUCHES * scale && rate.abs() <= slow {
            return Ok(());
        }
        let guard = system.guards()[self.guard].name.clone();
        Err(GrazingError::NoTouch { guard, time, value, rate })
    }

    /// Returns an error if the grazing point does not belong to the system, for example because one
    /// of its modes does not exist or its number of states is wrong.
    pub(super) fn check(&self, system: &dyn HybridEquations) -> Result<(), GrazingError> {
        if let Forcing::Periodic { phase } = system.forcing()
            && !(phase > 0.0 && phase.is_finite())
        {
            return Err(GrazingError::Phase(phase));
        }
        let (modes, guards) = (system.modes(), system.guards());
        let fits = |holds: bool, refused: &dyn Fn() -> String| {
            if holds { Ok(()) } else { Err(GrazingError::Foreign(refused())) }
        };
        let touch = Leg::new(self.mode, Some(self.guard));
        let legs = self.legs.iter().map(|(leg, _)| leg).chain(&self.following);
        for &Leg { mode, exit, accumulates } in legs.chain([&touch]) {
            fits(!accumulates, &|| "infinitely many events of the orbit accumulate".into())?;
            fits(mode < modes.len(), &|| {
                format!(
                    "mode {mode} of the orbit does not exist: the system has {} modes, \
                         numbered from 0",
                    modes.len()
                )
            })?;
            let (Some(exit), ended) = (exit, &modes[mode].name) else { continue };
            let guard = guards.get(exit).map_or("", |guard| &guard.name);
            let ends = guards.get(exit).is_some_and(|guard| guard.ends(mode));
            fits(ends, &|| {
                format!(
                    "a leg of the orbit ends mode `{ended}` at guard {exit} \
                                    (`{guard}`), but this guard does not end this mode"
                )
            })?;
        }
        let (states, parameters) = (modes[self.mode].states.len(), system.parameters().len());
        let (x, p) = (self.x.len(), self.p.len());
        fits(x == states, &|| {
            format!("the point has {x} states, but its mode has {states} states")
        })?;
        fits(p == parameters, &|| {
            format!("the point has {p} parameters, but the system has {parameters} parameters")
        })?;
        let first = self.legs.first().map(|(leg, _)| leg.mode);
        fits(first == Some(self.mode), &|| {
            "the first leg of the orbit must be in the mode of the grazing point, but is in \
             another mode"
                .into()
        })
    }
}

/// A surface in the space of time and states, given by a guard.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Surface {
    /// The surface on which a guard vanishes.
    Guard(usize),
    /// The turning surface, on which the rate of change of a guard along the motion vanishes.
    Turning(usize),
}

impl Surface {
    /// Evaluates the function that vanishes on the surface.
    pub fn value<T: FieldNumber + GuardNumber>(self, at: Moment<T>) -> T
    where
        Dual<T>: GuardNumber,
    {
        match self {
            Surface::Guard(guard) => at.guard(guard),
            Surface::Turning(guard) => at.rate(guard),
        }
    }

    /// Evaluates the function that vanishes on the surface, with its rate of change along the
    /// motion.
    pub fn moving<T: FieldNumber>(self, at: Moment<T>) -> Dual<T>
    where
        Dual<T>: FieldNumber + GuardNumber,
        Dual<Dual<T>>: GuardNumber,
    {
        at.along(|moving| self.value(moving))
    }

    /// Returns the name of the surface, formed from the name of its guard.
    pub fn name(self, system: &dyn HybridEquations) -> String {
        let (Surface::Guard(guard) | Surface::Turning(guard)) = self;
        let name = &system.guards()[guard].name;
        match self {
            Surface::Guard(_) => format!("the event `{name}`"),
            Surface::Turning(_) => format!("the section at the minimum of guard `{name}`"),
        }
    }
}
