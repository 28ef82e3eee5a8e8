//! Normal forms of branch points.

use super::forms::{Critical, Forms};
use super::{NormalForm, criticality, has_rates};
use crate::core::bifurcation::at::At;
use crate::core::failure::Failure;
use crate::core::linalg::{Form, dot};
use crate::core::system::Deviation;

/// Rounding: a quadratic coefficient counts as zero, as at a pitchfork, if it is smaller than this
/// threshold relative to the terms whose sum it is.
const VANISHES: f64 = 1e-6;

/// Rounding: a quadratic coefficient also counts as zero if it is smaller than this threshold
/// relative to the cubic coefficient for `⟨q, q⟩ = 1`, regardless of the terms whose sum it is.
const ROUNDING: f64 = 1e-9;

/// Computes the two terms `p C(q, q, q)/6` and `p B(q, h)/2` of the cubic coefficient, where `F_z h
/// = −B(q, q)`.
pub(super) fn third(
    forms: &mut Forms,
    Critical { right: q, left: p, .. }: &Critical<Vec<f64>>,
    second: &[f64],
) -> Result<[f64; 2], Failure> {
    let h = forms.solve_within_border(second.iter().map(|b| -b).collect())?;
    Ok([dot(p, &forms.of(&[q, q, q])?) / 6.0, dot(p, &forms.of(&[q, &h])?) / 2.0])
}

/// Whether the sum `p B(q, q)` is zero up to rounding, as at a pitchfork; the sum is compared with
/// its own terms and with the third-order terms. `square` is `⟨q, q⟩`.
pub(super) fn is_rounding((p, second): (&[f64], &[f64]), third: [f64; 2], square: f64) -> bool {
    let terms: f64 = p.iter().zip(second).map(|(p, b)| (p * b).abs()).sum();
    let size = (third[0].abs() + third[1].abs()) / square;
    dot(p, second).abs() <= VANISHES * terms + ROUNDING * size * square.sqrt()
}

/// The normal form of a branch point: `ξ' = b (λ − λ₀) ξ + a ξ²` at a transcritical point, `ξ' = b
/// (λ − λ₀) ξ + c ξ³` at a pitchfork. `ξ` is the deviation from one of the two branches: from the
/// symmetric branch at a pitchfork, from the branch with `b > 0` at a transcritical point. For `t =
/// (s, 1)` with `F_z s = −F_λ`, the coefficients are
///
/// ```text
///     a = −p B(q, q) / (2N),   b = −(p B(q, t) + ξ_λ p B(q, q)) / N,
///     c = −p (C(q, q, q) + 3 B(q, h)) / (6N),   F_z h = −B(q, q),
/// ```
///
/// where `t + ξ_λ q` is the tangent of the branch from which `ξ` deviates, and `⟨q, q⟩ = 1`. At a
/// pitchfork, `λ − λ₀ = −(c/b) ξ² + …` along the branch that crosses the symmetric branch; the
/// coefficient of `ξ²` is recorded as `branch_curvature`. Rates are per time; for equations that
/// describe no motion, only the curvature is meaningful.
pub(in crate::core::bifurcation) fn crossing(at: &mut At) -> Result<NormalForm, Failure> {
    let mut forms = Forms::new(at);
    let critical = forms.real(Form::Jacobian)?;
    let (q, p) = (&critical.right, &critical.left);
    let second = forms.of(&[q, q])?;
    let Some(along) = forms.along_crossing()? else { return Ok(NormalForm::default()) };
    let [quadratic, mixed] = [dot(p, &second), dot(p, &forms.of(&[q, &along])?)];
    let Deviation { square, period, .. } = forms.deviation(&[q], 0.0)?;
    let moves = has_rates(forms.at) && critical.growth != 0.0;
    let rate = -1.0 / (critical.growth * period);
    let sum = third(&mut forms, &critical, &second)?;
    let (cubic, size) = ((sum[0] + sum[1]) / square, (sum[0].abs() + sum[1].abs()) / square);
    if !is_rounding((p, &second), sum, square) {
        let last = dot(p, &forms.of(&[&along, &along])?);
        let slope = (mixed * mixed - quadratic * last).max(0.0).sqrt() * rate.abs();
        let a = 0.5 * rate * quadratic / square.sqrt();
        let coefficients = vec![("transcritical_a", a.abs()), ("growth_slope", slope)];
        return Ok(match moves {
            true => NormalForm { coefficients, case: None }
                .decided("transcritical", &["transcritical_a"]),
            false => NormalForm::default().decided("transcritical", &[]),
        });
    }
    let mut coefficients = vec![("branch_curvature", -cubic / mixed)];
    if !moves {
        return Ok(NormalForm { coefficients, case: None }.decided("pitchfork", &[]));
    }
    let c = rate * cubic;
    coefficients.extend([("pitchfork_c", c), ("growth_slope", rate * mixed)]);
    let words = ["supercritical pitchfork", "subcritical pitchfork"];
    let case = criticality((&["pitchfork_c"], c), rate.abs() * size, words);
    Ok(NormalForm { coefficients, case })
}
