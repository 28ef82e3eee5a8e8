//! Normal forms of critical pairs: Hopf points of equilibria, and torus points of periodic orbits.

use super::forms::{Forms, inner};
use super::{NormalForm, Rate, criticality};
use crate::core::bifurcation::at::At;
use crate::core::failure::Failure;
use crate::core::system::Deviation;
use faer::c64;

/// The first- and third-order coefficients of the normal form of a critical pair, for an
/// eigenvector `q` of any size.
struct Pair {
    /// The coefficient of `ξ |ξ|²` in the rate of `ξ`.
    cubic: c64,
    /// The sum of the moduli of the terms of `cubic`: in conservative systems, the real part of each term
    /// may vanish.
    size: f64,
    /// The integral over the period of the squared norm `⟨q, q⟩` of the eigenvector `q`.
    square: f64,
    period: f64,
    omega: f64,
    q: Vec<c64>,
    p: Vec<c64>,
}

/// Computes the real part of the coefficient of `(λ − λ₀) ξ` in the rate of `ξ`.
fn slope(at: &mut At, Pair { q, p, omega, .. }: &Pair) -> Result<Option<f64>, Failure> {
    let mut forms = Forms::new(at);
    let Some(along) = forms.along_branch()? else { return Ok(None) };
    Ok(Some(inner(p, &forms.along((q, *omega), &along)?).re))
}

/// Computes the normal-form coefficients of a critical pair. For `N = −1`, these coefficients are
///
/// ```text
///     c₁ = ½ p* (C(q, q, q̄) + B(q̄, h₂₀) + 2 B(q, h₁₁)),
///     L(2iω) h₂₀ = −B(q, q),   L(0) h₁₁ = −B(q, q̄),   α = p* B(q, z_λ).
/// ```
fn pair(at: &mut At, omega: f64) -> Result<Pair, Failure> {
    let mut forms = Forms::new(at);
    let [q, p] = forms.complex(omega)?;
    let n = forms.n;
    let [u, v] = forms.parts(&q, omega);
    let [uu, uv, vv] = [[&u, &u], [&u, &v], [&v, &v]];
    let [uu, uv, vv] = [forms.of(&uu)?, forms.of(&uv)?, forms.of(&vv)?];
    let b_qq: Vec<c64> = (0..n).map(|i| c64::new(vv[i] - uu[i], -2.0 * uv[i])).collect();
    let h20 = forms.solve_complex(2.0 * omega, &b_qq)?;
    let h11 = forms.solve((0..n).map(|i| -uu[i] - vv[i]).collect())?;

    // C(q, q, q̄) = C(u, u, u) + C(u, v, v) + i (C(u, u, v) + C(v, v, v)).
    let [uuu, uvv] = [forms.of(&[&u, &u, &u])?, forms.of(&[&u, &v, &v])?];
    let [uuv, vvv] = [forms.of(&[&u, &u, &v])?, forms.of(&[&v, &v, &v])?];
    let third: Vec<c64> = (0..n).map(|i| c64::new(uuu[i] + uvv[i], uuv[i] + vvv[i])).collect();
    let conjugate: Vec<c64> = q.iter().map(c64::conj).collect();
    let with_h20 = forms.bilinear((&conjugate, -omega), (&h20, 2.0 * omega))?;
    let with_h11 = forms.along((&q, omega), &h11)?;
    let terms = [0.5 * inner(&p, &third), 0.5 * inner(&p, &with_h20), inner(&p, &with_h11)];
    let Deviation { square, period, .. } = forms.deviation(&[&u, &v], omega)?;
    Ok(Pair {
        cubic: terms.iter().sum(),
        size: terms.iter().map(|term| term.norm()).sum(),
        square,
        period,
        omega,
        q,
        p,
    })
}

const CASES: [&str; 2] = ["supercritical", "subcritical"];

/// The normal form of a Hopf point: `z' = (α (λ − λ₀) + iω) z + c₁ z |z|²` on the center manifold
/// with `⟨q, q⟩ = ⟨p, q⟩ = 1`, and the first Lyapunov coefficient `l₁ = Re c₁/ω`. (MatCont prints
/// `Re c₁`.)
pub(in crate::core::bifurcation) fn hopf(at: &mut At) -> Result<NormalForm, Failure> {
    let Some(&omega) = at.held.first().filter(|_| at.system.dynamics().is_flow()) else {
        return Ok(NormalForm::default());
    };
    let pair = pair(at, omega)?;
    let c = pair.cubic / pair.square;
    let case = criticality((&["l1"], c.re), pair.size / pair.square, CASES);
    let mut coefficients = vec![("l1", c.re / omega), ("c1_re", c.re), ("c1_im", c.im)];
    coefficients.extend(slope(at, &pair)?.map(|slope| ("growth_slope", slope)));
    Ok(NormalForm { coefficients, case })
}

/// The normal form of a torus point: `dξ/dt = (α (λ − λ₀) + iθ/T) ξ + d ξ |ξ|²` with `∫₀ᵀ⟨q, q⟩ dt
/// = 1` (for maps, `T = 1`, and the mean of `⟨q, q⟩` over the cycle is 1). At strong resonances the
/// normal form contains further terms, and `d` may be infinite.
pub(in crate::core::bifurcation) fn torus(at: &mut At) -> Result<NormalForm, Failure> {
    let Some(&angle) = at.held.first() else { return Ok(NormalForm::default()) };
    let pair = pair(at, angle)?;
    let (square, per_time) = (pair.square, pair.period.recip());
    let d = pair.cubic / square * per_time;
    let case = criticality((&["torus_d_re"], d.re), pair.size / square * per_time, CASES);
    let mut coefficients = vec![("torus_d_re", d.re), ("torus_d_im", d.im)];
    let slope = slope(at, &pair)?;
    coefficients.extend(slope.map(|slope| ("growth_slope", slope * per_time)));
    Ok(NormalForm { coefficients, case })
}

/// Computes only `Re c₁` of a Hopf point or `Re d` of a torus point.
pub(in crate::core::bifurcation) fn pair_rate(at: &mut At) -> Result<Rate, Failure> {
    let Some(&omega) = at.held.first() else {
        return Err(Failure::Unsupported("no frequency is known".into()));
    };
    let Pair { cubic, size, square, period, .. } = pair(at, omega)?;
    let time = square * period;
    Ok(Rate { value: cubic.re / time, size: size / time })
}
