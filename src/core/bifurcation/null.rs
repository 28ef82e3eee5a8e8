//! Null vectors of `F_z` by bordering.

use crate::core::condition::{At, Failure};
use crate::core::linear::Factors;
use crate::core::vector::{generic, normalise};
use crate::core::zero::{Border, Form, System};

/// The right and left null vectors of `F_z`, as a bordered system defines them near a fold:
///
/// ```text
///     ⎡ F_z  b ⎤⎡ v ⎤   ⎡ 0 ⎤        ⎡ F_zᵀ c ⎤⎡ w ⎤   ⎡ 0 ⎤
///     ⎣ cᵀ   0 ⎦⎣ g ⎦ = ⎣ 1 ⎦        ⎣ bᵀ   0 ⎦⎣ g ⎦ = ⎣ 1 ⎦
/// ```
///
/// `g = −wᵀ F_z v` vanishes exactly where `F_z` is singular. `F_z` may be that with antiperiodic boundary
/// conditions.
pub(super) struct NullVectors {
    /// The right null vector, extended by zeros in the parameters: as long as `x`.
    pub right: Vec<f64>,
    /// The left null vector.
    pub left: Vec<f64>,
    /// The multiplier.
    pub g: f64,
    /// The linearisation: `F_z`, or that of antiperiodic boundary conditions.
    pub form: Form,
    pub factors: Factors,
    column: Vec<f64>,
    row: Vec<f64>,
    work: Vec<f64>,
}

impl NullVectors {
    /// Those of a form.
    pub fn of(form: Form) -> Self {
        let [right, left, column, row, work] = Default::default();
        NullVectors { right, left, g: 0.0, form, factors: Factors::default(), column, row, work }
    }

    /// Chooses borders near the null vectors at a point.
    pub fn start(&mut self, at: &mut At) -> Result<(), Failure> {
        let n = at.system.names().dimension();
        self.column = generic(n, 1);
        self.row = generic(n, 2);
        self.left.resize(n, 0.0);
        self.right = vec![0.0; at.x.len()];
        self.work.resize(n + 1, 0.0);
        at.system.assemble(at.x)?;
        for _ in 0..3 {
            self.solve(at.system)?;
            self.adapt();
        }
        Ok(())
    }

    /// Computes the null vectors at a point.
    pub fn update(&mut self, at: &mut At) -> Result<(), Failure> {
        at.system.assemble(at.x)?;
        self.solve(at.system)
    }

    /// Turns the borders to the null vectors.
    pub fn adapt(&mut self) {
        let n = self.left.len();
        self.column.copy_from_slice(&self.left);
        self.row.copy_from_slice(&self.right[..n]);
        normalise(&mut self.column);
        normalise(&mut self.row);
    }

    fn solve(&mut self, system: &mut dyn System) -> Result<(), Failure> {
        let n = self.left.len();
        let border = Border { width: 1, columns: &self.column, rows: &self.row, corner: &[0.0] };
        system.factor(self.form, border, &mut self.factors)?;
        self.work.fill(0.0);
        self.work[n] = 1.0;
        self.factors.solve(&mut self.work);
        self.right[..n].copy_from_slice(&self.work[..n]);
        self.g = self.work[n];
        self.work.fill(0.0);
        self.work[n] = 1.0;
        self.factors.solve_transposed(&mut self.work);
        self.left.copy_from_slice(&self.work[..n]);
        Ok(())
    }
}
