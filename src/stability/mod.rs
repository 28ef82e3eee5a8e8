//! Where methods fail, and what they say then: maps of success and failure, computed by one command.
//!
//! A map tries methods at every place of a grid over what makes them fail: the distance from a fold, the size of a multiplier,
//! the rate of a stiff field. Every cell comes from running the method there and then, and is told by the type of the error that it
//! returns, or by comparison with an exact answer. Naive methods stand beside those of the library to show what goes wrong unsaid.

mod chatter;
mod events;
mod grid;
mod newton;
mod polynomials;
mod quadrature;
mod shooting;
mod steps;
mod stiffness;

use crate::output::Map;

/// Why there is no map.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum MapError {
    /// What all methods are compared with fails.
    #[error("the reference fails, {method}: {cause}")]
    Reference {
        /// The method that gives it.
        method: &'static str,
        /// Why.
        cause: String,
    },
}

/// A map by its name.
#[derive(Clone, Copy)]
pub struct Entry {
    /// The name.
    pub name: &'static str,
    /// What it shows, in a line.
    pub shows: &'static str,
    draw: fn() -> Result<Map, MapError>,
}

/// All maps.
pub const MAPS: &[Entry] = &[
    Entry {
        name: "newton",
        shows: "Newton's iteration about a fold: guess against load",
        draw: newton::draw,
    },
    Entry {
        name: "steps",
        shows: "steps along a bend beside another branch: length against radius",
        draw: steps::draw,
    },
    Entry {
        name: "shooting",
        shows: "shooting over segments and collocation against the size of multipliers",
        draw: shooting::draw,
    },
    Entry {
        name: "events",
        shows: "searches for crossings against the distance from a touch, and the touch itself",
        draw: events::draw,
    },
    Entry {
        name: "chatter",
        shows: "infinitely many impacts in a finite time: restitution against the end of the motion",
        draw: chatter::draw,
    },
    Entry {
        name: "polynomials",
        shows: "polynomials of plates by powers and by recurrence: digits against order",
        draw: polynomials::draw,
    },
    Entry {
        name: "quadrature",
        shows: "Gauss points for the load of a plate near contact, and what the model says there",
        draw: quadrature::draw,
    },
    Entry {
        name: "stiffness",
        shows: "explicit methods and the implicit one: tolerance against rate",
        draw: stiffness::draw,
    },
];

/// Computes a map.
///
/// ```
/// use tangency::output::Class;
/// use tangency::stability::{MAPS, map};
/// let map = map(MAPS.iter().find(|entry| entry.name == "newton").expect("a map"))?;
/// // Beyond the fold there is no solution at the load: Newton's formula finds one behind the electrode, and the core says no.
/// let [plain, damped] = [0, 1].map(|k| &map.panels[k].methods[0].name);
/// assert_eq!(map.at(0, plain, [1.2, 1.4]).map(|found| found.class), Some(Class::Unsaid));
/// assert_eq!(map.at(1, damped, [1.2, 0.3]).map(|found| found.class), Some(Class::SaidSo));
/// # Ok::<(), tangency::stability::MapError>(())
/// ```
///
/// # Errors
/// [`MapError`] if there is nothing to compare with.
pub fn map(entry: &Entry) -> Result<Map, MapError> {
    (entry.draw)()
}
