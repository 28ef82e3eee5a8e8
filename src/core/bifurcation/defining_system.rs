//! Conditions: equations that hold at a special point, and all along a curve of such points.
//!
//! A condition adds `k + 1` equations in `x = (z, p)` and `k` unknowns `y` of its own. With one
//! more parameter released it can be held along a curve; together with a branch it defines a point.
//! One mechanism therefore finishes every special point and follows every curve of them.

use super::null::NullSpace;
use super::test_function::{Bracketed, PointValues, TestFunction};
use crate::core::failure::Failure;
use crate::core::system::{Functional, Kind, System};

/// A point at which a condition or a test function is evaluated.
pub struct At<'a> {
    /// The system.
    pub system: &'a mut dyn System,
    /// The unknowns and all parameters, `x = (z, p)`.
    pub x: &'a [f64],
    /// Positions of the released parameters among all parameters. Derivatives by these are wanted.
    pub released: &'a [usize],
    /// The auxiliary unknowns of the conditions held along the curve, as the frequency `ω` along a
    /// curve of Hopf points.
    pub held: &'a [f64],
    /// The null vectors at this point, shared by all that need them.
    pub null: &'a mut NullSpace,
}

impl At<'_> {
    /// The same point, borrowed again.
    pub(crate) fn again(&mut self) -> At<'_> {
        let At { system, x, released, held, null } = self;
        At { system: &mut **system, x, released, held, null }
    }
}

/// A condition on a zero problem: `k + 1` equations with `k` unknowns of their own.
///
/// ```
/// use tangency::core::bifurcation::{At, DefiningSystem};
/// use tangency::core::failure::Failure;
/// use tangency::core::continuation::{Continuation, Event};
/// use tangency::core::system::{Dense, Kind};
/// use tangency::problems::classic::Hyperbola;
/// /// `x μ = 20`, with its gradient `(μ, x, 0)`.
/// struct Product;
/// impl DefiningSystem for Product {
///     fn kind(&self) -> Kind {
///         Kind::UZ
///     }
///     fn values(&mut self, at: At, _: &[f64], values: &mut [f64]) -> Result<(), Failure> {
///         values[0] = at.x[0] * at.x[1] - 20.0;
///         Ok(())
///     }
///     fn gradients(&mut self, at: At, rows: &mut [f64], _: &mut [f64]) -> Result<(), Failure> {
///         rows.copy_from_slice(&[at.x[1], at.x[0], 0.0]);
///         Ok(())
///     }
/// }
/// // x² = μ² + 9, of which x = 5, μ = 4 is one solution.
/// let mut hyperbola = Dense::new(Hyperbola);
/// let curve = Continuation::of(&mut hyperbola).from(&[3.0]).at("epsilon", 3.0);
/// let branch = curve.along("mu", 0.0..=9.0).event(Event::new("x μ = 20", || Product)).trace()?;
/// let found = branch.of_kind(Kind::UZ).next().unwrap();
/// assert!((found.parameters[0] - 4.0).abs() < 1e-13);
/// # Ok::<(), tangency::core::continuation::TraceError>(())
/// ```
pub trait DefiningSystem: Send {
    /// The kind of special point that the condition defines.
    fn kind(&self) -> Kind;

    /// The number `k` of unknowns of its own.
    fn unknowns(&self) -> usize {
        0
    }

    /// Names of the first of its auxiliary unknowns, which are recorded along a curve that the
    /// condition is held on.
    fn names(&self) -> &'static [&'static str] {
        &[]
    }

    /// Whether its values need the assembled `F_z`, with which the residual then comes.
    fn assembles(&self) -> bool {
        false
    }

    /// Prepares the condition near a point: chooses borders, and the unknowns `y` of its own.
    ///
    /// # Errors
    /// [`Failure`] if the condition cannot be stated there.
    fn start(&mut self, _at: At, _y: &mut [f64]) -> Result<(), Failure> {
        Ok(())
    }

    /// The `k + 1` left sides of its equations.
    ///
    /// # Errors
    /// [`Failure`] outside the domain, or where the condition's own matrix is singular.
    fn values(&mut self, at: At, y: &[f64], values: &mut [f64]) -> Result<(), Failure>;

    /// Their gradients at the point where [`values`](DefiningSystem::values) was called last:
    /// `rows` by `x` (`k + 1` rows as long as `x`; only released parameters count), `own` by `y`
    /// (`k + 1` rows of `k`).
    ///
    /// # Errors
    /// As for the values.
    fn gradients(&mut self, at: At, rows: &mut [f64], own: &mut [f64]) -> Result<(), Failure>;

    /// The vector `b` if the `j`-th unknown of the condition unfolds the problem: `F + yⱼ b = 0`.
    fn unfolding<'b>(&'b self, _j: usize, _null: &'b NullSpace) -> Option<&'b [f64]> {
        None
    }

    /// Turns borders that only this condition uses towards the present null vectors, so that the
    /// bordered matrix stays well conditioned along a curve. The borders of the shared null vectors
    /// are turned in any case.
    fn adapt(&mut self) {}
}

/// What can be held at a level.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Quantity {
    /// The parameter at this position.
    Parameter(usize),
    /// The monitor at this position.
    Monitor(usize),
}

/// A parameter or a monitor at a given level.
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
    /// What is held.
    pub quantity: Quantity,
    /// The level.
    pub level: f64,
    /// The kind of the point.
    pub kind: Kind,
}

impl Level {
    /// `quantity = level`.
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
        let (position, count) = match self.quantity {
            Quantity::Parameter(p) => (p, names.parameters.len()),
            Quantity::Monitor(m) => (m, names.monitors.len()),
        };
        if position >= count {
            return Err(Failure::Mismatch(format!(
                "the level is that of quantity {position}, counted from 0, of {count}"
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

/// The test function of a level: the parameter or monitor, less the level.
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

/// Where a parabola vanishes that goes from `low` to `high`, of the other sign, on the interval
/// from 0 to 1, and ends with this `slope`.
fn zero_of_parabola(low: f64, high: f64, slope: f64) -> f64 {
    // high + slope (s − 1) + c (s − 1)²
    let c = low - high + slope;
    let root = (slope * slope - 4.0 * c * high).max(0.0).sqrt();
    // Of both roots the one without cancellation: the parabola passes zero once between the ends.
    1.0 - 2.0 * high / (slope + root.copysign(high - low))
}
