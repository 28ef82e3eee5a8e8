//! Normal forms of special points: a few coefficients that determine the local dynamics.
//!
//! Near a special point the critical deviations `ξ` are reduced to a center manifold. For
//! equilibria, the reduction to a center manifold gives Kuznetsov's coefficients (Yu. A. Kuznetsov,
//! *Elements of Applied Bifurcation Theory*, 3rd ed. 2004, chapters 5 and 8). For periodic orbits,
//! Lyapunov–Schmidt reduction of the discretised equations gives the periodic normal forms of
//! Kuznetsov, Govaerts, Doedel and Dhooge (*SIAM J. Numer. Anal.* 43:1407, 2005). The same
//! multilinear forms apply to both discretisations, to all types of orbits (forced, autonomous and
//! hybrid), and to cycles of maps.
//!
//! Notation: `L(σ)` is the linearisation for deviations that change like `e^{σt}` (deviations of
//! orbits change by the factor `e^σ` in a period). At the critical exponent `σ₀`, `L(σ₀) q = 0` and
//! `p* L(σ₀) = 0`. `B = F_zz` and `C = F_zzz`. With `N = p* L'(σ₀) q`, the rate of `ξ` is `−1/N`
//! times the projection by `p*` of the higher-order terms. For an equilibrium `L(σ) = F_z − σ M` and
//! `N = −⟨p, M q⟩` with the mass matrix `M`, which is the identity matrix for most flows.
//!
//! A mass matrix `M(z)` also contributes to the higher-order terms: derivatives of `F(z) − M(z) z'`
//! replace derivatives of `F`, and a deviation `w` that changes like `e^{σt}` has the rate `σ w`. In
//! `⟨q, q⟩`, unknowns whose rates do not occur are left out, so that an algebraic equation that
//! defines a further unknown does not change the coefficients.

mod codimension_two;
mod crossing;
mod doubled;
mod doubling;
mod eigenvalue;
mod fold;
mod forms;
mod manifold;
mod mode_interactions;
mod pair;
mod polynomials;
mod sides;
mod strong_resonances;

pub(super) use codimension_two::{bautin, bogdanov_takens, chenciner, cusp, generalised_doubling};
pub(super) use crossing::crossing;
pub(crate) use doubled::{DoubledOrbit, doubled_beside};
pub(super) use doubling::{doubling, doubling_rate};
pub(super) use fold::fold;
pub(super) use mode_interactions::{
    double_hopf, double_torus, flip_torus, fold_flip, fold_hopf, fold_torus,
};
pub(super) use pair::{hopf, pair_rate, torus};
pub(crate) use sides::{ComputeDivision, Division};
pub(super) use sides::{of_crossings, of_doublings, of_folds, of_pairs};
pub(super) use strong_resonances::{one_to_four, one_to_one, one_to_three, one_to_two};

use super::at::At;
use crate::core::failure::Failure;
use crate::core::problem::Dynamics;

/// The coefficients of a normal form, and the type of bifurcation that their signs determine, such
/// as `supercritical`.
#[derive(Debug, Default)]
pub(crate) struct NormalForm {
    pub coefficients: Vec<(&'static str, f64)>,
    pub case: Option<Case>,
}

/// The type of a bifurcation, such as `supercritical`, determined by the signs of some coefficients
/// of its normal form.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Case {
    /// The standard name of the type, such as `supercritical`.
    pub word: &'static str,
    /// The names of the coefficients whose signs determine the type.
    pub decided_by: &'static [&'static str],
}

/// The names of the normal-form coefficients that the command line does not print.
pub(crate) const DETAILS: [&str; 29] = [
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
    "ph_p11",
    "ph_p12",
    "ph_p21",
    "ph_p22",
    "lppd_a20",
    "lppd_a02",
    "lppd_b11",
    "lpns_a20",
    "lpns_a02",
    "lpns_b11",
    "pdns_p11",
    "pdns_p12",
    "pdns_p21",
    "pdns_p22",
    "nsns_p11",
    "nsns_p12",
    "nsns_p21",
    "nsns_p22",
];

impl NormalForm {
    /// Creates a normal form from its coefficients, without determining the type of the
    /// bifurcation.
    fn of<const N: usize>(coefficients: [(&'static str, f64); N]) -> Self {
        NormalForm { coefficients: coefficients.into(), case: None }
    }

    /// Sets the case.
    fn decided(self, word: &'static str, by: &'static [&'static str]) -> Self {
        NormalForm { case: Some(Case { word, decided_by: by }), ..self }
    }

    /// Adds further coefficients.
    fn and(mut self, further: impl IntoIterator<Item = (&'static str, f64)>) -> Self {
        self.coefficients.extend(further);
        self
    }

    /// Replaces the list of coefficients whose signs determine the type.
    fn decided_by(mut self, by: &'static [&'static str]) -> Self {
        self.case = self.case.map(|case| Case { decided_by: by, ..case });
        self
    }
}

/// A function that computes the normal form at a special point. On branches of solutions, the first
/// released parameter is the unfolding parameter. The normal form is empty if the equations do not
/// define rates of change.
///
/// # Errors
/// [`Failure`] if a coefficient is undefined, as at a strong resonance.
pub(crate) type ComputeNormalForm = fn(&mut At) -> Result<NormalForm, Failure>;

/// Whether the equations define rates of change. The equilibrium equations of potentials and of
/// second-order motion do not define rates of change, because they do not contain the mass.
fn has_rates(at: &At) -> bool {
    at.system.dynamics().is_flow() || at.system.dynamics() == Dynamics::Periodic
}

/// A function that computes the real part of the cubic coefficient of a normal form; its sign
/// distinguishes supercritical from subcritical bifurcations.
///
/// # Errors
/// The same errors as for [`ComputeNormalForm`].
pub(crate) type ComputeRate = fn(&mut At) -> Result<Rate, Failure>;

/// The real part of the cubic coefficient of a normal form.
pub(crate) struct Rate {
    pub value: f64,
    /// The sum of the sizes of the terms whose sum is the value.
    pub size: f64,
}

impl Rate {
    /// Whether the value is larger than its rounding errors.
    pub fn has_sign(&self) -> bool {
        self.value.abs() > DEGENERATE * self.size
    }
}

/// Rounding: a cubic coefficient counts as zero if it is smaller than this threshold relative to
/// the terms whose sum it is.
const DEGENERATE: f64 = 1e-9;

/// Returns the type of a bifurcation from the sign of the coefficient `c` in `ξ' = … + c ξ |ξ|²`:
/// if `c < 0`, the emanating solutions are attracting on the center manifold.
fn criticality(
    (name, c): (&'static [&'static str; 1], f64),
    size: f64,
    [supercritical, subcritical]: [&'static str; 2],
) -> Option<Case> {
    let word = if c < 0.0 { supercritical } else { subcritical };
    Rate { value: c, size }.has_sign().then_some(Case { word, decided_by: name })
}
