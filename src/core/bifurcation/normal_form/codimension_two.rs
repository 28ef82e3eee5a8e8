//! Normal forms of codimension-two points with one critical eigenvalue or multiplier.

use super::eigenvalue::Eigenvalue;
use super::forms::{Forms, leading};
use super::manifold::motion;
use super::{NormalForm, has_rates};
use crate::core::bifurcation::at::At;
use crate::core::failure::Failure;
use crate::core::linalg::{Form, dot};
use crate::core::problem::Dynamics;
use faer::c64;

/// The normal form of a cusp: `v' = β₁ + β₂ v + c v³` with `⟨q, q⟩ = 1`. For periodic orbits, `⟨q,
/// q⟩` is integrated over the period, the rates are per time, and `dτ/dt = 1 − v + …` if the period
/// is free.
pub(in crate::core::bifurcation) fn cusp(at: &mut At) -> Result<NormalForm, Failure> {
    if !has_rates(at) {
        return Ok(NormalForm::default());
    }
    let mut forms = Forms::new(at);
    let mut one = [Eigenvalue::simple(&mut forms, Form::Jacobian)?];
    let c = motion(&mut forms, &mut one, 3)?.of(0, &[3]).re;
    Ok(NormalForm::of([(if one[0].by_period { "cpc_c" } else { "cusp_c" }, c)]))
}

/// The normal form of a Bogdanov–Takens point: `w₀' = w₁`, `w₁' = β₁ + β₂ w₁ + a w₀² + b w₀ w₁`,
/// with `F_z q₀ = 0`, `F_z q₁ = M q₀`, `F_zᵀ p₁ = 0`, `F_zᵀ p₀ = Mᵀ p₁`, `⟨q₀, q₀⟩ = ⟨p₀, M q₀⟩ =
/// ⟨p₁, M q₁⟩ = 1`, `⟨q₁, q₀⟩ = ⟨p₀, M q₁⟩ = 0`: `a = ½ ⟨p₁, B(q₀, q₀)⟩`, `b = ⟨p₀, B(q₀, q₀)⟩ + ⟨p₁,
/// B(q₀, q₁)⟩`, where the deviation `q₁` has the rate `q₀`. The sign of `q₀` is chosen such that its largest component is positive; the ratio `a/b`
/// does not depend on the size of `q₀`.
pub(in crate::core::bifurcation) fn bogdanov_takens(at: &mut At) -> Result<NormalForm, Failure> {
    let mut forms = Forms::new(at);
    let n = forms.n;
    let critical = forms.real(Form::Jacobian)?;
    let (v, w) = (&critical.right[..n], &critical.left);
    let size = forms.deviation(&[&critical.right], 0.0)?.square.sqrt() * leading(v).signum();
    let mut q0: Vec<f64> = v.iter().map(|c| c / size).collect();
    let minus = |v: Vec<f64>| v.into_iter().map(|c| -c).collect::<Vec<f64>>();
    let right = minus(forms.growth(&q0)?);
    let mut q1 = forms.solve_within_border(right)?;
    let along = dot(&q1[..n], &q0) / dot(&q0, &q0);
    q1.iter_mut().zip(&q0).for_each(|(c, q)| *c -= along * q);
    let of_q1 = minus(forms.growth(&q1)?);
    let scale = dot(w, &of_q1);
    let p1: Vec<f64> = w.iter().map(|c| c / scale).collect();
    let right = minus(forms.growth_transposed(&p1)?);
    let mut p0 = forms.solve_within_border_transposed(right)?;
    let along = dot(&p0, &of_q1);
    p0.iter_mut().zip(&p1).for_each(|(c, p)| *c -= along * p);
    q0.resize(forms.at.x.len(), 0.0);
    if forms.at.system.dynamics() == Dynamics::Implicit {
        q1.extend_from_slice(&q0[..n]);
    }
    let second = forms.of(&[&q0, &q0])?;
    let a = 0.5 * dot(&p1, &second);
    let b = dot(&p0, &second) + dot(&p1, &forms.of(&[&q0, &q1])?);
    let case = if a * b < 0.0 { "s = −1" } else { "s = 1" };
    Ok(NormalForm::of([("bt_a", a), ("bt_b", b)]).decided(case, &["bt_a", "bt_b"]))
}

/// The normal form of a generalised Hopf point: `z' = (β₁ + iω) z + β₂ z |z|² + c₂ z |z|⁴`, `⟨q, q⟩
/// = 1`, and the second Lyapunov coefficient `l₂ = Re c₂/ω`. (BifurcationKit prints `Re c₂`.)
pub(in crate::core::bifurcation) fn bautin(at: &mut At) -> Result<NormalForm, Failure> {
    let Some(&omega) = at.held.first() else { return Ok(NormalForm::default()) };
    let c2 = fifth(at, Form::Oscillation(omega), &[3, 2])?;
    let case = if c2.re < 0.0 { "l2 < 0" } else { "l2 > 0" };
    let of = NormalForm::of([("l2", c2.re / omega), ("c2_re", c2.re), ("c2_im", c2.im)]);
    Ok(of.decided(case, &["l2"]))
}

/// The normal form of a generalised period doubling: `dξ/dt = β₁ ξ + β₂ ξ³ + e ξ⁵` with `∫₀ᵀ⟨q, q⟩
/// dt = 1`. For maps, the normal form is `ξ → −ξ + … − e ξ⁵` with `T = 1`, and the mean of `⟨q, q⟩`
/// over the cycle is 1.
pub(in crate::core::bifurcation) fn generalised_doubling(
    at: &mut At,
) -> Result<NormalForm, Failure> {
    let e = fifth(at, Form::Antiperiodic, &[5])?.re;
    let case = if e < 0.0 { "e < 0" } else { "e > 0" };
    Ok(NormalForm::of([("gpd_e", e)]).decided(case, &["gpd_e"]))
}

/// The normal form of a Chenciner point: `dξ/dt = (β₁ + iθ/T) ξ + (β₂ + i …) ξ |ξ|² + e ξ |ξ|⁴`
/// with `∫₀ᵀ⟨q, q⟩ dt = 1`. The imaginary part of `e` depends on the choice of coordinates.
pub(in crate::core::bifurcation) fn chenciner(at: &mut At) -> Result<NormalForm, Failure> {
    let Some(&angle) = at.held.first() else { return Ok(NormalForm::default()) };
    let e = fifth(at, Form::Oscillation(angle), &[3, 2])?.re;
    let case = if e < 0.0 { "e < 0" } else { "e > 0" };
    Ok(NormalForm::of([("ch_e_re", e)]).decided(case, &["ch_e_re"]))
}

/// Computes a fifth-order coefficient of the rate of the first variable on the center manifold.
fn fifth(at: &mut At, form: Form, exponents: &[u8]) -> Result<c64, Failure> {
    let mut forms = Forms::new(at);
    let mut one = [Eigenvalue::simple(&mut forms, form)?];
    Ok(motion(&mut forms, &mut one, 5)?.of(0, exponents))
}
