//! Classification of grazings by the scenario that occurs as a parameter changes.
//!
//! To first order the image of a virtual point is `N (D_z z + D_p p) + N_p p`, where `z` consists
//! of the point's `y` and its other coordinates, `N` and `N_p` are the derivatives of `P_smooth`,
//! and `D_z` and `D_p` are the derivatives of the discontinuity map; the first column `β` of `D_z`
//! is the derivative with respect to `y`. The virtual point itself is `E z + E_p p`, where the
//! column of `E` for `y` is zero, since the penetration is `y²`. Therefore the orbit with an impact
//! has the following `z`:
//!
//! ```text
//!     z = −(N D_z − E)⁻¹ (N D_p + N_p − E_p) p.
//! ```
//!
//! The orbit with an impact exists on the side of the grazing on which `y` is positive. The orbit
//! without impacts is `ξ = (I − N)⁻¹ N_p p`, and exists on the side of the grazing on which `h` is
//! positive. One multiplier of the orbit with an impact grows like `[Nβ]_normal/(2y)` (A. B.
//! Nordmark, *J. Sound Vib.* 145:279, 1991).
//!
//! If `β = 0`, as at a soft stop, the same equations hold with the penetration `y²` in place of
//! `y`: the first column of `D_z` and of `E` is then the derivative with respect to `y²`, and the
//! multipliers of the orbit with the event are the eigenvalues `μ` of `N D_z v = μ E v`.

use super::error::GrazingError;
use super::map::LocalMap;
use crate::core::linalg::{Spectrum, multipliers, solved, unit};
use crate::core::problem::position;
use crate::core::scalar::Polynomial;
use std::fmt::{Display, Formatter};

/// The scenarios of a grazing as one parameter changes (X. Zhao, *Modeling and Simulation of MEMS
/// Devices*, 2004, chapter 4).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Scenario {
    /// Scenario I: an unstable orbit with an impact exists on the same side of the grazing as the
    /// stable orbit without impacts. In scenario I both orbits end at the grazing. Motion jumps
    /// from there to another attractor, mostly a stable orbit with an impact, and the jump shows
    /// hysteresis.
    Jump,
    /// Scenario II: an orbit with an impact, unstable with a multiplier near `−∞`, exists beyond
    /// the grazing: the attractor changes continuously, mostly to a chaotic attractor.
    Continuous,
    /// A stable orbit with the event exists beyond the grazing, so that the attractor persists.
    /// The persistent scenario occurs if the discontinuity map is of order 3/2 or more
    /// ([`LocalMap::exponent`]), unless a multiplier is 1.
    Persistent,
    /// Scenario III: the orbit without impacts has lost its stability before it grazes: attractors
    /// do not reach the grazing, and motion jumps, mostly to chaos.
    Unstable,
}

impl Display for Scenario {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Scenario::Jump => "I",
            Scenario::Continuous => "II",
            Scenario::Persistent => "persistent",
            Scenario::Unstable => "III",
        })
    }
}

/// The first-order quantities that determine the scenario of a grazing.
#[derive(Clone, Debug, PartialEq)]
pub struct Classification {
    /// The scenario.
    pub scenario: Scenario,
    /// The multipliers of the orbit without impacts at the grazing, which are the eigenvalues of
    /// `N`.
    pub multipliers: Spectrum,
    /// The derivative, with respect to the parameter, of the distance `h` between the surface and
    /// the orbit without impacts: this orbit exists on the side of the grazing on which `h` is
    /// positive.
    pub distance: f64,
    /// The derivative, with respect to the parameter, of the unknown `y` of the orbit with an
    /// impact: this orbit exists on the side of the grazing on which `y` is positive. If the
    /// discontinuity map does not contain a square root ([`LocalMap::exponent`]), the derivative of
    /// `y²` is stored instead of the derivative of `y`.
    pub depth: f64,
    /// To leading order, the orbit with an impact has the multiplier `growth/y`, which tends to
    /// `+∞` in scenario I, and to `−∞` in scenario II and beyond a fold (III). The value of
    /// `growth` is 0 if the discontinuity map has no square root.
    pub growth: f64,
}

/// Returns the derivative of a polynomial with respect to a variable at zero deviations.
fn slope(polynomial: &Polynomial, variable: usize) -> f64 {
    polynomial.coefficients()[1 + variable]
}

/// Returns the coefficient of the square of a variable in a polynomial.
fn second(polynomial: &Polynomial, variable: usize) -> f64 {
    let mut powers = vec![0; polynomial.space().variables()];
    powers[variable] = 2;
    polynomial.coefficient(&powers)
}

