//! Robustness maps, which show where methods succeed, report failures, or are silently wrong.
//!
//! A map runs methods on a grid of the quantities that make the methods fail, such as the distance
//! from a fold, the modulus of a multiplier, or the rate of a stiff field. Each cell of the grid is
//! classified by the error type that the method returns, or by comparison of its result with an
//! exact answer. Naive methods are included to show failures that are not reported.

mod chatter;
mod events;
mod grid;
mod newton;
mod polynomials;
mod quadrature;
mod shooting;
mod steps;
mod stiffness;

use crate::report::entries;
use crate::{Entry, RobustnessMap};

/// All robustness maps.
pub const MAPS: &[Entry<fn() -> RobustnessMap>] = entries![
    "newton": "Newton's method near a fold, for each load and initial guess", newton::draw;
    "steps": "steps along a bend near another branch, for each radius of the bend and step length", steps::draw;
    "shooting": "shooting over segments and collocation, for each size of the multipliers", shooting::draw;
    "events": "searches for crossings at each distance from a grazing, and the location of the grazing", events::draw;
    "chatter": "infinitely many impacts in a finite time, for each coefficient of restitution and each end of the motion", chatter::draw;
    "polynomials": "polynomials of plates by powers and by recurrence: correct digits for each order", polynomials::draw;
    "quadrature": "Gauss points for the load of a plate near contact, and error estimates of the model there", quadrature::draw;
    "stiffness": "explicit methods and the implicit method on stiff fields, for each rate and tolerance", stiffness::draw;
];

/// Computes a robustness map.
///
/// ```
/// use tangency_reports::{Class};
/// use tangency_reports::robustness::{MAPS, map};
/// let map = map(MAPS.iter().find(|entry| entry.name == "polynomials").expect("a map"));
/// // Sums of powers silently lose all digits of polynomials of order 50; the recurrence keeps them.
/// let class = |method| map.at(0, method, [50.0, 0.0]).map(|found| found.class);
/// assert_eq!(class("powers, 16 digits"), Some(Class::Silent));
/// assert_eq!(class("functions of plates"), Some(Class::Right));
/// ```
pub fn map(entry: &Entry<fn() -> RobustnessMap>) -> RobustnessMap {
    (entry.make)()
}
