//! The first doubled orbits near a generalised period doubling or a resonance 1:2, where curves of
//! folds or torus points of doubled orbits begin.

use super::forms::Forms;
use crate::core::bifurcation::at::At;
use crate::core::failure::Failure;
use crate::core::linalg::{Form, dot};
use crate::core::system::Kind;

/// Heuristic: the largest ratio of second-order to first-order terms in the expansion of the first
/// doubled orbit.
const NONLINEAR: f64 = 0.1;

/// Heuristic: the largest angle of the critical multipliers of the first doubled orbit.
const WIDEST: f64 = 0.3;

/// Rounding: a cubic coefficient counts as zero if it is smaller than this threshold relative to
/// the terms whose sum it is.
const VANISHES: f64 = 1e-7;

/// The first doubled orbit of a curve, near the periodic orbit traversed twice.
pub(crate) struct DoubledOrbit {
    /// The deviation of the doubled orbit from the periodic orbit traversed twice, given as a
    /// direction of `x`. The parameters change only to second order in this deviation.
    pub deviation: Vec<f64>,
    /// The angle of the critical multipliers if the curve consists of torus points.
    pub angle: Option<f64>,
}

/// Computes the deviation `ε q` of doubled orbits from the orbit at a generalised period doubling
/// or a resonance 1:2; `at` is the orbit at that point, traversed twice. At that point, `F_z` is
/// singular with `F_z q = 0`, and doubled orbits satisfy
///
/// ```text
///     z = z₀ + ε q + O(ε²),    F_z h = −B(q, q),    κ = p (C(q, q, q) + 3 B(q, h))/6
/// ```
///
/// At a resonance 1:2, doubled torus points have the multipliers `e^{±iω}` with `p L' q₁ (iω)² + 2
/// κ ε² = 0` and `F_z q₁ = −L' q`. The amplitude `ε` is a fraction of the size of the orbit, and is
/// reduced if nonlinear terms or the angle `ω` are large.
///
/// # Errors
/// [`Failure::Mismatch`] if no torus points of doubled orbits exist near the resonance.
pub(crate) fn doubled_beside(at: &mut At, kind: Kind, part: f64) -> Result<DoubledOrbit, Failure> {
    let mut forms = Forms::new(at);
    let critical = forms.real(Form::Jacobian)?;
    let (q, p) = (&critical.right, &critical.left);
    let second = forms.of(&[q, q])?;
    let h = forms.solve_within_border(second.into_iter().map(|b| -b).collect())?;
    let mut orbit = forms.at.x[..forms.n].to_vec();
    orbit.resize(q.len(), 0.0);
    let mut size = |d: &Vec<f64>| Ok::<f64, Failure>(forms.deviation(&[d], 0.0)?.square.sqrt());
    let [of_orbit, of_q, of_h] = [size(&orbit)?, size(q)?, size(&h)?];
    let largest = if of_orbit > 0.0 { of_orbit } else { 1.0 };
    let mut amplitude = (part * largest / of_q).min(2.0 * NONLINEAR * of_q / of_h);
    let mut angle = None;
    if kind == Kind::R2 {
        let terms = [dot(p, &forms.of(&[q, q, q])?) / 6.0, dot(p, &forms.of(&[q, &h])?) / 2.0];
        let growth = forms.growth(q)?;
        let next = forms.solve_within_border(growth.into_iter().map(|f| -f).collect())?;
        let splitting = dot(p, &forms.growth(&next)?);
        let square = 2.0 * (terms[0] + terms[1]) / splitting;
        let rounding = VANISHES * (terms[0].abs() + terms[1].abs()) / splitting.abs();
        if square.is_nan() || square <= rounding {
            return Err(Failure::Mismatch(
                "no curve of torus points of doubled orbits begins at this 1:2 resonance: the \
                 normal-form coefficient `r2_a` is not negative"
                    .into(),
            ));
        }
        amplitude = amplitude.min(WIDEST / square.sqrt());
        angle = Some(amplitude * square.sqrt());
    }
    let deviation = q.iter().map(|q| amplitude * q).collect();
    Ok(DoubledOrbit { deviation, angle })
}
