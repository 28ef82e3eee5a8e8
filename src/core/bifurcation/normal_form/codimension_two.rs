//! Points of codimension two of equilibria.

use super::NormalForm;
use super::forms::{Forms, leading};
use super::manifold::{Eigenvalue, motion};
use crate::core::bifurcation::at::At;
use crate::core::failure::Failure;
use crate::core::linalg::{Form, dot, norm};
use crate::core::problem::Dynamics;
use faer::c64;

/// The zero eigenvalue, `⟨q, q⟩ = ⟨p, q⟩ = 1`, the largest component of `q` positive.
fn zero(forms: &mut Forms) -> Result<Eigenvalue, Failure> {
    let n = forms.n;
    let critical = forms.real(Form::Jacobian)?;
    let q = &critical.right[..n];
    let size = norm(q) * leading(q).signum();
    let scale = dot(&critical.left, q) / size;
    let complex = |v: &[f64], by: f64| v.iter().map(|c| c64::new(c / by, 0.0)).collect();
    Ok(Eigenvalue { omega: 0.0, right: complex(q, size), left: complex(&critical.left, scale) })
}

/// The pair with a frequency, `⟨q, q⟩ = ⟨p, q⟩ = 1`.
fn pair(forms: &mut Forms, omega: f64) -> Result<Eigenvalue, Failure> {
    let [q, p] = forms.complex_afresh(omega)?;
    let size = q.iter().map(|c| c.norm_sqr()).sum::<f64>().sqrt();
    let right = q.iter().map(|c| c / size).collect();
    Ok(Eigenvalue { omega, right, left: p.iter().map(|c| c * size).collect() })
}

fn is_flow(at: &At) -> bool {
    at.system.dynamics() == Dynamics::Flow
}

/// A cusp: `v' = β₁ + β₂ v + c v³` with `⟨q, q⟩ = 1`.
pub(in crate::core::bifurcation) fn cusp(at: &mut At) -> Result<NormalForm, Failure> {
    if !is_flow(at) {
        return Ok(NormalForm::default());
    }
    let mut forms = Forms::new(at);
    let eigenvalue = zero(&mut forms)?;
    let c = motion(&mut forms, &[eigenvalue], 3)?.of(0, &[3]).re;
    Ok(NormalForm::of([("cusp_c", c)]))
}

/// A Bogdanov–Takens point: `w₀' = w₁`, `w₁' = β₁ + β₂ w₁ + a w₀² + b w₀ w₁`, with `F_z q₀ = 0`,
/// `F_z q₁ = q₀`, `F_zᵀ p₁ = 0`, `F_zᵀ p₀ = p₁`, `⟨q₀, q₀⟩ = ⟨p₀, q₀⟩ = ⟨p₁, q₁⟩ = 1`,
/// `⟨q₁, q₀⟩ = ⟨p₀, q₁⟩ = 0`: `a = ½ ⟨p₁, B(q₀, q₀)⟩`, `b = ⟨p₀, B(q₀, q₀)⟩ + ⟨p₁, B(q₀, q₁)⟩`.
/// The largest component of `q₀` is positive; `a/b` does not depend on its size.
pub(in crate::core::bifurcation) fn bogdanov_takens(at: &mut At) -> Result<NormalForm, Failure> {
    let Takens { a, b, .. } = takens(at)?;
    let case = if a * b < 0.0 { "s = −1" } else { "s = 1" };
    Ok(NormalForm::of([("bt_a", a), ("bt_b", b)]).decided(case, &["bt_a", "bt_b"]))
}

