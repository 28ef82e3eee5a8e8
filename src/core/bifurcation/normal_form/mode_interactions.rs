//! Normal forms of codimension-two points with two different critical eigenvalues or multipliers.

use super::NormalForm;
use super::eigenvalue::Eigenvalue;
use super::forms::Forms;
use super::manifold::{Motion, motion};
use crate::core::bifurcation::at::At;
use crate::core::bifurcation::fold::DOUBLE_ROOT;
use crate::core::failure::Failure;
use crate::core::linalg::{Form, generic, norm};
use crate::core::problem::Dynamics;
use faer::c64;

/// Computes the motion on the center manifold of two eigenvalues, and whether the sign of the
/// critical vector of the first eigenvalue is arbitrary.
fn reduced(at: &mut At, [first, second]: [Form; 2]) -> Result<(Motion, bool), Failure> {
    let mut forms = Forms::new(at);
    let mut both =
        [Eigenvalue::simple(&mut forms, first)?, Eigenvalue::simple(&mut forms, second)?];
    let motion = motion(&mut forms, &mut both, 3)?;
    let periodic = forms.at.system.dynamics() == Dynamics::Periodic;
    Ok((motion, periodic && !both[0].by_period))
}

/// The normal form of a fold–Hopf point:
///
/// ```text
///     v' = G₂₀₀/2 v² + G₀₁₁ |z|² + G₃₀₀/6 v³ + G₁₁₁ v |z|²,
///     z' = iω z + G₁₁₀ v z + G₂₁₀/2 v² z + G₀₂₁/2 z |z|²,
/// ```
///
/// The numbers that determine the unfolding of the fold–Hopf point are (Kuznetsov, section 8.5): `s
/// = sign G₂₀₀ G₀₁₁`, `θ = 2 Re G₁₁₀/G₂₀₀`, `E = ½ Re (G₂₁₀ + G₁₁₀ (Re G₀₂₁/G₀₁₁ − G₃₀₀/G₂₀₀ +
/// G₁₁₁/G₀₁₁) − G₀₂₁ G₂₀₀/(2 G₀₁₁))`.
///
/// At a pitchfork–Hopf point, where a symmetry `v → −v` excludes all terms of second order, the
/// amplitude equations are the same as for a double Hopf point, with `v` in place of `|z₁|`: `p₁₁ =
/// G₃₀₀/6`, `p₁₂ = G₁₁₁`, `p₂₁ = Re G₂₁₀/2`, `p₂₂ = Re G₀₂₁/2`.
pub(in crate::core::bifurcation) fn fold_hopf(at: &mut At) -> Result<NormalForm, Failure> {
    let Some(&omega) = at.held.first() else { return Ok(NormalForm::default()) };
    let (motion, _) = reduced(at, [Form::Jacobian, Form::Oscillation(omega)])?;
    let interaction = beside_pair(&motion);
    if interaction.is_symmetric(omega, uncertainty(at)?) {
        return Ok(interaction.pitchfork());
    }
    let form = interaction.normal_form(["zh_s", "zh_theta", "zh_e"]);
    Ok(form.decided_by(&["zh_s", "zh_theta"]))
}

/// The normal form of a fold–torus point of periodic orbits:
///
/// ```text
///     dv/dt = a₂₀ v² + a₀₂ |z|² + a₃₀ v³ + a₁₂ v |z|²,     d|z|/dt = b₁₁ v |z| + b₂₁ v² |z| + b₀₃ |z|³,
/// ```
///
/// The critical vectors are normalised by `∫₀ᵀ⟨q, q⟩ dt = 1`. If the period is free,
/// `dτ/dt = 1 − v + …`; if the period is fixed, `a₂₀ > 0`. The numbers `s = sign a₂₀ a₀₂`,
/// `θ = b₁₁/a₂₀` and `E` correspond to `s`, `θ` and `E` of a fold–Hopf point.
pub(in crate::core::bifurcation) fn fold_torus(at: &mut At) -> Result<NormalForm, Failure> {
    let Some(&angle) = at.held.first() else { return Ok(NormalForm::default()) };
    let (motion, any_sign) = reduced(at, [Form::Jacobian, Form::Oscillation(angle)])?;
    let interaction = beside_pair(&motion);
    let form = interaction.normal_form(["lpns_s", "lpns_theta", "lpns_e"]);
    let names = &["lpns_a20", "lpns_a02", "lpns_b11"];
    Ok(form.and(interaction.quadratic(names, any_sign)).decided_by(names))
}

