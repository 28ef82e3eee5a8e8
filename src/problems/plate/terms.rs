//! Choices common to the models of a plate: the theory and the projection.

use serde::{Deserialize, Serialize};

/// The terms of the strains to include.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Theory {
    /// Bending only; `α₁` has no influence.
    Linear,
    /// Bending and stretching of the mid-plane, `e₁ = u_x + ½w_x²` and so on (eq. 2.6).
    #[default]
    VonKarman,
}

/// The projection of the equation of motion on the functions of a reduced-order model.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Projection {
    /// Galerkin's method without a multiplier, with the load `λ⟨φ/(1−w)²⟩` by Gauss quadrature. The
    /// residual is the gradient of the potential energy.
    #[default]
    Direct,
    /// Multiplication by `(1−w)²` before the projection, eq. 3.26: the method of the dissertation,
    /// in which the load is `λ⟨φ⟩`. It converges to the same limit, but far more slowly. The
    /// residual is not a gradient, and the inertia depends on the deflection: stability is given by
    /// the monitor `frequency`, negative for an unstable equilibrium.
    Multiplied,
}

impl Projection {
    /// Returns the dynamics that the residual of this projection describes.
    pub(super) fn dynamics(self) -> crate::core::problem::Dynamics {
        match self {
            Projection::Direct => crate::core::problem::Dynamics::Potential,
            // The residual is nearly (1 − w)² times a gradient, and its eigenvalues have the same
            // signs.
            Projection::Multiplied => crate::core::problem::Dynamics::SecondOrder,
        }
    }
}