/// A point near the curve of Hopf points beside a Bogdanov–Takens point, in the two released
/// parameters, whose state is this far away. With `ω² = −2 a w₀` the curve has `β₁ = −a w₀²` and
/// `β₂ = −b w₀`: along the curve of folds `β₁ = 0`, of the direction `t`,
/// `β₂' = ⟨p₀, B(q₀, t)⟩ + ⟨p₁, B(q₁, t)⟩`.
pub(crate) fn hopf_beside(at: &mut At, distance: f64) -> Result<Vec<f64>, Failure> {
    let Takens { a, b, q0, q1, p0, p1 } = takens(at)?;
    let w0 = -distance * a.signum();
    let mut forms = Forms::new(at);
    let [one, other] = forms.of_parameters()?;
    let [by_one, by_other] = [dot(&p1, &forms.of(&[&one])?), dot(&p1, &forms.of(&[&other])?)];
    let size = by_one.hypot(by_other);
    let along: Vec<f64> =
        one.iter().zip(&other).map(|(a, b)| (a * by_other - b * by_one) / size).collect();
    let slope = forms.of(&[&along])?;
    let mut t = forms.solve_within_border(slope.into_iter().map(|f| -f).collect())?;
    t.iter_mut().zip(&along).for_each(|(t, d)| *t += d);
    let turn = dot(&p1, &forms.of(&[&q0, &t])?) / (2.0 * a);
    t.iter_mut().zip(&q0).for_each(|(t, q)| *t -= turn * q);
    let rate = dot(&p0, &forms.of(&[&q0, &t])?) + dot(&p1, &forms.of(&[&q1, &t])?);
    let step = -b * w0 / rate;
    if !step.is_finite() {
        return Err(Failure::Undetermined(
            "the parameters do not unfold the Bogdanov–Takens point".into(),
        ));
    }
    let x = at.x.iter().zip(&q0).zip(&t);
    Ok(x.map(|((x, q), t)| x + w0 * q + step * t).collect())
}

/// The coefficients of a Bogdanov–Takens point; `q₀` and `q₁` are directions of `x`.
struct Takens {
    q0: Vec<f64>,
    q1: Vec<f64>,
    p0: Vec<f64>,
    p1: Vec<f64>,
    a: f64,
    b: f64,
}

fn takens(at: &mut At) -> Result<Takens, Failure> {
    let mut forms = Forms::new(at);
    let n = forms.n;
    let critical = forms.real(Form::Jacobian)?;
    let (v, w) = (&critical.right[..n], &critical.left);
    let size = norm(v) * leading(v).signum();
    let mut q0: Vec<f64> = v.iter().map(|c| c / size).collect();
    let mut q1 = forms.solve_within_border(q0.clone())?;
    let along = dot(&q1[..n], &q0);
    q1.iter_mut().zip(&q0).for_each(|(c, q)| *c -= along * q);
    let scale = dot(w, &q1[..n]);
    let p1: Vec<f64> = w.iter().map(|c| c / scale).collect();
    let mut p0 = forms.solve_within_border_transposed(p1.clone())?;
    let along = dot(&p0, &q1[..n]);
    p0.iter_mut().zip(&p1).for_each(|(c, p)| *c -= along * p);
    q0.resize(forms.at.x.len(), 0.0);
    let second = forms.of(&[&q0, &q0])?;
    let a = 0.5 * dot(&p1, &second);
    let b = dot(&p0, &second) + dot(&p1, &forms.of(&[&q0, &q1])?);
    Ok(Takens { q0, q1, p0, p1, a, b })
}

/// A generalised Hopf point: `z' = (β₁ + iω) z + β₂ z |z|² + c₂ z |z|⁴`, `⟨q, q⟩ = 1`, and the
/// second Lyapunov coefficient `l₂ = Re c₂/ω`. (BifurcationKit prints `Re c₂`.)
pub(in crate::core::bifurcation) fn bautin(at: &mut At) -> Result<NormalForm, Failure> {
    let Some(&omega) = at.held.first() else { return Ok(NormalForm::default()) };
    let mut forms = Forms::new(at);
    let eigenvalue = pair(&mut forms, omega)?;
    let c2 = motion(&mut forms, &[eigenvalue], 5)?.of(0, &[3, 2]);
    let case = if c2.re < 0.0 { "l2 < 0" } else { "l2 > 0" };
    let of = NormalForm::of([("l2", c2.re / omega), ("c2_re", c2.re), ("c2_im", c2.im)]);
    Ok(of.decided(case, &["l2"]))
}