/// The normal form of a fold–flip point of periodic orbits. The equations are the same as for a
/// fold–torus point, with a real amplitude `y` in place of the complex `z`. Torus points of doubled
/// orbits exist near the fold–flip point if `s θ < 0`.
pub(in crate::core::bifurcation) fn fold_flip(at: &mut At) -> Result<NormalForm, Failure> {
    let (motion, any_sign) = reduced(at, [Form::Jacobian, Form::Antiperiodic])?;
    let interaction = FoldInteraction {
        a20: motion.of(0, &[2, 0]).re,
        a02: motion.of(0, &[0, 2]).re,
        a30: motion.of(0, &[3, 0]).re,
        a12: motion.of(0, &[1, 2]).re,
        b11: motion.of(1, &[1, 1]),
        b21: motion.of(1, &[2, 1]),
        b03: motion.of(1, &[0, 3]),
    };
    let form = interaction.normal_form(["lppd_s", "lppd_theta", "lppd_e"]);
    let names = &["lppd_a20", "lppd_a02", "lppd_b11"];
    Ok(form.and(interaction.quadratic(names, any_sign)).decided_by(names))
}

/// The coefficients of the interaction of a fold with a critical complex pair.
fn beside_pair(motion: &Motion) -> FoldInteraction {
    FoldInteraction {
        a20: motion.of(0, &[2, 0, 0]).re,
        a02: motion.of(0, &[0, 1, 1]).re,
        a30: motion.of(0, &[3, 0, 0]).re,
        a12: motion.of(0, &[1, 1, 1]).re,
        b11: motion.of(1, &[1, 1, 0]),
        b21: motion.of(1, &[2, 1, 0]),
        b03: motion.of(1, &[0, 2, 1]),
    }
}

/// The coefficients of the normal form of a fold that interacts with an oscillation of amplitude
/// `|z|`.
struct FoldInteraction {
    a20: f64,
    a02: f64,
    a30: f64,
    a12: f64,
    b11: c64,
    b21: c64,
    b03: c64,
}

/// Rounding: the terms of second order count as zero if they are smaller than this fraction of the
/// frequency, for the amplitudes of `v` and `z` at which their own terms of third order are as large
/// as the frequency.
const SYMMETRIC: f64 = 1e-5;

/// Heuristic: the margin in the estimate of the deviation of the state.
const MARGIN: f64 = 5.0;

/// Rounding: the rounding errors of a residual, as a multiple of `ε` times the product of the Jacobian
/// matrix and the state.
const SEVERAL: f64 = 10.0;

/// Returns the uncertainty of a state near a pitchfork along the critical vector: the distance at which
/// Newton's method may stop, and an estimate of the rounding errors of the residual.
fn uncertainty(at: &mut At) -> Result<[f64; 2], Failure> {
    let n = at.system.names().dimension();
    let mut direction: Vec<f64> =
        at.x.iter().zip(generic(at.x.len(), 11)).map(|(x, s)| x * s).collect();
    direction[n..].fill(0.0);
    let mut change = vec![0.0; n];
    at.system.derivative(at.x, &[&direction], &mut change)?;
    Ok([DOUBLE_ROOT * norm(&at.x[..n]), SEVERAL * f64::EPSILON * norm(&change)])
}

