//! The local map `P = P_smooth ∘ D`.

use super::chart::{MapSettings, Source};
use super::error::GrazingError;
use super::maps::{Discontinuity, Smooth};
use super::point::GrazingPoint;
use super::section::{Coordinate, Section, unit_of_phase};
use super::surface::Surface;
use crate::core::hybrid::{HybridEquations, guard_scale, time_scale};
use crate::core::jet::{Polynomial, Space};
use crate::core::names::position;

/// An orbit touches its guard when guard and rate are no larger than this, in units of the scales.
const TOUCHES: f64 = 1e-8;

/// The Poincaré map near a grazing orbit: `P = P_smooth ∘ D` on the section where the touched guard is least,
/// in deviations from the grazing orbit.
///
/// The coordinates are all states of the touched mode but one (that which the section determines) and, under
/// forcing, the phase; the parameters are those asked for.
///
/// ```
/// use tangency::core::grazing::{GrazingPoint, LocalMap, MapSettings};
/// use tangency::core::orbit::{HybridOrbit, Itinerary};
/// use tangency::problems::classic::ImpactOscillator;
/// // At resonance, ω = 1, A = c d = 0.1 grazes at t = π/2, with the acceleration −a = −d ω².
/// let orbit = HybridOrbit::of(ImpactOscillator, Itinerary::smooth(ImpactOscillator::FLIGHT, 1));
/// let point = GrazingPoint::of(&orbit, &[0.0, 1.0], &[0.1, 1.0, 0.8, 0.1, 1.0])?;
/// let map = LocalMap::of(&ImpactOscillator, &point, &["amplitude"], MapSettings::default())?;
/// assert_eq!(map.coordinates(), ["displacement", "phase"]);
/// assert_eq!(map.parameters(), ["amplitude"]);
/// // An impact costs the time (1 + e) √(2/a) y, and leaves e² of the penetration.
/// let [displacement, phase] = map.discontinuity() else { panic!("two coordinates") };
/// assert!((phase.coefficient(&[1, 0, 0]) + 1.8 * 2.0_f64.sqrt()).abs() < 1e-9);
/// assert!((displacement.coefficient(&[2, 0, 0]) - 0.64).abs() < 1e-9);
/// # Ok::<(), tangency::core::grazing::GrazingError>(())
/// ```
#[derive(Clone, Debug)]
pub struct LocalMap {
    coordinates: Vec<String>,
    parameters: Vec<String>,
    /// Coordinates and parameters of the grazing orbit.
    origin: Vec<f64>,
    normal: usize,
    pub(super) smooth: Smooth,
    pub(super) discontinuity: Discontinuity,
}

/// The coordinate that tells the time in periods of the forcing.
pub const PHASE: &str = "phase";

impl LocalMap {
    /// The local map of a system at a grazing point, with deviations of the parameters named.
    ///
    /// # Errors
    /// [`GrazingError`] if the orbit does not touch quadratically at the point or does not return to it, if
    /// no coordinates can be found, or for a name or an order that there is not.
    pub fn of(
        system: &dyn HybridEquations,
        point: &GrazingPoint,
        parameters: &[&str],
        settings: MapSettings,
    ) -> Result<Self, GrazingError> {
        if settings.order == 0 {
            return Err(GrazingError::Order(0));
        }
        point.check(system)?;
        let known = system.parameters();
        let position = |name: &&str| position("parameter", name, &known);
        let positions: Vec<usize> = parameters.iter().map(position).collect::<Result<_, _>>()?;
        let section = &Section::of(system, point)?;
        touches(system, point)?;
        let source = Source { system, point, section, parameters: &positions, settings };
        let (smooth, discontinuity) = (source.smooth()?, source.discontinuity()?);
        let states = system.modes().swap_remove(point.mode).states;
        let described = section.coordinates.iter().map(|coordinate| match coordinate {
            Coordinate::State(i) => (states[*i].clone(), point.x[*i]),
            Coordinate::Phase => (PHASE.into(), point.time / unit_of_phase(system, &point.p)),
        });
        let (coordinates, mut origin): (Vec<String>, Vec<f64>) = described.unzip();
        origin.extend(positions.iter().map(|k| point.p[*k]));
        returns(&smooth, section, &coordinates)?;
        Ok(LocalMap {
            coordinates,
            parameters: parameters.iter().map(|name| name.to_string()).collect(),
            origin,
            normal: section.normal_coordinate(),
            smooth,
            discontinuity,
        })
    }

    /// The monomials of all polynomials: coordinates, then parameters.
    pub fn space(&self) -> &'static Space {
        self.penetration().space()
    }

    /// The names of the coordinates.
    pub fn coordinates(&self) -> &[String] {
        &self.coordinates
    }

    /// The names of the parameters.
    pub fn parameters(&self) -> &[String] {
        &self.parameters
    }

    /// Coordinates and parameters of the grazing orbit, from which all others deviate.
    pub fn origin(&self) -> (&[f64], &[f64]) {
        self.origin.split_at(self.coordinates.len())
    }

    /// The position of the coordinate in place of which `D` has `y`.
    pub fn normal(&self) -> usize {
        self.normal
    }

    /// `P_smooth`: the deviations of the coordinates after one turn.
    pub fn smooth(&self) -> &[Polynomial] {
        &self.smooth.images
    }

    /// The penetration `−h` on the section.
    pub fn penetration(&self) -> &Polynomial {
        &self.smooth.penetration
    }

    /// `D`: the deviations of the coordinates as functions of `y` (in place of the normal coordinate), the
    /// other coordinates, and the parameters.
    pub fn discontinuity(&self) -> &[Polynomial] {
        &self.discontinuity.images
    }

    /// The normal coordinate of the virtual point as a function of the same.
    pub fn entry(&self) -> &Polynomial {
        &self.discontinuity.entry
    }
}

/// An orbit returns to its touch when it misses it by no more than this, in units of the scales.
const RETURNS: f64 = 1e-3;

/// Refuses an orbit that does not return.
fn returns(smooth: &Smooth, section: &Section, coordinates: &[String]) -> Result<(), GrazingError> {
    let missed = smooth.images.iter().map(|image| image.coefficients()[0]);
    let parts = missed.zip(&section.scales).map(|(missed, scale)| (missed / scale, missed));
    let farthest = parts.zip(coordinates).max_by(|a, b| a.0.0.abs().total_cmp(&b.0.0.abs()));
    match farthest.filter(|((part, _), _)| part.is_nan() || part.abs() > RETURNS) {
        Some(((_, missed), coordinate)) => {
            Err(GrazingError::NoReturn { coordinate: coordinate.clone(), missed })
        }
        None => Ok(()),
    }
}

/// Refuses a point at which the orbit does not touch.
fn touches(system: &dyn HybridEquations, point: &GrazingPoint) -> Result<(), GrazingError> {
    let GrazingPoint { guard, mode, time, x, p, .. } = point;
    let touch = Surface::Guard(*guard).moving(point.moment(system));
    let (value, rate, time) = (touch.re, touch.eps, *time);
    let scale = guard_scale(system, (*guard, *mode), (time, x), p);
    let slow = TOUCHES * scale / time_scale(system, p);
    if value.abs() <= TOUCHES * scale && rate.abs() <= slow {
        return Ok(());
    }
    let guard = system.guards()[*guard].name.clone();
    Err(GrazingError::NoTouch { guard, time, value, rate })
}