impl LocalMap {
    /// Classifies the grazing by the scenario that occurs as the named parameter increases.
    ///
    /// ```
    /// use tangency::core::local_map::{GrazingPoint, LocalMap, MapSettings, Scenario};
    /// # use tangency::core::orbit::{HybridOrbit, Itinerary};
    /// # use tangency::problems::classic::ImpactOscillator;
    /// # let orbit = HybridOrbit::of(ImpactOscillator, Itinerary::smooth(ImpactOscillator::FLIGHT, 1))?;
    /// # let point = GrazingPoint::of(&orbit, &[0.0, 1.0], &[0.1, 1.0, 0.8, 0.1, 1.0])?;
    /// // The oscillator of the example of `LocalMap`: below the grazing amplitude both orbits exist.
    /// let map = LocalMap::of(&ImpactOscillator, &point, &["amplitude"], MapSettings::default())?;
    /// let found = map.classified("amplitude")?;
    /// assert!(found.scenario == Scenario::Jump && found.depth < 0.0);
    /// // The orbit without impacts reaches as far as x = A/(c ω).
    /// assert!((found.distance + 10.0).abs() < 1e-8);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`GrazingError::Unknown`] if the parameter is not a variable of the map;
    /// [`GrazingError::Failure`] if a multiplier of the orbit with an impact, or of the orbit
    /// without impacts, is 1, as at codimension-two points. [`GrazingError::NoRoot`] for a map of
    /// order 1 whose discontinuity map has no square root.
    pub fn classified(&self, parameter: &str) -> Result<Classification, GrazingError> {
        let (n, normal) = (self.coordinates().len(), self.normal());
        let p = n + position("parameter", parameter, self.parameters())?;
        let smooth = |i: usize, j: usize| slope(&self.smooth()[i], j);
        let root = self.exponent() == Some(0.5);
        if !root && self.space().order() == 1 {
            return Err(GrazingError::NoRoot);
        }
        // ∂/∂z or p, where the normal part of z is y or, without a root, y².
        let regular = |polynomial: &Polynomial, j: usize| match j == normal && !root {
            true => second(polynomial, j),
            false => slope(polynomial, j),
        };
        let jump = |i: usize, j: usize| regular(&self.discontinuity()[i], j);
        // ∂(image, virtual point)/∂ z or p.
        let image = |i: usize, j: usize| -> f64 {
            let direct = if j < n { 0.0 } else { smooth(i, j) };
            (0..n).map(|k| smooth(i, k) * jump(k, j)).sum::<f64>() + direct
        };
        let place =
            |i: usize, j: usize| if i == normal { regular(self.entry(), j) } else { unit(i, j) };
        let difference = |i: usize, j: usize| image(i, j) - place(i, j);
        let with = solved(n, difference, |i| -difference(i, p))?;
        let without = solved(n, |i, j| unit(i, j) - smooth(i, j), |i| smooth(i, p))?;
        let penetration = (0..n).map(|k| slope(self.penetration(), k) * without[k]).sum::<f64>();
        let multipliers = spectrum(n, smooth, unit)?;
        let (distance, depth) = (-penetration - slope(self.penetration(), p), with[normal]);
        let scenario = if unstable(&multipliers) {
            Scenario::Unstable
        } else if distance * depth > 0.0 {
            Scenario::Jump
        } else if root || unstable(&spectrum(n, image, place)?) {
            Scenario::Continuous
        } else {
            Scenario::Persistent
        };
        // ∂y/∂(normal coordinate) = ∂(y²)/∂(normal coordinate) / 2y.
        let root = f64::from(u8::from(root));
        let growth = root * 0.5 * image(normal, normal) * slope(self.penetration(), normal);
        Ok(Classification { scenario, multipliers, distance, depth, growth })
    }
}

/// Computes the eigenvalues `μ` of the generalised problem `A v = μ B v`.
fn spectrum(
    n: usize,
    a: impl Fn(usize, usize) -> f64,
    b: impl Fn(usize, usize) -> f64,
) -> Result<Spectrum, GrazingError> {
    let a: Vec<f64> = (0..n * n).map(|k| a(k / n, k % n)).collect();
    let b: Vec<f64> = (0..n * n).map(|k| -b(k / n, k % n)).collect();
    Ok(multipliers(&a, &b, n)?)
}

fn unstable(multipliers: &Spectrum) -> bool {
    multipliers.iter().any(|mu| mu.0.hypot(mu.1) > 1.0)
}
