//! The local map `P = P_smooth ∘ D`.

use super::chart::{MapSettings, Source};
use super::error::GrazingError;
use super::maps::{Discontinuity, Smooth};
use super::point::GrazingPoint;
use super::section::{Coordinate, Section, unit_of_phase};
use crate::core::hybrid::HybridEquations;
use crate::core::problem::position;
use crate::core::scalar::{Polynomial, Space};
use std::fmt::{Display, Formatter};

/// The Poincaré map near a grazing orbit: `P = P_smooth ∘ D` on the section on which the grazed
/// guard is minimal along the motion, in terms of deviations from the grazing orbit.
///
/// The coordinates are all states of the grazed mode except one, which the section determines, and
/// under forcing also the phase; the parameters are those named at creation.
///
/// ```
/// use tangency::core::local_map::{GrazingPoint, LocalMap, MapSettings};
/// use tangency::core::orbit::{HybridOrbit, Itinerary};
/// use tangency::problems::classic::ImpactOscillator;
/// // At resonance, ω = 1, A = c d = 0.1 grazes at t = π/2, with the acceleration −a = −d ω².
/// let orbit = HybridOrbit::of(ImpactOscillator, Itinerary::smooth(ImpactOscillator::FLIGHT, 1))?;
/// let point = GrazingPoint::of(&orbit, &[0.0, 1.0], &[0.1, 1.0, 0.8, 0.1, 1.0])?;
/// let map = LocalMap::of(&ImpactOscillator, &point, &["amplitude"], MapSettings::default())?;
/// assert_eq!(map.coordinates(), ["displacement", "phase"]);
/// assert_eq!(map.parameters(), ["amplitude"]);
/// // An impact costs the time (1 + e) √(2/a) y, and leaves e² of the penetration.
/// let [displacement, phase] = map.discontinuity() else { panic!("two coordinates") };
/// assert!((phase.coefficient(&[1, 0, 0]) + 1.8 * 2.0_f64.sqrt()).abs() < 1e-9);
/// assert!((displacement.coefficient(&[2, 0, 0]) - 0.64).abs() < 1e-9);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct LocalMap {
    coordinates: Vec<String>,
    parameters: Vec<String>,
    /// The coordinates and parameters at the grazing point.
    origin: Vec<f64>,
    /// The typical sizes of the coordinates.
    pub(super) scales: Vec<f64>,
    normal: usize,
    pub(super) smooth: Smooth,
    pub(super) discontinuity: Discontinuity,
}

/// The name of the coordinate that represents the time in units of the forcing period.
pub const PHASE: &str = "phase";

impl LocalMap {
    /// Computes the local map of a system at a grazing point, as a function of deviations of the
    /// coordinates and of the named parameters.
    ///
    /// # Errors
    /// [`GrazingError`] if the orbit has no quadratic contact with the surface at the point or does
    /// not return to the point, if no coordinates can be found, if a parameter does not exist, or
    /// if the order is out of range.
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
        point.touches(system)?;
        let source = Source { system, point, section, parameters: &positions, settings: &settings };
        let (smooth, discontinuity) = (source.smooth()?, source.discontinuity()?);
        let states = system.modes().swap_remove(point.mode).states;
        let described = section.coordinates.iter().map(|coordinate| match coordinate {
            Coordinate::State(i) => (states[*i].clone(), point.x[*i]),
            Coordinate::Phase => (PHASE.into(), point.time / unit_of_phase(system, &point.p)),
        });
        let (coordinates, mut origin): (Vec<String>, Vec<f64>) = described.unzip();
        origin.extend(positions.iter().map(|k| point.p[*k]));
        returns(&smooth, section, &coordinates)?;
        let parameters = parameters.iter().map(|name| name.to_string()).collect();
        let normal = section.normal_coordinate();
        let scales = section.scales.clone();
        Ok(LocalMap { coordinates, parameters, origin, scales, normal, smooth, discontinuity })
    }

    /// Returns the monomials of the map's polynomials, whose variables are the coordinates followed
    /// by the parameters.
    pub fn space(&self) -> &'static Space {
        self.penetration().space()
    }

    /// Returns the names of the coordinates.
    pub fn coordinates(&self) -> &[String] {
        &self.coordinates
    }

    /// Returns the names of the parameters.
    pub fn parameters(&self) -> &[String] {
        &self.parameters
    }

    /// Returns the coordinates and parameters of the grazing orbit, from which deviations are
    /// measured.
    pub fn origin(&self) -> (&[f64], &[f64]) {
        self.origin.split_at(self.coordinates.len())
    }

    /// Returns the index of the coordinate that `D` replaces by `y`.
    pub fn normal(&self) -> usize {
        self.normal
    }

    /// Returns `P_smooth`: the deviations of the coordinates after one turn, ignoring the surface.
    pub fn smooth(&self) -> &[Polynomial] {
        &self.smooth.images
    }

    /// Returns the penetration `−h` as a polynomial on the section.
    pub fn penetration(&self) -> &Polynomial {
        &self.smooth.penetration
    }

    /// Returns `D`: the deviations of the coordinates as functions of `y` (in place of the normal
    /// coordinate), the other coordinates, and the parameters.
    pub fn discontinuity(&self) -> &[Polynomial] {
        &self.discontinuity.images
    }

    /// Returns the leading order of the difference between `D` and the identity, as a power of the
    /// penetration. The power is 1/2 at an impact, and 3/2 if motion enters a vector field whose
    /// first derivative differs, as at a soft stop (M. di Bernardo et al., *Piecewise-smooth
    /// Dynamical Systems*, 2008, chapter 7). Returns `None` if `D` is the identity up to the order
    /// of the map.
    ///
    /// ```
    /// # use tangency::core::local_map::{GrazingPoint, LocalMap, MapSettings};
    /// # use tangency::core::orbit::{HybridOrbit, Itinerary};
    /// # use tangency::problems::classic::ImpactOscillator;
    /// # let orbit = HybridOrbit::of(ImpactOscillator, Itinerary::smooth(ImpactOscillator::FLIGHT, 1))?;
    /// # let point = GrazingPoint::of(&orbit, &[0.0, 1.0], &[0.1, 1.0, 0.8, 0.1, 1.0])?;
    /// // The oscillator of the example of `LocalMap`: a root.
    /// let map = LocalMap::of(&ImpactOscillator, &point, &[], MapSettings::default())?;
    /// assert_eq!(map.exponent(), Some(0.5));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn exponent(&self) -> Option<f64> {
        self.discontinuity.power.map(|power| power as f64 / 2.0)
    }

    /// Returns the normal coordinate of the virtual point as a function of `y`, the other
    /// coordinates, and the parameters.
    pub fn entry(&self) -> &Polynomial {
        &self.discontinuity.entry
    }
}

