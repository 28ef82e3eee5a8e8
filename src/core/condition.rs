//! Conditions: equations that hold at a special point, and all along a curve of such points.
//!
//! A condition adds `k + 1` equations in `x = (z, p)` and `k` unknowns `y` of its own. With one more
//! parameter released it can be held along a curve; together with a branch it defines a point.
//! One mechanism therefore finishes every special point and follows every curve of them.

use super::continuation::Kind;
use super::zero::{LeftDomain, Singular, System};

/// Why equations could not be evaluated.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum EvaluationError {
    /// The point lies outside the domain of the equations.
    #[error(transparent)]
    LeftDomain(#[from] LeftDomain),
    /// A matrix that defines a condition is singular.
    #[error(transparent)]
    Singular(#[from] Singular),
    /// The condition does not apply at this point.
    #[error("{0}")]
    NotApplicable(String),
}

/// Where a condition is evaluated: the system, `x = (z, p)`, and the released parameters (positions
/// among the parameters), whose derivatives are wanted.
pub struct At<'a> {
    /// The system.
    pub system: &'a mut dyn System,
    /// The unknowns and all parameters.
    pub x: &'a [f64],
    /// Positions of the released parameters.
    pub released: &'a [usize],
}

/// A condition on a zero problem: `k + 1` equations with `k` unknowns of their own.
pub trait Condition {
    /// The kind of special point that the condition defines.
    fn kind(&self) -> Kind;

    /// The number `k` of unknowns of its own.
    fn unknowns(&self) -> usize {
        0
    }

    /// Prepares the condition near a point: chooses borders, and the unknowns `y` of its own.
    ///
    /// # Errors
    /// [`EvaluationError`] if the condition cannot be stated there.
    fn start(&mut self, at: At, y: &mut [f64]) -> Result<(), EvaluationError>;

    /// The `k + 1` left sides of its equations.
    ///
    /// # Errors
    /// [`EvaluationError`] outside the domain, or where the condition's own matrix is singular.
    fn values(&mut self, at: At, y: &[f64], values: &mut [f64]) -> Result<(), EvaluationError>;

    /// Their gradients at the point where [`values`](Condition::values) was called last: `rows` by `x`
    /// (`k + 1` rows as long as `x`; only released parameters count), `own` by `y` (`k + 1` rows of `k`).
    ///
    /// # Errors
    /// As for the values.
    fn gradients(
        &mut self,
        at: At,
        y: &[f64],
        rows: &mut [f64],
        own: &mut [f64],
    ) -> Result<(), EvaluationError>;

    /// The vector `b` if the `j`-th unknown of the condition unfolds the problem: `F + yⱼ b = 0`.
    fn unfolding(&self, _j: usize) -> Option<&[f64]> {
        None
    }

    /// Turns the borders towards the present null vectors, so that they stay well conditioned along
    /// a curve.
    fn adapt(&mut self) {}
}

/// What can be held at a level.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// The parameter at this position.
    Parameter(usize),
    /// The monitor at this position.
    Monitor(usize),
}

/// A parameter or a monitor at a given level.
#[derive(Clone, Debug)]
pub struct Level {
    /// What is held.
    pub quantity: Quantity,
    /// The level.
    pub level: f64,
    /// The kind of the point.
    pub kind: Kind,
    monitors: Vec<f64>,
}

impl Level {
    /// `quantity = level`.
    pub fn new(quantity: Quantity, level: f64, kind: Kind) -> Self {
        Level { quantity, level, kind, monitors: Vec::new() }
    }
}

impl Condition for Level {
    fn kind(&self) -> Kind {
        self.kind
    }

    fn start(&mut self, at: At, _y: &mut [f64]) -> Result<(), EvaluationError> {
        self.monitors.resize(at.system.names().monitors.len(), 0.0);
        Ok(())
    }

    fn values(&mut self, at: At, _y: &[f64], values: &mut [f64]) -> Result<(), EvaluationError> {
        values[0] = match self.quantity {
            Quantity::Parameter(p) => at.x[at.system.names().dimension() + p],
            Quantity::Monitor(m) => {
                // Monitors may need the assembled F_z (a frequency does).
                at.system.assemble(at.x)?;
                at.system.monitors(at.x, &mut self.monitors)?;
                self.monitors[m]
            }
        } - self.level;
        Ok(())
    }

    fn gradients(
        &mut self,
        at: At,
        _y: &[f64],
        rows: &mut [f64],
        _own: &mut [f64],
    ) -> Result<(), EvaluationError> {
        match self.quantity {
            Quantity::Parameter(p) => {
                rows.fill(0.0);
                rows[at.system.names().dimension() + p] = 1.0;
            }
            Quantity::Monitor(m) => at.system.monitor_gradient(m, at.x, rows),
        }
        Ok(())
    }
}