impl FoldInteraction {
    /// Whether all terms of second order are zero, as at a pitchfork, up to rounding, or up to the errors
    /// that a deviation `δ` of the state along the critical vector causes: `a₂₀ = 3 a₃₀ δ`, `a₀₂ = a₁₂ δ` and
    /// `b₁₁ = 2 b₂₁ δ`. The deviation is at most the `distance` at which Newton's method stops, or the
    /// deviation for which the term of third order, `a₃₀ δ³`, is as small as the `rounding` errors of the
    /// residual.
    fn is_symmetric(&self, omega: f64, [distance, rounding]: [f64; 2]) -> bool {
        let FoldInteraction { a20, a02, a30, a12, b11, b21, b03 } = self;
        let [v, z] = [a30.abs(), b03.re.abs()].map(|third| (omega / third).sqrt());
        let second = [a20.abs() * v, b11.re.abs() * v, a02.abs() * z * z / v];
        let deviation = MARGIN * distance.max((rounding / a30.abs()).cbrt());
        let slopes = [3.0 * a30.abs() * v, 2.0 * b21.re.abs() * v, a12.abs() * z * z / v];
        second
            .iter()
            .zip(slopes)
            .all(|(rate, slope)| *rate <= SYMMETRIC * omega || *rate <= slope * deviation)
    }

    /// Returns the normal form of a pitchfork that interacts with a critical pair.
    fn pitchfork(&self) -> NormalForm {
        let FoldInteraction { a30, a12, b21, b03, .. } = *self;
        let names = ["ph_p11", "ph_p12", "ph_p21", "ph_p22", "ph_theta", "ph_delta"];
        let own = ["pitchfork–Hopf, simple", "pitchfork–Hopf, difficult"];
        amplitudes([[a30, a12], [b21.re, b03.re]], (names, own), &["ph_p11", "ph_p22"])
    }

