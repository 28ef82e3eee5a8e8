//! Words that the models of a plate share: which theory, which projection.

use serde::{Deserialize, Serialize};

/// Which terms of the strains count.
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

/// How the equation of motion is projected on the functions of a reduced-order model.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Projection {
    /// As it stands: Galerkin's method, the load `λ⟨φ/(1−w)²⟩` by Gauss quadrature. The residual is
    /// the gradient of the potential energy.
    #[default]
    Direct,
    /// After multiplication by `(1−w)²`, eq. 3.26: the source's method, in which the load is
    /// `λ⟨φ⟩`. The same limit, reached far more slowly. The residual is no gradient, and the
    /// inertia depends on the deflection: stability is left to the monitor `frequency`, negative
    /// where the equilibrium is unstable.
    Multiplied,
}

impl Projection {
    /// The dynamics that the residual of this projection describes.
    pub(super) fn dynamics(self) -> crate::core::problem::Dynamics {
        match self {
            Projection::Direct => crate::core::problem::Dynamics::Potential,
            // Nearly (1 − w)² times a gradient: its eigenvalues have the signs of the gradient's.
            Projection::Multiplied => crate::core::problem::Dynamics::SecondOrder,
        }
    }
}
