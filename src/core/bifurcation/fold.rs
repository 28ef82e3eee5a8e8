//! Folds of equilibria.

use super::null::NullVectors;
use crate::core::condition::{At, Condition, EvaluationError};
use crate::core::kind::Kind;

/// A fold: `F_z` is singular. One equation, `g(z, p) = 0`, with `∇g = −∇ₓ(wᵀ F_z v)`.
#[derive(Default)]
pub struct Fold {
    null: NullVectors,
}

impl Condition for Fold {
    fn kind(&self) -> Kind {
        Kind::LP
    }

    fn start(&mut self, mut at: At, _y: &mut [f64]) -> Result<(), EvaluationError> {
        self.null.start(&mut at)
    }

    fn values(
        &mut self,
        mut at: At,
        _y: &[f64],
        values: &mut [f64],
    ) -> Result<(), EvaluationError> {
        self.null.update(&mut at)?;
        values[0] = self.null.g;
        Ok(())
    }

    fn gradients(
        &mut self,
        at: At,
        _y: &[f64],
        rows: &mut [f64],
        _own: &mut [f64],
    ) -> Result<(), EvaluationError> {
        at.system.gradient(at.x, &self.null.left, &self.null.right, at.released, rows);
        rows.iter_mut().for_each(|entry| *entry = -*entry);
        Ok(())
    }

    fn adapt(&mut self) {
        self.null.adapt();
    }
}