    /// Returns the normal form of a fold that interacts with a critical pair; the arguments are the
    /// names of `s`, `θ` and `E`.
    fn normal_form(&self, [s, theta, e]: [&'static str; 3]) -> NormalForm {
        let FoldInteraction { a20, a02, a30, a12, b11, b21, b03 } = self;
        let sign = (a20 * a02).signum();
        let ratio = b11.re / a20;
        let mixed = 2.0 * b03.re / a02 - 3.0 * a30 / a20 + a12 / a02;
        let third = (b21 + 0.5 * b11 * mixed - b03 * (a20 / a02)).re;
        let case = match (sign > 0.0, ratio > 0.0) {
            (true, true) => "s = 1, θ > 0",
            (true, false) => "s = 1, θ < 0",
            (false, true) => "s = −1, θ > 0",
            (false, false) => "s = −1, θ < 0",
        };
        NormalForm::of([(s, sign), (theta, ratio), (e, third)]).decided(case, &[])
    }

    /// The second-order coefficients of the normal form, with `a₂₀ > 0` if the sign of the critical
    /// vector is arbitrary.
    fn quadratic(
        &self,
        names: &[&'static str; 3],
        any_sign: bool,
    ) -> impl Iterator<Item = (&'static str, f64)> {
        let sign = if any_sign { self.a20.signum() } else { 1.0 };
        let values = [self.a20, self.a02, self.b11.re];
        names.iter().copied().zip(values.map(|value| sign * value))
    }
}

/// The normal form of a double Hopf point:
///
/// ```text
///     z₁' = iω₁ z₁ + f₂₁₀₀ z₁ |z₁|² + f₁₀₁₁ z₁ |z₂|²,
///     z₂' = iω₂ z₂ + g₁₁₁₀ z₂ |z₁|² + g₀₀₂₁ z₂ |z₂|²,
/// ```
///
/// The recorded numbers are `p₁₁ = Re f₂₁₀₀`, `p₁₂ = Re f₁₀₁₁`, `p₂₁ = Re g₁₁₁₀`, `p₂₂ = Re g₀₀₂₁`,
/// `θ = p₁₂/p₂₂` and `δ = p₂₁/p₁₁`. The double Hopf point is of the simple type if `p₁₁ p₂₂ > 0`
/// (Kuznetsov, section 8.6). The pair with index 1 has the larger frequency.
pub(in crate::core::bifurcation) fn double_hopf(at: &mut At) -> Result<NormalForm, Failure> {
    let names = ["hh_p11", "hh_p12", "hh_p21", "hh_p22", "hh_theta", "hh_delta"];
    two_pairs(at, names, &["hh_p11", "hh_p22"])
}

/// The normal form of a double torus point of periodic orbits. The amplitude equations, with rates
/// per time, are the same as for a double Hopf point, and the critical vectors are normalised by
/// `∫₀ᵀ⟨q, q⟩ dt = 1`. The pair with index 1 has the larger angle.
pub(in crate::core::bifurcation) fn double_torus(at: &mut At) -> Result<NormalForm, Failure> {
    let names = ["nsns_p11", "nsns_p12", "nsns_p21", "nsns_p22", "nsns_theta", "nsns_delta"];
    two_pairs(at, names, &["nsns_p11", "nsns_p22"])
}

fn two_pairs(
    at: &mut At,
    names: [&'static str; 6],
    deciding: &'static [&'static str],
) -> Result<NormalForm, Failure> {
    let &[one, other] = at.held else { return Ok(NormalForm::default()) };
    let forms = [one.max(other), one.min(other)].map(Form::Oscillation);
    let (motion, _) = reduced(at, forms)?;
    let first = [motion.of(0, &[2, 1, 0, 0]).re, motion.of(0, &[1, 0, 1, 1]).re];
    let second = [motion.of(2, &[1, 1, 1, 0]).re, motion.of(2, &[0, 0, 2, 1]).re];
    Ok(amplitudes([first, second], (names, TYPES), deciding))
}

/// The normal form of a flip–torus point of periodic orbits:
///
/// ```text
///     dy/dt = p₁₁ y³ + p₁₂ y |z|²,     dz/dt = iθ/T z + (p₂₁ + i …) y² z + (p₂₂ + i …) z |z|²,
/// ```
///
/// The critical vectors are normalised by `∫₀ᵀ⟨q, q⟩ dt = 1`. The amplitude equations are the same
/// as at a double Hopf point.
pub(in crate::core::bifurcation) fn flip_torus(at: &mut At) -> Result<NormalForm, Failure> {
    let Some(&angle) = at.held.first() else { return Ok(NormalForm::default()) };
    let (motion, _) = reduced(at, [Form::Antiperiodic, Form::Oscillation(angle)])?;
    let first = [motion.of(0, &[3, 0, 0]).re, motion.of(0, &[1, 1, 1]).re];
    let second = [motion.of(1, &[2, 1, 0]).re, motion.of(1, &[0, 2, 1]).re];
    let names = ["pdns_p11", "pdns_p12", "pdns_p21", "pdns_p22", "pdns_theta", "pdns_delta"];
    Ok(amplitudes([first, second], (names, TYPES), &["pdns_p11", "pdns_p22"]))
}

/// The types of two interacting oscillations: `p₁₁ p₂₂ > 0`, or not.
const TYPES: [&str; 2] = ["simple", "difficult"];

/// The normal form of two interacting oscillations with the amplitudes `rᵢ`: `rᵢ' = rᵢ Σ_j pᵢⱼ
/// rⱼ²`.
fn amplitudes(
    [[p11, p12], [p21, p22]]: [[f64; 2]; 2],
    (names, [simple, difficult]): ([&'static str; 6], [&'static str; 2]),
    deciding: &'static [&'static str],
) -> NormalForm {
    let case = if p11 * p22 > 0.0 { simple } else { difficult };
    let values = [p11, p12, p21, p22, p12 / p22, p21 / p11];
    let coefficients = names.into_iter().zip(values).collect();
    NormalForm { coefficients, case: None }.decided(case, deciding)
}
