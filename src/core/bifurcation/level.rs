//! Levels of parameters and monitors: defining system and test function.

use super::at::{At, Quantity};
use super::defining_system::DefiningSystem;
use super::test_function::{Bracketed, PointValues, TestFunction};
use crate::core::failure::Failure;
use crate::core::system::{Functional, Kind};

/// The defining system of points where a parameter or a monitor has a given value, its level.
///
/// ```
/// use tangency::core::bifurcation::{At, DefiningSystem, Level, NullSpace, Quantity};
/// use tangency::core::failure::Failure;
/// use tangency::core::system::{Dense, Kind};
/// use tangency::problems::classic::ParallelPlate;
/// let mut level = Level::new(Quantity::Parameter(0), 2.0, Kind::UZ);
/// let mut value = [0.0];
/// let (mut system, mut null) = (Dense::new(ParallelPlate), NullSpace::default());
/// let at = At { system: &mut system, x: &[0.2, 5.0], released: &[0], held: &[], null: &mut null };
/// level.values(at, &[], &mut value)?;
/// assert_eq!(value, [3.0]);
/// # Ok::<(), Failure>(())
/// ```
#[derive(Clone, Debug)]
pub struct Level {
    /// The quantity.
    pub quantity: Quantity,
    /// The level.
    pub level: f64,
    /// The kind of the special point.
    pub kind: Kind,
}

impl Level {
    /// Creates the defining system `quantity = level`.
    pub fn new(quantity: Quantity, level: f64, kind: Kind) -> Self {
        Level { quantity, level, kind }
    }
}

impl DefiningSystem for Level {
    fn kind(&self) -> Kind {
        self.kind
    }

    fn start(&mut self, at: At, _y: &mut [f64]) -> Result<(), Failure> {
        let names = at.system.names();
        let (what, position, count) = match self.quantity {
            Quantity::Parameter(p) => ("parameter", p, names.parameters.len()),
            Quantity::Monitor(m) => ("monitor", m, names.monitors.len()),
        };
        if position >= count {
            return Err(Failure::Mismatch(format!(
                "the condition that a {what} has a given value refers to the {what} with number \
                 {position}, but the system has only {count} {what}s, numbered from 0"
            )));
        }
        Ok(())
    }

    fn values(&mut self, at: At, _y: &[f64], values: &mut [f64]) -> Result<(), Failure> {
        match self.quantity {
            Quantity::Parameter(p) => values[0] = at.x[at.system.names().dimension() + p],
            Quantity::Monitor(m) => at.system.monitors(at.x, m, &mut values[..1])?,
        }
        values[0] -= self.level;
        Ok(())
    }

    fn gradients(&mut self, at: At, rows: &mut [f64], _own: &mut [f64]) -> Result<(), Failure> {
        match self.quantity {
            Quantity::Parameter(p) => {
                rows.fill(0.0);
                rows[at.system.names().dimension() + p] = 1.0;
            }
            Quantity::Monitor(m) => {
                at.system.gradient(at.x, Functional::Monitor(m), at.released, rows)?
            }
        }
        Ok(())
    }
}

/// The test function of a level: the value of the parameter or monitor, minus the level.
pub(crate) struct Excess(pub Quantity, pub f64);

impl TestFunction for Excess {
    fn value(&self, at: &mut At, known: &PointValues) -> Result<Option<f64>, Failure> {
        let Excess(quantity, level) = *self;
        let value = match quantity {
            Quantity::Parameter(p) => at.x[at.system.names().dimension() + p],
            Quantity::Monitor(m) => known.monitors[m],
        };
        Ok(Some(value - level).filter(|value| !value.is_nan()))
    }

    fn level(&self) -> Option<(Quantity, f64)> {
        Some((self.0, self.1))
    }

    fn guess(&self, within: &Bracketed) -> f64 {
        let Bracketed { values: [low, high], length, slope, .. } = *within;
        match slope {
            Some(slope) => zero_of_parabola(low, high, slope * length),
            None => low / (low - high),
        }
    }
}

/// Returns the zero in 0..1 of a parabola with the value `low` at 0, the value `high` of opposite
/// sign at 1, and the given `slope` at 1.
fn zero_of_parabola(low: f64, high: f64, slope: f64) -> f64 {
    // high + slope (s − 1) + c (s − 1)²
    let c = low - high + slope;
    let root = (slope * slope - 4.0 * c * high).max(0.0).sqrt();
    // The root without cancellation: the parabola passes zero once between the ends.
    1.0 - 2.0 * high / (slope + root.copysign(high - low))
}
