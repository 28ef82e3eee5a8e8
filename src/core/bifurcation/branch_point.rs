//! Branch points: where two branches cross, as a condition.

use super::condition::{At, Condition};
use super::null::NullVectors;
use crate::core::failure::Failure;
use crate::core::linalg::Form;
use crate::core::system::{Functional, Kind};

impl Kind {
    /// `BP`: a branch point.
    pub const BP: Kind = Kind::new("BP", "branch point");
}

/// A branch point: `J = [F_z  F_p]` has rank `n − 1`.
///
/// With an unknown `β` of its own that unfolds the problem, `F + β b = 0`, and the bordered matrix
///
/// ```text
///     M = ⎡ J  b ⎤        M ⎡ ζᵢ ⎤ = eₙ₊ᵢ,       Mᵀ (w, g₁, g₂) = e_last
///         ⎣ C  0 ⎦          ⎣ hᵢ ⎦
/// ```
///
/// with two rows `C`, the branch point is `F + β b = 0, g₁ = g₂ = 0`, and `∇gᵢ = −∇ₓ(wᵀ F_x ζᵢ)`:
/// two equations and one unknown of its own, so it can be held along a curve like any other
/// condition (where the branch point persists, as pitchforks of symmetric problems do, `β` stays
/// zero).
pub struct BranchPoint(NullVectors);

impl BranchPoint {
    /// A branch point of a branch along which this parameter varies.
    pub fn new(parameter: usize) -> Self {
        BranchPoint(NullVectors::of(Form::Jacobian, Some(parameter)))
    }
}

impl Condition for BranchPoint {
    fn kind(&self) -> Kind {
        Kind::BP
    }

    fn assembles(&self) -> bool {
        true
    }

    fn unknowns(&self) -> usize {
        1
    }

    fn start(&mut self, mut at: At, y: &mut [f64]) -> Result<(), Failure> {
        let count = at.system.names().parameters.len();
        if let Some(p) = self.0.parameter.filter(|p| *p >= count) {
            return Err(Failure::Mismatch(format!(
                "the branch point asks for parameter {p}, counted from 0, of {count}"
            )));
        }
        y[0] = 0.0;
        self.0.start(&mut at, 1)
    }

    fn values(&mut self, mut at: At, _y: &[f64], values: &mut [f64]) -> Result<(), Failure> {
        self.0.update(&mut at)?;
        values.copy_from_slice(&self.0.g);
        Ok(())
    }

    fn gradients(&mut self, at: At, rows: &mut [f64], own: &mut [f64]) -> Result<(), Failure> {
        own.fill(0.0);
        for (row, right) in rows.chunks_exact_mut(at.x.len()).zip(&self.0.right) {
            at.system.gradient(
                at.x,
                Functional::First(&self.0.left[0], right),
                at.released,
                row,
            )?;
            row.iter_mut().for_each(|entry| *entry = -*entry);
        }
        Ok(())
    }

    fn unfolding(&self, _j: usize) -> Option<&[f64]> {
        self.0.borders.first().map(Vec::as_slice)
    }

    fn adapt(&mut self) {
        self.0.adapt();
    }
}
