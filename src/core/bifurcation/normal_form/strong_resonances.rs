//! Normal forms of strong resonances of periodic orbits, where the critical multipliers are a
//! double 1, a double −1, `e^{±2πi/3}` or `±i`.
//!
//! The period map on the center manifold is `R = M exp(T V)`, where `M` is its linear part and the
//! vector field `V` is the normal form, a rate per time (Yu. A. Kuznetsov and H. G. E. Meijer,
//! *SIAM J. Sci. Comput.* 26:1932, 2005, for maps; V. De Witte, F. Della Rossa, W. Govaerts and Yu.
//! A. Kuznetsov, *SIAM J. Appl. Dyn. Syst.* 12:722, 2013, for cycles). The critical vectors are
//! normalised by `∫₀ᵀ⟨q, q⟩ dt = 1`; for maps, `T = 1`, and the mean of `⟨q, q⟩` over the cycle
//! is 1.

use super::NormalForm;
use super::eigenvalue::Eigenvalue;
use super::forms::Forms;
use super::manifold::motion;
use crate::core::bifurcation::at::At;
use crate::core::failure::Failure;
use crate::core::linalg::Form;
use std::f64::consts::PI;

/// The normal form of a resonance 1:1: `ξ₁' = ξ₂`, `ξ₂' = β₁ + β₂ ξ₂ + a ξ₁² + b ξ₁ ξ₂`, with
/// `dτ/dt = 1 − ξ₁ + …` if the period is free, and `a > 0` if the period is fixed. For maps, the
/// normal form is `ξ₁ → ξ₁ + ξ₂`, `ξ₂ → ξ₂ + a ξ₁² + (b + 2a) ξ₁ ξ₂`. As at a Bogdanov–Takens
/// point, the sign of `a b` determines the unfolding.
pub(in crate::core::bifurcation) fn one_to_one(at: &mut At) -> Result<NormalForm, Failure> {
    let mut forms = Forms::new(at);
    let mut double = [Eigenvalue::double(&mut forms, Form::Jacobian)?];
    let motion = motion(&mut forms, &mut double, 2)?;
    let period = forms.period()?;
    // Rates per time of ξ₁ and T ξ₂: with η = ξ₁', η' = a ξ₁² + b ξ₁ η + ….
    let a = motion.of(1, &[2, 0]).re / period;
    let b = motion.of(1, &[1, 1]).re + 2.0 * motion.of(0, &[2, 0]).re;
    let sign = if double[0].by_period { 1.0 } else { a.signum() };
    let case = if a * b < 0.0 { "s = −1" } else { "s = 1" };
    let of = NormalForm::of([("r1_a", sign * a), ("r1_b", sign * b)]);
    Ok(of.decided(case, &["r1_a", "r1_b"]))
}

/// The normal form of a resonance 1:2: `ξ₁' = ξ₂`, `ξ₂' = β₁ ξ₁ + β₂ ξ₂ + a ξ₁³ + b ξ₁² ξ₂` in a
/// frame that rotates by half a turn in a period. For maps, the normal form is `ξ₁ → −ξ₁ + ξ₂`, `ξ₂
/// → −ξ₂ + C ξ₁³ + D ξ₁² ξ₂` with `C = a` and `D = −b − 3a`. The unfolding depends on `s = sign a`;
/// if `b > 0`, the unfolding is that for `b < 0` with time reversed (Kuznetsov, section 9.5.3).
pub(in crate::core::bifurcation) fn one_to_two(at: &mut At) -> Result<NormalForm, Failure> {
    let mut forms = Forms::new(at);
    let mut double = [Eigenvalue::double(&mut forms, Form::Antiperiodic)?];
    let motion = motion(&mut forms, &mut double, 3)?;
    let a = motion.of(1, &[3, 0]).re / forms.period()?;
    let b = motion.of(1, &[2, 1]).re + 3.0 * motion.of(0, &[3, 0]).re;
    let case = match (a > 0.0, b > 0.0) {
        (true, true) => "s = 1, b > 0",
        (true, false) => "s = 1, b < 0",
        (false, true) => "s = −1, b > 0",
        (false, false) => "s = −1, b < 0",
    };
    Ok(NormalForm::of([("r2_a", a), ("r2_b", b)]).decided(case, &["r2_a", "r2_b"]))
}

/// The normal form of a resonance 1:3: `ξ' = β ξ + b ξ̄² + c ξ |ξ|²` in a frame that rotates by a
/// third of a turn in a period. The recorded numbers are `|b|` and `Re c`; the sign of `Re c`
/// determines whether the torus is attracting. For maps, the normal form is `ξ → e^{2πi/3} (ξ + b
/// ξ̄² + (c + |b|²) ξ |ξ|²)`.
pub(in crate::core::bifurcation) fn one_to_three(at: &mut At) -> Result<NormalForm, Failure> {
    let mut forms = Forms::new(at);
    let mut pair = [Eigenvalue::simple(&mut forms, Form::Oscillation(2.0 * PI / 3.0))?];
    let motion = motion(&mut forms, &mut pair, 3)?;
    let (b, c) = (motion.of(0, &[0, 2]).norm(), motion.of(0, &[2, 1]).re);
    let case = if c < 0.0 { "c < 0" } else { "c > 0" };
    Ok(NormalForm::of([("r3_b", b), ("r3_c_re", c)]).decided(case, &["r3_c_re"]))
}

/// The normal form of a resonance 1:4: `ξ' = β ξ + c ξ |ξ|² + d ξ̄³` in a frame that rotates by a
/// quarter of a turn in a period. The recorded numbers are `|d|` and `A₀ = c/|d|`, which does not
/// depend on the scale of `ξ`. For maps, the normal form is `ξ → i (ξ + c ξ |ξ|² + d ξ̄³)`.
pub(in crate::core::bifurcation) fn one_to_four(at: &mut At) -> Result<NormalForm, Failure> {
    let mut forms = Forms::new(at);
    let mut pair = [Eigenvalue::simple(&mut forms, Form::Oscillation(0.5 * PI))?];
    let motion = motion(&mut forms, &mut pair, 3)?;
    let (d, c) = (motion.of(0, &[0, 3]).norm(), motion.of(0, &[2, 1]));
    let case = if c.re < 0.0 { "Re A₀ < 0" } else { "Re A₀ > 0" };
    let of = NormalForm::of([("r4_a0_re", c.re / d), ("r4_a0_im", c.im / d), ("r4_d", d)]);
    Ok(of.decided(case, &["r4_a0_re"]))
}
