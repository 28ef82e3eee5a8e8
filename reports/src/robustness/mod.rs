//! Robustness maps: where methods succeed, report failures, or are silently wrong.
//!
//! A map runs methods on a grid over the quantities that make them fail: the distance from a fold,
//! the size of a multiplier, the rate of a stiff field. Each cell runs the method and is classified
//! by its error type or by comparison with an exact answer. Naive methods are included to show
//! silent failures.

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
    "newton": "Newton's iteration about a fold: guess against load", newton::draw;
    "steps": "steps along a bend beside another branch: length against radius", steps::draw;
    "shooting": "shooting over segments and collocation against the size of multipliers", shooting::draw;
    "events": "searches for crossings against the distance from a touch, and the touch itself", events::draw;
    "chatter": "infinitely many impacts in a finite time: restitution against the end of the motion", chatter::draw;
    "polynomials": "polynomials of plates by powers and by recurrence: digits against order", polynomials::draw;
    "quadrature": "Gauss points for the load of a plate near contact, and error estimates of the model there", quadrature::draw;
    "stiffness": "explicit methods and the implicit one: tolerance against rate", stiffness::draw;
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
