//! Branch points, where two branches cross: their defining system and test function.

use super::at::At;
use super::defining_system::DefiningSystem;
use super::null::{NullSpace, NullVectors};
use super::test_function::{Bracketed, PointValues, Reading, TestFunction, nearest_to_zero};
use crate::core::failure::Failure;
use crate::core::linalg::Form;
use crate::core::problem::Dynamics;
use crate::core::system::{Functional, Kind};

impl Kind {
    /// `BP`: a branch point.
    pub const BP: Kind = Kind::new("BP", "branch point");
}

/// The defining system of branch points, where the Jacobian `J = [F_z  F_p]` has rank `n − 1`.
///
/// An auxiliary unknown `β` unfolds the problem, `F + β b = 0`. The bordered matrix `M`, with two
/// rows `C`, defines `ζᵢ`, `w` and `gᵢ`:
///
/// ```text
///     M = ⎡ J  b ⎤        M ⎡ ζᵢ ⎤ = eₙ₊ᵢ,       Mᵀ (w, g₁, g₂) = e_last
///         ⎣ C  0 ⎦          ⎣ hᵢ ⎦
/// ```
///
/// The equations of the branch point are `F + β b = 0` and `g₁ = g₂ = 0`, with `∇gᵢ = −∇ₓ(wᵀ F_x
/// ζᵢ)`. The defining system of branch points adds two equations and one unknown, so it can be held
/// along a curve in one more parameter, like any other defining system. If the branch point
/// persists along a curve, as pitchforks of symmetric problems do, the unfolding unknown `β` stays
/// zero.
pub struct BranchPoint {
    parameter: usize,
}

impl BranchPoint {
    /// Creates the defining system of branch points on branches in the parameter with index
    /// `parameter`.
    pub fn new(parameter: usize) -> Self {
        BranchPoint { parameter }
    }
}

impl DefiningSystem for BranchPoint {
    fn kind(&self) -> Kind {
        Kind::BP
    }

    fn assembles(&self) -> bool {
        true
    }

    fn unknowns(&self) -> usize {
        1
    }

    fn start(&mut self, At { system, x, null, .. }: At, y: &mut [f64]) -> Result<(), Failure> {
        let (p, count) = (self.parameter, system.names().parameters.len());
        if p >= count {
            return Err(Failure::Mismatch(format!(
                "the condition of a branch point refers to the parameter with number {p}, but the \
                 system has only {count} parameters, numbered from 0"
            )));
        }
        y[0] = 0.0;
        null.start(system, x, Form::Jacobian, Some(p))?;
        Ok(())
    }

    fn values(
        &mut self,
        At { system, x, null, .. }: At,
        _y: &[f64],
        values: &mut [f64],
    ) -> Result<(), Failure> {
        values.copy_from_slice(&null.of(system, x, Form::Jacobian, Some(self.parameter))?.g);
        Ok(())
    }

    fn gradients(
        &mut self,
        At { system, x, released, null, .. }: At,
        rows: &mut [f64],
        own: &mut [f64],
    ) -> Result<(), Failure> {
        own.fill(0.0);
        let null = null.of(system, x, Form::Jacobian, Some(self.parameter))?;
        for (row, right) in rows.chunks_exact_mut(x.len()).zip(&null.right) {
            system.gradient(x, Functional::First(&null.left[0], right), released, row)?;
            row.iter_mut().for_each(|entry| *entry = -*entry);
        }
        Ok(())
    }

    fn unfolding<'b>(&self, _j: usize, null: &'b NullSpace) -> Option<&'b NullVectors> {
        null.known(Form::Jacobian, Some(self.parameter))
    }
}

/// The test function of branch points: the sign of the determinant of the Jacobian bordered by the
/// tangent.
pub(crate) struct BorderedDeterminant;

impl TestFunction for BorderedDeterminant {
    fn value(&self, _at: &mut At, known: &PointValues) -> Result<Option<f64>, Failure> {
        Ok(Some(known.determinant))
    }

    fn is_odd(&self) -> bool {
        true
    }

    fn guess(&self, _within: &Bracketed) -> f64 {
        0.5
    }

    /// Returns the real eigenvalue nearest to zero; `None` for periodic orbits, whose unstable
    /// multipliers are counted instead.
    fn smooth(&self, _: &Reading, spectrum: &[(f64, f64)], of: Dynamics) -> Option<f64> {
        let real = spectrum.iter().filter(|l| l.1 == 0.0 && of != Dynamics::Periodic);
        nearest_to_zero(real.map(|l| l.0))
    }

    fn is_spectral(&self) -> bool {
        true
    }
}
