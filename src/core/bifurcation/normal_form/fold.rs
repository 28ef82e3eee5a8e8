//! Normal forms of folds.

use super::forms::{Forms, leading};
use super::{NormalForm, has_rates};
use crate::core::bifurcation::at::At;
use crate::core::failure::Failure;
use crate::core::linalg::{Form, dot};
use crate::core::problem::Dynamics;
use crate::core::system::Deviation;

/// The normal form of a fold: `u' = β + a u²` on the center manifold of an equilibrium, `a = ½ ⟨p,
/// B(q, q)⟩` with `⟨q, q⟩ = ⟨p, q⟩ = 1`. The sign of `a` refers to the `q` whose largest component
/// is positive.
///
/// The normal form of a fold of cycles with a free period is `dτ/dt = 1 − ξ + …`, `dξ/dt = β + b
/// ξ²`. The normal form of a fold of forced cycles, of hybrid cycles with a fixed period, or of
/// maps is `dξ/dt = β + a ξ²` with `∫₀ᵀ⟨q, q⟩ dt = 1`, where `a > 0`, since `q` may be replaced by
/// `−q`.
pub(in crate::core::bifurcation) fn fold(at: &mut At) -> Result<NormalForm, Failure> {
    if !has_rates(at) {
        return Ok(NormalForm::default());
    }
    let mut forms = Forms::new(at);
    let critical = forms.real(Form::Jacobian)?;
    let q = &critical.right;
    let second = forms.of(&[q, q])?;
    let rate = -0.5 * dot(&critical.left, &second) / critical.growth;
    let deviation = forms.deviation(&[q], 0.0)?;
    let Deviation { square, period, .. } = deviation;
    let coefficient = if let Some(lengthening) = deviation.changes_period() {
        ("fold_b", rate / lengthening)
    } else if forms.at.system.dynamics() == Dynamics::Periodic {
        ("fold_a", rate.abs() / (period * square.sqrt()))
    } else {
        ("fold_a", rate / square.sqrt() * leading(&q[..forms.n]).signum())
    };
    Ok(NormalForm { coefficients: vec![coefficient], case: None })
}