/// Heuristic: the largest distance, in units of the scales, by which an orbit may miss its grazing
/// point after one turn. Only wrong input is rejected: if the durations of legs (the parts of an
/// orbit between two events) are given for the wrong legs, the orbit misses the point by a distance
/// of order 1, but a located orbit misses it by 1e-11.
const RETURNS: f64 = 1e-3;

/// Returns an error if the orbit does not return to its grazing point.
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

/// The magnitude below which coefficients are printed as zero: half a unit of the tenth decimal,
/// which is the last one printed.
const LEAST: f64 = 5e-11;

/// Prints one table for `D` and one for `P_smooth`: a row for each monomial, and a column for each
/// coordinate of the image.
///
/// ```
/// use tangency::core::local_map::{GrazingPoint, LocalMap, MapSettings};
/// # use tangency::core::orbit::{HybridOrbit, Itinerary};
/// # use tangency::problems::classic::ImpactOscillator;
/// # let orbit = HybridOrbit::of(ImpactOscillator, Itinerary::smooth(ImpactOscillator::FLIGHT, 1))?;
/// # let point = GrazingPoint::of(&orbit, &[0.0, 1.0], &[0.1, 1.0, 0.8, 0.1, 1.0])?;
/// // The oscillator of the example of `LocalMap`.
/// let settings = MapSettings { order: 1, ..MapSettings::default() };
/// let map = LocalMap::of(&ImpactOscillator, &point, &["amplitude"], settings)?;
/// let printed = map.to_string();
/// assert!(printed.starts_with("smooth map, order 1"));
/// let row = printed.lines().find(|line| line.starts_with("y ")).expect("the row of y");
/// assert_eq!(row.split_whitespace().collect::<Vec<_>>(), ["y", "0.0000000000", "-2.5455844123"]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
impl Display for LocalMap {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        let deviation = |name: &String| format!("Δ{name}");
        let mut variables: Vec<String> =
            self.coordinates().iter().chain(self.parameters()).map(deviation).collect();
        writeln!(f, "smooth map, order {}", self.space().order())?;
        self.table(f, &variables, self.smooth())?;
        variables[self.normal()] = "y".into();
        let leading = match self.exponent() {
            Some(exponent) => format!("leading term y^{}", 2.0 * exponent),
            None => "the identity up to this order".into(),
        };
        writeln!(f, "discontinuity map, y = √(penetration), {leading}")?;
        self.table(f, &variables, self.discontinuity())
    }
}

impl LocalMap {
    fn table(
        &self,
        f: &mut Formatter<'_>,
        variables: &[String],
        images: &[Polynomial],
    ) -> std::fmt::Result {
        let labels: Vec<String> = (0..self.space().len())
            .map(|k| monomial(variables, self.space().exponents(k)))
            .collect();
        let width = labels.iter().map(|label| label.chars().count()).max().unwrap_or(0);
        write!(f, "{:width$}", "")?;
        for name in self.coordinates() {
            write!(f, " {:>16}", format!("Δ{name}"))?;
        }
        writeln!(f)?;
        for k in 1..self.space().len() {
            let coefficients: Vec<f64> =
                images.iter().map(|image| image.coefficients()[k]).collect();
            if coefficients.iter().all(|c| c.abs() < LEAST) {
                continue;
            }
            write!(f, "{:width$}", labels[k])?;
            for c in coefficients {
                // Avoids negative zeros.
                let c = if c.abs() < LEAST { 0.0 } else { c };
                write!(f, " {c:>16.10}")?;
            }
            writeln!(f)?;
        }
        Ok(())
    }
}

/// Formats a monomial of the given variables, such as `Δx²Δp`.
fn monomial(variables: &[String], exponents: &[u8]) -> String {
    let power = |(name, power): (&String, &u8)| match power {
        0 => String::new(),
        1 => name.clone(),
        _ => name.clone() + &power.to_string().chars().filter_map(raised).collect::<String>(),
    };
    variables.iter().zip(exponents).map(power).collect()
}

/// Converts a digit to a superscript.
fn raised(digit: char) -> Option<char> {
    "⁰¹²³⁴⁵⁶⁷⁸⁹".chars().nth(digit.to_digit(10)? as usize)
}
