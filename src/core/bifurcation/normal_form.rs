//! Coefficients of the normal forms of special points of equilibria.
//!
//! Notation of Yu. A. Kuznetsov, *Elements of Applied Bifurcation Theory*, 3rd ed. (2004), chapters
//! 5 and 8: `A = F_z`, `B(u, v) = F_zz[u, v]`, `C(u, v, w) = F_zzz[u, v, w]`, `⟨p, q⟩ = p* q`.

use super::at::At;
use crate::core::failure::Failure;
use crate::core::linalg::{Border, Factors, Form, dot, norm};
use crate::core::problem::Dynamics;
use faer::c64;

/// The named coefficients of a normal form at a special point of a branch of solutions; none where
/// the solutions are no equilibria of a flow.
///
/// # Errors
/// [`Failure`] where a coefficient is not defined, as at a 1:2 resonance: the point has no such
/// number then.
pub(crate) type NormalForm = fn(&mut At) -> Result<Vec<(&'static str, f64)>, Failure>;

/// At a fold `u' = β + a u²` on the center manifold, `a = ½ ⟨p, B(q, q)⟩` with `A q = 0`,
/// `Aᵀ p = 0`, `⟨q, q⟩ = ⟨p, q⟩ = 1`. The sign of `a` is that for a `q` whose largest component is
/// positive.
pub(super) fn fold(at: &mut At) -> Result<Vec<(&'static str, f64)>, Failure> {
    if at.system.dynamics() != Dynamics::Flow {
        return Ok(Vec::new());
    }
    let At { system, x, null, .. } = at;
    let n = system.names().dimension();
    let null = null.of(&mut **system, x, Form::Jacobian, None)?;
    let (right, left) = (&null.right[0], &null.left[0]);
    let mut second = vec![0.0; n];
    system.derivative(x, &[right, right], &mut second)?;
    let q = &right[..n];
    let largest = q.iter().fold(0.0, |most: f64, c| if c.abs() > most.abs() { *c } else { most });
    // With q = v/±|v| and p = ±w |v|/⟨w, v⟩ for the null vectors v and w.
    let a = 0.5 * dot(left, &second) / (dot(left, q) * norm(q)) * largest.signum();
    Ok(vec![("quadratic_coefficient", a)])
}

/// At a Hopf point `z' = (β + iω) z + c₁ z |z|²` on the center manifold, with the first Lyapunov
/// coefficient `l₁ = Re c₁/ω`. The cycles are stable on the center manifold (the bifurcation is
/// supercritical) where `l₁ < 0`:
///
/// ```text
///     c₁ = ½ ⟨p, C(q, q, q̄) + B(q̄, h₂₀) + 2 B(q, h₁₁)⟩,
///     (2iω − A) h₂₀ = B(q, q),   A h₁₁ = −B(q, q̄)
/// ```
///
/// with `A q = iω q`, `Aᵀ p = −iω p`, `⟨q, q⟩ = ⟨p, q⟩ = 1`.
pub(super) fn hopf(at: &mut At) -> Result<Vec<(&'static str, f64)>, Failure> {
    let Some(&omega) = at.held.first().filter(|_| at.system.dynamics() == Dynamics::Flow) else {
        return Ok(Vec::new());
    };
    let At { system, x, null, .. } = at;
    let n = system.names().dimension();
    let null = null.of(&mut **system, x, Form::Oscillation(omega), None)?;
    let q: Vec<c64> = (0..n).map(|i| c64::new(null.right[0][i], null.right[1][i])).collect();
    let p: Vec<c64> = (0..n).map(|i| c64::new(null.left[0][i], null.left[0][n + i])).collect();
    let size = inner(&q, &q).re.sqrt();
    let q: Vec<c64> = q.iter().map(|c| c / size).collect();
    let scale = inner(&p, &q).conj();
    let p: Vec<c64> = p.iter().map(|c| c / scale).collect();

    let mut forms = Forms { at, room: vec![0.0; n] };
    let (u, v) = (forms.direction(&q, |c| c.re), forms.direction(&q, |c| c.im));
    let [uu, uv, vv] = [[&u, &u], [&u, &v], [&v, &v]];
    let [uu, uv, vv] = [forms.of(&uu)?, forms.of(&uv)?, forms.of(&vv)?];
    let b_qq: Vec<c64> = (0..n).map(|i| c64::new(uu[i] - vv[i], 2.0 * uv[i])).collect();
    let b_qc: Vec<f64> = (0..n).map(|i| uu[i] + vv[i]).collect();
    let h11 = forms.solve(Form::Jacobian, b_qc.iter().map(|b| c64::from(-b)).collect())?;
    let h20 = forms.solve(Form::Oscillation(2.0 * omega), b_qq.iter().map(|b| -b).collect())?;

    // C(q, q, q̄) = C(u, u, u) + C(u, v, v) + i (C(u, u, v) + C(v, v, v)).
    let [uuu, uvv] = [forms.of(&[&u, &u, &u])?, forms.of(&[&u, &v, &v])?];
    let [uuv, vvv] = [forms.of(&[&u, &u, &v])?, forms.of(&[&v, &v, &v])?];
    let conjugate: Vec<c64> = q.iter().map(c64::conj).collect();
    let (with_h20, with_h11) = (forms.bilinear(&conjugate, &h20)?, forms.bilinear(&q, &h11)?);
    let sum = (0..n).map(|i| {
        let cubic = c64::new(uuu[i] + uvv[i], uuv[i] + vvv[i]);
        cubic + with_h20[i] + 2.0 * with_h11[i]
    });
    let c1 = 0.5 * inner(&p, &sum.collect::<Vec<_>>());
    Ok(vec![("lyapunov_coefficient", c1.re / omega)])
}

/// `⟨p, q⟩ = p* q`.
fn inner(p: &[c64], q: &[c64]) -> c64 {
    p.iter().zip(q).map(|(p, q)| p.conj() * q).sum()
}

/// The multilinear forms of `F` at a point, and linear systems with its Jacobian.
struct Forms<'f, 'a> {
    at: &'f mut At<'a>,
    room: Vec<f64>,
}

impl Forms<'_, '_> {
    /// A part of a complex vector as a direction of `x`.
    fn direction(&self, q: &[c64], part: impl Fn(&c64) -> f64) -> Vec<f64> {
        let mut direction: Vec<f64> = q.iter().map(part).collect();
        direction.resize(self.at.x.len(), 0.0);
        direction
    }

    /// The derivative of `F` along real directions.
    fn of(&mut self, directions: &[&Vec<f64>]) -> Result<Vec<f64>, Failure> {
        let directions: Vec<&[f64]> = directions.iter().map(|d| &d[..]).collect();
        self.at.system.derivative(self.at.x, &directions, &mut self.room)?;
        Ok(self.room.clone())
    }

    /// `B(a, b)`.
    fn bilinear(&mut self, a: &[c64], b: &[c64]) -> Result<Vec<c64>, Failure> {
        let [(ar, ai), (br, bi)] =
            [a, b].map(|c| (self.direction(c, |c| c.re), self.direction(c, |c| c.im)));
        let [rr, ii] = [self.of(&[&ar, &br])?, self.of(&[&ai, &bi])?];
        let [ri, ir] = [self.of(&[&ar, &bi])?, self.of(&[&ai, &br])?];
        Ok((0..rr.len()).map(|i| c64::new(rr[i] - ii[i], ri[i] + ir[i])).collect())
    }

    /// Solves with a form of `F_z`; with `F_z` itself the right side is real.
    fn solve(&mut self, form: Form, right: Vec<c64>) -> Result<Vec<c64>, Failure> {
        let (n, real) = (right.len(), form == Form::Jacobian);
        let imaginary = right.iter().map(|c| c.im).take(if real { 0 } else { n });
        let mut parts: Vec<f64> = right.iter().map(|c| c.re).chain(imaginary).collect();
        let mut factors = Factors::default();
        self.at.system.assemble(self.at.x)?;
        self.at.system.factor(form, Border::NONE, &mut factors)?;
        factors.solve(&mut parts);
        Ok((0..n).map(|i| c64::new(parts[i], if real { 0.0 } else { parts[n + i] })).collect())
    }
}
