//! Where an orbit touches a guard.

use super::error::GrazingError;
use super::map::{MapSettings, positions};
use super::maps::Source;
use super::section::{Coordinate, Section, unit_of_phase};
use super::surface::Surface;
use crate::core::condition::Failure;
use crate::core::field::Forcing;
use crate::core::hybrid::{HybridEquations, guard_scale};
use crate::core::jet::Polynomial;
use crate::core::linear::BorderedLu;
use crate::core::orbit::Leg;
use crate::core::zero::Border;

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

/// How often Newton's iteration for a grazing orbit is repeated, and when it is done, in units of the scales.
const ITERATIONS: usize = 12;
const DONE: f64 = 1e-11;

impl GrazingPoint {
    /// The nearest point that an orbit returns to, one parameter being free: Newton's iteration on the linear
    /// local map, to an orbit that misses its start by no more than 1e-11.
    ///
    /// ```
    /// use tangency::core::grazing::GrazingPoint;
    /// use tangency::core::orbit::{HybridOrbit, Itinerary};
    /// use tangency::problems::mita::Actuator;
    /// // From six digits at ω = 0.5; the orbit starts at the touch.
    /// let orbit = HybridOrbit::of(Actuator, Itinerary::smooth(Actuator::STICK, 1));
    /// let mut p = Actuator::DEFAULTS;
    /// p[0] = 0.227178;
    /// let rough = GrazingPoint {
    ///     guard: Actuator::FRONT,
    ///     mode: Actuator::STICK,
    ///     time: 5.98551 / 0.5,
    ///     x: vec![0.5, 0.0],
    ///     p: p.to_vec(),
    ///     following: Vec::new(),
    ///     legs: vec![(orbit.itinerary().legs[0], std::f64::consts::PI / 0.5)],
    ///     periods: 1,
    /// };
    /// let point = rough.located(&Actuator, "voltage")?;
    /// assert!((point.p[0] - 0.2271775831).abs() < 1e-10);
    /// assert!((0.5 * point.time - 5.985512558).abs() < 1e-9);
    /// # Ok::<(), tangency::core::grazing::GrazingError>(())
    /// ```
    ///
    /// # Errors
    /// [`GrazingError`], [`NotLocated`](GrazingError::NotLocated) if the iteration does not converge.
    pub fn located(
        &self,
        system: &dyn HybridEquations,
        parameter: &str,
    ) -> Result<Self, GrazingError> {
        self.check(system)?;
        let positions = positions(system, &[parameter])?;
        let mut point = self.clone();
        let mut residual = f64::INFINITY;
        for _ in 0..ITERATIONS {
            residual = point.correct(system, &positions)?;
            if residual < DONE {
                return Ok(point);
            }
        }
        let parameter = parameter.to_string();
        Err(GrazingError::NotLocated { parameter, iterations: ITERATIONS, residual })
    }

    /// Refuses a point whose numbers do not belong to a system.
    pub(super) fn check(&self, system: &dyn HybridEquations) -> Result<(), GrazingError> {
        if let Forcing::Periodic { phase } = system.forcing()
            && !(phase > 0.0 && phase.is_finite())
        {
            return Err(GrazingError::Phase { phase });
        }
        let (modes, guards) = (system.modes(), system.guards());
        let (all_modes, all_guards) = (modes.len(), guards.len());
        let legs = self.legs.iter().map(|(leg, _)| leg).chain(&self.following);
        let below = |what, found, expected, meant| match found < expected {
            true => Ok(()),
            false => Err(GrazingError::Mismatch { what, found, expected, meant }),
        };
        let same = |what, found, expected, meant| match found == expected {
            true => Ok(()),
            false => Err(GrazingError::Mismatch { what, found, expected, meant }),
        };
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

    /// One iteration of Newton's for `P_smooth(ξ, p) = ξ` and `h(ξ, p) = 0`. Returns by how much both were
    /// missed.
    fn correct(
        &mut self,
        system: &dyn HybridEquations,
        parameters: &[usize],
    ) -> Result<f64, GrazingError> {
        let settings = MapSettings { order: 1, ..MapSettings::default() };
        let section = &Section::of(system, self)?;
        let smooth = Source { system, point: self, section, parameters, settings }.smooth()?;
        let n = section.coordinates.len();
        let rows: Vec<&Polynomial> = smooth.images.iter().chain([&smooth.penetration]).collect();
        let mut change: Vec<f64> = rows.iter().map(|row| -row.coefficients()[0]).collect();
        let depth = guard_scale(system, (self.guard, self.mode), (self.time, &self.x), &self.p);
        let sizes = section.scales.iter().chain([&depth]);
        let parts = change.iter().zip(sizes).map(|(missed, size)| missed.abs() / size);
        let residual = parts.fold(0.0, f64::max);
        let entry = |k: usize| {
            let (i, j) = (k % (n + 1), k / (n + 1));
            rows[i].coefficients()[1 + j] - f64::from(u8::from(i == j && i < n))
        };
        let matrix: Vec<f64> = (0..(n + 1) * (n + 1)).map(entry).collect();
        let mut lu = BorderedLu::default();
        lu.factor(&matrix, Border::NONE).map_err(Failure::from)?;
        lu.solve(&mut change);
        let before = unit_of_phase(system, &self.p);
        self.p[parameters[0]] += change[n];
        let after = unit_of_phase(system, &self.p);
        self.time *= after / before;
        for (coordinate, change) in section.coordinates.iter().zip(change) {
            match coordinate {
                Coordinate::State(i) => self.x[*i] += change,
                Coordinate::Phase => self.time += change * after,
            }
        }
        let k = section.eliminated;
        for _ in 0..ITERATIONS {
            let turning = Surface::Turning(self.guard);
            self.x[k] -= turning.value(system, self.mode, self.time, &self.x, &self.p)
                / section.slopes[1][1];
        }
        Ok(residual)
    }
}
