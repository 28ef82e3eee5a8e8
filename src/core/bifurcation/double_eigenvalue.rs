//! Curves of critical pairs that begin at a double eigenvalue: curves of Hopf points begin at
//! Bogdanov–Takens points, and curves of torus points at resonances 1:1 and 1:2.

use super::at::At;
use super::defining_system::DefiningSystem;
use super::degenerate_fold::DegenerateFold;
use super::null::NullVectors;
use crate::core::failure::Failure;
use crate::core::linalg::{Border, Factors, Form, dot};
use crate::core::problem::Dynamics;
use crate::core::system::{Functional, Kind};

/// Whether a curve of critical pairs of the kind `pairs` begins at a special point of the kind
/// `point`, which has a double eigenvalue 0 or a double multiplier 1 or −1.
pub(crate) fn has_pairs_beside(point: Kind, pairs: Kind) -> bool {
    matches!((point, pairs), (Kind::BT, Kind::HB) | (Kind::R1 | Kind::R2, Kind::TR))
}

/// Computes `dx/d(ω²)` at `ω = 0` along the curve of points with the critical pair `σ₀ ± iω`; the
/// curve begins at the point where `σ₀` is a double eigenvalue. Two parameters must be released.
///
/// The multiplier `g` of the border of `L(σ₀ + s)` is
///
/// ```text
///     g = γ(x) + β(x) s + g₂ s² + g₃ s³ + …,    ∇γ = −∇(wᵀ F_z v),    ∇β = −∇(wᵀ L' v),
///     g₂ = −wᵀ L' v₁,    g₃ = −wᵀ (L' v₂ + ½ L'' v₁),
///     L v₁ = −L' v,      L v₂ = −(L' v₁ + ½ L'' v)    within the border,
/// ```
///
/// At the double eigenvalue, `γ = β = 0`; `L''' = L'' = L'` for orbits and `L'' = 0` for
/// equilibria. To first order in `ω²`, the border's multiplier `g` vanishes at `s = ±iω` if `γ = g₂
/// ω²` and `β = g₃ ω²`; the equations `F = 0` determine the other unknowns.
///
/// # Errors
/// [`Failure::Undetermined`] if the two released parameters do not unfold the double eigenvalue.
pub(crate) fn pairs_beside(at: &mut At, kind: Kind) -> Result<Vec<f64>, Failure> {
    let (n, length) = (at.system.names().dimension(), at.x.len());
    let &[one, other] = at.released else {
        return Err(Failure::Unsupported("two parameters must be released".into()));
    };
    let mut double = DegenerateFold::double(kind);
    let [mut of_beta, mut of_gamma] = [0; 2].map(|_| vec![0.0; length]);
    double.start(at.again(), &mut [])?;
    double.values(at.again(), &[], &mut [0.0])?;
    double.gradients(at.again(), &mut of_beta, &mut [])?;
    let At { system, x, released, null, .. } = at;
    let is_orbit = system.dynamics() == Dynamics::Periodic;
    let null = null.of(&mut **system, x, double.form(), None)?;
    system.gradient(
        x,
        Functional::First(&null.left[0], &null.right[0]),
        released,
        &mut of_gamma,
    )?;
    let [g2, g3] = multiplier(null, n, if is_orbit { 0.5 } else { 0.0 });
    let mut columns = vec![0.0; 2 * n];
    for (p, column) in [one, other].into_iter().zip(columns.chunks_exact_mut(n)) {
        let mut direction = vec![0.0; length];
        direction[n + p] = 1.0;
        system.derivative(x, &[&direction], column)?;
    }
    let rows = [&of_beta[..n], &of_gamma[..n]].concat();
    let corner = [&of_beta, &of_gamma].map(|of| [of[n + one], of[n + other]]).concat();
    let border = Border { width: 2, columns: &columns, rows: &rows, corner: &corner, units: &[] };
    let (mut factors, mut solved) = (Factors::default(), vec![0.0; n + 2]);
    system.assemble(x)?;
    let factored = system.factor(Form::Jacobian, border, &mut factors);
    (solved[n], solved[n + 1]) = (-g3, -g2);
    factored.map_err(|_| not_unfolded(kind))?;
    factors.solve(&mut solved);
    if solved.iter().any(|slope| !slope.is_finite()) {
        return Err(not_unfolded(kind));
    }
    let mut slope = vec![0.0; length];
    slope[..n].copy_from_slice(&solved[..n]);
    (slope[n + one], slope[n + other]) = (solved[n], solved[n + 1]);
    Ok(slope)
}

/// Computes the coefficients `g₂` and `g₃`; `bend` is the factor of `L'` in `½ L''`.
fn multiplier(null: &mut NullVectors, n: usize, bend: f64) -> [f64; 2] {
    let growth = |null: &NullVectors, v: &[f64]| {
        let mut out = vec![0.0; n];
        null.factors.growth_derivative(&v[..n], &mut out);
        out
    };
    let (left, first) = (null.left[0].clone(), growth(null, &null.right[0]));
    let mut next: Vec<f64> = first.iter().map(|f| -f).chain([0.0]).collect();
    null.factors.solve(&mut next);
    let second = growth(null, &next);
    let right = second.iter().zip(&first).map(|(s, f)| -s - bend * f);
    let mut last: Vec<f64> = right.chain([0.0]).collect();
    null.factors.solve(&mut last);
    let g2 = -dot(&left, &second);
    [g2, bend * g2 - dot(&left, &growth(null, &last))]
}

fn not_unfolded(kind: Kind) -> Failure {
    Failure::Undetermined(format!(
        "the two released parameters do not unfold the {}: the unfolding \
                                   is degenerate",
        kind.meaning()
    ))
}
