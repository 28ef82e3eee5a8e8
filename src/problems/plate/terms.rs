//! Settings that several models of a plate share: the theory and the projection.

use serde::{Deserialize, Serialize};

/// The theory of the plate, which determines the terms of the strains that the model includes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Theory {
    /// Linear theory: the plate has only bending strains, and the gap ratio `α₁` has no influence.
    Linear,
    /// Von Kármán's theory: bending and stretching of the mid-plane, with `e₁ = u_x + ½w_x²` and
    /// analogous strains (eq. 2.6).
    #[default]
    VonKarman,
}

/// The projection of the equation of motion onto the basis functions of a reduced-order model.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Projection {
    /// Galerkin's method without a multiplier; the load `λ⟨φ/(1−w)²⟩` is computed by Gauss
    /// quadrature. The residual of the direct projection is the gradient of the potential energy.
    #[default]
    Direct,
    /// The equation is multiplied by `(1−w)²` before the projection, eq. 3.26: this is the method
    /// of Zhao's dissertation, in which the load is `λ⟨φ⟩`. With more and more functions, the
    /// multiplied projection converges to the same solution as the direct projection, but far more
    /// slowly. The residual of the multiplied projection is not a gradient, and its inertia depends
    /// on the deflection; the stability of an equilibrium follows from the monitor `frequency`,
    /// which is negative for an unstable equilibrium.
    Multiplied,
}

impl Projection {
    /// Returns the type of dynamics that the residual of this projection describes.
    pub(super) fn dynamics(self) -> crate::core::problem::Dynamics {
        match self {
            Projection::Direct => crate::core::problem::Dynamics::Potential,
            // The residual is nearly (1 − w)² times a gradient, and its eigenvalues have the same
            // signs.
            Projection::Multiplied => crate::core::problem::Dynamics::SecondOrder,
        }
    }
}