/// A fold–Hopf point,
///
/// ```text
///     v' = G₂₀₀/2 v² + G₀₁₁ |z|² + G₃₀₀/6 v³ + G₁₁₁ v |z|²,
///     z' = iω z + G₁₁₀ v z + G₂₁₀/2 v² z + G₀₂₁/2 z |z|²,
/// ```
///
/// and the numbers that decide the picture (Kuznetsov, section 8.5): `s = sign G₂₀₀ G₀₁₁`,
/// `θ = 2 Re G₁₁₀/G₂₀₀`, `E = ½ Re (G₂₁₀ + G₁₁₀ (Re G₀₂₁/G₀₁₁ − G₃₀₀/G₂₀₀ + G₁₁₁/G₀₁₁) − G₀₂₁
/// G₂₀₀/(2 G₀₁₁))`.
pub(in crate::core::bifurcation) fn fold_hopf(at: &mut At) -> Result<NormalForm, Failure> {
    let Some(&omega) = at.held.first() else { return Ok(NormalForm::default()) };
    let mut forms = Forms::new(at);
    let eigenvalues = [zero(&mut forms)?, pair(&mut forms, omega)?];
    let motion = motion(&mut forms, &eigenvalues, 3)?;
    let [g200, g011, g300, g111] = [
        2.0 * motion.of(0, &[2, 0, 0]).re,
        motion.of(0, &[0, 1, 1]).re,
        6.0 * motion.of(0, &[3, 0, 0]).re,
        motion.of(0, &[1, 1, 1]).re,
    ];
    let [g110, g210, g021] =
        [motion.of(1, &[1, 1, 0]), 2.0 * motion.of(1, &[2, 1, 0]), 2.0 * motion.of(1, &[0, 2, 1])];
    let s = (g200 * g011).signum();
    let theta = 2.0 * g110.re / g200;
    let e = 0.5
        * (g210 + g110 * (g021.re / g011 - g300 / g200 + g111 / g011) - g021 * (0.5 * g200 / g011))
            .re;
    let case = match (s > 0.0, theta > 0.0) {
        (true, true) => "s = 1, θ > 0",
        (true, false) => "s = 1, θ < 0",
        (false, true) => "s = −1, θ > 0",
        (false, false) => "s = −1, θ < 0",
    };
    let of = NormalForm::of([("zh_s", s), ("zh_theta", theta), ("zh_e", e)]);
    Ok(of.decided(case, &["zh_s", "zh_theta"]))
}

/// A double Hopf point,
///
/// ```text
///     z₁' = iω₁ z₁ + f₂₁₀₀ z₁ |z₁|² + f₁₀₁₁ z₁ |z₂|²,
///     z₂' = iω₂ z₂ + g₁₁₁₀ z₂ |z₁|² + g₀₀₂₁ z₂ |z₂|²,
/// ```
///
/// `p₁₁ = Re f₂₁₀₀`, `p₁₂ = Re f₁₀₁₁`, `p₂₁ = Re g₁₁₁₀`, `p₂₂ = Re g₀₀₂₁`, `θ = p₁₂/p₂₂`,
/// `δ = p₂₁/p₁₁`; the case is simple if `p₁₁ p₂₂ > 0` (Kuznetsov, section 8.6). The pair with the
/// larger frequency is the first one.
pub(in crate::core::bifurcation) fn double_hopf(at: &mut At) -> Result<NormalForm, Failure> {
    let &[one, other] = at.held else { return Ok(NormalForm::default()) };
    let (first, second) = (one.max(other), one.min(other));
    let mut forms = Forms::new(at);
    let eigenvalues = [pair(&mut forms, first)?, pair(&mut forms, second)?];
    let motion = motion(&mut forms, &eigenvalues, 3)?;
    let [p11, p12] = [motion.of(0, &[2, 1, 0, 0]).re, motion.of(0, &[1, 0, 1, 1]).re];
    let [p21, p22] = [motion.of(1, &[1, 1, 1, 0]).re, motion.of(1, &[0, 0, 2, 1]).re];
    let case = if p11 * p22 > 0.0 { "simple" } else { "difficult" };
    let of = NormalForm::of([
        ("hh_p11", p11),
        ("hh_p12", p12),
        ("hh_p21", p21),
        ("hh_p22", p22),
        ("hh_theta", p12 / p22),
        ("hh_delta", p21 / p11),
    ]);
    Ok(of.decided(case, &["hh_p11", "hh_p22"]))
}
