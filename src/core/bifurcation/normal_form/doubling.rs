//! Normal forms of period doublings.

use super::forms::{Critical, Forms};
use super::{NormalForm, Rate, criticality};
use crate::core::bifurcation::at::At;
use crate::core::failure::Failure;
use crate::core::linalg::{Form, dot};
use crate::core::system::Deviation;
use std::f64::consts::PI;

/// The normal form of a period doubling: `dξ/dt = α (λ − λ₀) ξ + c ξ³` with `∫₀ᵀ⟨q, q⟩ dt = 1`.
/// In the unknowns of two periods, the deviation `q` (with the multiplier −1) changes sign from one
/// period to the next, and the deviation `h` (with the multiplier 1) does not. The coefficients are
///
/// ```text
///     c = −p (C(q, q, q) + 3 B(q, h)) / (6 N T),    L(0) h = −B(q, q),    α = −p B(q, z_λ) / (N T)
/// ```
///
/// where `B(q, z_λ)` includes derivatives with respect to the parameter. Along the branch of doubled
/// orbits, `z = z₀ + ξ q + …` and `λ − λ₀ = −(c/α) ξ² + …`. For maps, `T = 1`, and the mean of `⟨q,
/// q⟩` over the cycle is 1.
pub(in crate::core::bifurcation) fn doubling(at: &mut At) -> Result<NormalForm, Failure> {
    let Doubling { cubic, size, critical, per_time } = reduced(at)?;
    let mut coefficients = vec![("doubling_c", cubic)];
    let mut forms = Forms::new(at);
    if let Some(along) = forms.along_branch()? {
        let slope = per_time * dot(&critical.left, &forms.of(&[&critical.right, &along])?);
        coefficients.push(("growth_slope", slope));
    }
    let case = criticality((&["doubling_c"], cubic), size, ["supercritical", "subcritical"]);
    Ok(NormalForm { coefficients, case })
}

/// Computes only the cubic coefficient `c` of the normal form of a period doubling.
pub(in crate::core::bifurcation) fn doubling_rate(at: &mut At) -> Result<Rate, Failure> {
    let Doubling { cubic, size, .. } = reduced(at)?;
    Ok(Rate { value: cubic, size })
}

/// The third-order terms of the expansion of doubled orbits.
struct Doubling {
    critical: Critical<Vec<f64>>,
    cubic: f64,
    /// The sum of the sizes of the terms of `cubic`.
    size: f64,
    /// The factor that converts coefficients to rates per time.
    per_time: f64,
}

fn reduced(at: &mut At) -> Result<Doubling, Failure> {
    let mut forms = Forms::new(at);
    let critical = forms.real(Form::Antiperiodic)?;
    let q = &critical.right;
    let second = forms.of(&[q, q])?;
    let h = forms.solve(second.into_iter().map(|b| -b).collect())?;
    let Deviation { square, period, .. } = forms.deviation(&[q], PI)?;
    let per_time = -1.0 / (critical.growth * period);
    let terms = [
        dot(&critical.left, &forms.of(&[q, q, q])?) / 6.0,
        dot(&critical.left, &forms.of(&[q, &h])?) / 2.0,
    ];
    let [third, second] = terms.map(|term| per_time * term / square);
    Ok(Doubling { critical, cubic: third + second, size: third.abs() + second.abs(), per_time })
}
