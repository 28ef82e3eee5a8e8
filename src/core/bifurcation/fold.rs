//! Folds, and period doublings of periodic orbits.

use super::condition::{At, Condition};
use crate::core::failure::Failure;
use crate::core::linalg::Form;
use crate::core::system::{Functional, Kind};

impl Kind {
    /// `LP`: a limit point or fold.
    pub const LP: Kind = Kind::new("LP", "fold");
    /// `PD`: a period doubling of periodic orbits.
    pub const PD: Kind = Kind::new("PD", "period doubling");
}

/// A fold: `F_z` is singular. One equation, `g(z, p) = 0`, with `∇g = −∇ₓ(wᵀ F_z v)`, taken with
/// the sign of the bordered determinant: `g` is the ratio of `det F_z` to that, which may change
/// sign far from any fold.
///
/// A period doubling is the same of the linearisation with antiperiodic boundary conditions,
/// `v(1) = −v(0)`, which differs from `F_z` by a constant.
#[derive(Default)]
pub struct Fold {
    form: Form,
    /// The sign of the bordered determinant.
    sign: f64,
}

impl Fold {
    /// A period doubling of periodic orbits.
    pub fn antiperiodic() -> Self {
        Fold { form: Form::Antiperiodic, sign: 0.0 }
    }
}

impl Condition for Fold {
    fn kind(&self) -> Kind {
        if self.form == Form::Antiperiodic { Kind::PD } else { Kind::LP }
    }

    fn assembles(&self) -> bool {
        true
    }

    fn start(&mut self, At { system, x, null, .. }: At, _y: &mut [f64]) -> Result<(), Failure> {
        null.start(system, x, self.form, None)
    }

    fn values(
        &mut self,
        At { system, x, null, .. }: At,
        _y: &[f64],
        values: &mut [f64],
    ) -> Result<(), Failure> {
        let null = null.of(system, x, self.form, None)?;
        self.sign = null.factors.determinant_sign();
        values[0] = self.sign * null.g[0];
        Ok(())
    }

    fn gradients(
        &mut self,
        At { system, x, released, null, .. }: At,
        rows: &mut [f64],
        _own: &mut [f64],
    ) -> Result<(), Failure> {
        let null = null.of(system, x, self.form, None)?;
        system.gradient(x, Functional::First(&null.left[0], &null.right[0]), released, rows)?;
        rows.iter_mut().for_each(|entry| *entry *= -self.sign);
        Ok(())
    }
}
