//! Normal forms of special points: what happens there, by a few coefficients.
//!
//! Near a special point the critical deviations `ξ` are reduced to a center manifold. For
//! equilibria that gives Kuznetsov's coefficients (Yu. A. Kuznetsov, *Elements of Applied
//! Bifurcation Theory*, 3rd ed. 2004, chapters 5 and 8). For periodic orbits it gives the
//! periodic normal forms of Kuznetsov, Govaerts, Doedel and Dhooge (*SIAM J. Numer. Anal.* 43:1407,
//! 2005), by Lyapunov–Schmidt reduction of the discretised equations: the same multilinear forms
//! serve both discretisations, forced, autonomous and hybrid orbits, and cycles of maps.
//!
//! Notation: `L(σ)` is the linearisation for deviations that change like `e^{σt}` (by the factor
//! `e^σ` in a period), `L(σ₀) q = 0` and `p* L(σ₀) = 0` at the critical exponent `σ₀`;
//! `B = F_zz`, `C = F_zzz`. With `N = p* L'(σ₀) q` the rate of `ξ` is `−1/N` times the projection
//! by `p*` of the terms of higher order. For an equilibrium `L(σ) = F_z − σ` and `N = −⟨p, q⟩`.

mod codimension_two;
mod crossing;
mod doubling;
mod fold;
mod forms;
mod manifold;
mod pair;

pub(crate) use codimension_two::hopf_beside;
pub(super) use codimension_two::{bautin, bogdanov_takens, cusp, double_hopf, fold_hopf};
pub(super) use crossing::crossing;
pub(super) use doubling::{doubling, doubling_rate};
pub(super) use fold::fold;
pub(super) use pair::{hopf, pair_rate, torus};

use super::at::At;
use crate::core::failure::Failure;
use crate::core::problem::Dynamics;

/// The coefficients of a normal form, and the case that they decide.
#[derive(Debug, Default)]
pub(crate) struct NormalForm {
    pub coefficients: Vec<(&'static str, f64)>,
    pub case: Option<Case>,
}

/// What the field calls a point, by the signs of some coefficients.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Case {
    /// `supercritical`.
    pub word: &'static str,
    /// The names of the coefficients that decide.
    pub decided_by: &'static [&'static str],
}

/// The coefficients that lines on a screen leave out.
pub(crate) const DETAILS: [&str; 11] = [
    "c1_re",
    "c1_im",
    "c2_re",
    "c2_im",
    "torus_d_im",
    "growth_slope",
    "branch_curvature",
    "hh_p11",
    "hh_p12",
    "hh_p21",
    "hh_p22",
];

impl NormalForm {
    /// Coefficients that decide no case.
    fn of<const N: usize>(coefficients: [(&'static str, f64); N]) -> Self {
        NormalForm { coefficients: coefficients.into(), case: None }
    }

    /// The same, with a case.
    fn decided(self, word: &'static str, by: &'static [&'static str]) -> Self {
        NormalForm { case: Some(Case { word, decided_by: by }), ..self }
    }
}

/// The normal form at a special point; on branches of solutions in the first released parameter.
/// Empty where no rates are known.
///
/// # Errors
/// [`Failure`] where a coefficient is not defined, as at a strong resonance.
pub(crate) type ComputeNormalForm = fn(&mut At) -> Result<NormalForm, Failure>;

/// Whether the equations tell rates: those of potentials and of motion of second order leave out the
/// mass.
fn has_rates(at: &At) -> bool {
    matches!(at.system.dynamics(), Dynamics::Flow | Dynamics::Periodic)
}

/// The real part of the cubic coefficient of a normal form, whose sign decides its case.
///
/// # Errors
/// As for [`ComputeNormalForm`].
pub(crate) type ComputeRate = fn(&mut At) -> Result<f64, Failure>;

/// (R) A cubic coefficient this small, compared with the terms of which it is the sum, is rounding.
const DEGENERATE: f64 = 1e-9;

/// The case that the sign of the rate `c` decides, where `ξ' = … + c ξ |ξ|²`: solutions that
/// emanate attract on the center manifold if `c < 0`.
fn criticality(
    (name, c): (&'static [&'static str; 1], f64),
    size: f64,
    [supercritical, subcritical]: [&'static str; 2],
) -> Option<Case> {
    let word = if c < 0.0 { supercritical } else { subcritical };
    (c.abs() > DEGENERATE * size).then_some(Case { word, decided_by: name })
}
