//! The division of the plane of two parameters by a curve of bifurcations: the solutions on each
//! side of the curve, computed from normal forms.

use super::crossing::{is_rounding, third};
use super::forms::{Forms, inner};
use super::has_rates;
use crate::core::bifurcation::at::At;
use crate::core::failure::Failure;
use crate::core::linalg::{Form, dot};

/// Rounding: a second derivative smaller than this threshold, relative to the terms of its sum, may
/// consist only of rounding or discretisation errors, as at a cusp.
const VANISHES: f64 = 1e-6;

/// The division of the plane of two parameters by a curve of bifurcations, at one point of the
/// curve.
#[derive(Debug)]
pub(crate) struct Division {
    /// A normal vector of the curve: the gradient of a function that depends on the two released
    /// parameters and is zero on the curve.
    pub normal: [f64; 2],
    /// The solutions on the side of the curve to which the normal points. Each entry is the number
    /// of unstable critical directions of one solution: the number of its unstable directions minus
    /// the number of its noncritical unstable directions.
    pub positive: &'static [usize],
    /// The solutions on the side opposite to the normal: the number of unstable critical directions
    /// of each solution.
    pub negative: &'static [usize],
}

/// A function that computes the division of the plane of two released parameters at a point of a
/// curve; `None` if the division is unknown.
///
/// # Errors
/// [`Failure`] if a derivative does not exist, or if a matrix is singular.
pub(crate) type ComputeDivision = fn(&mut At) -> Result<Option<Division>, Failure>;

/// Computes the gradient of a function with respect to the two released parameters: evaluates the
/// slope of the function in the unit direction of each parameter.
fn gradient(
    forms: &mut Forms,
    mut slope: impl FnMut(&mut Forms, Vec<f64>) -> Result<f64, Failure>,
) -> Result<[f64; 2], Failure> {
    let [first, second] = forms.of_parameters()?;
    Ok([slope(forms, first)?, slope(forms, second)?])
}

/// Computes the division of the parameter plane by a curve of folds. Solutions `z = z₀ + ξ q + …`
/// near a fold satisfy `p F_λ · δλ + ½ p B(q, q) ξ² = 0`. On the side of the curve where `−(p F_λ ·
/// δλ)/(p B(q, q)) > 0`, two solutions exist, with `n` and `n + 1` unstable directions; on the
/// other side, no solution exists near the fold.
pub(in crate::core::bifurcation) fn of_folds(at: &mut At) -> Result<Option<Division>, Failure> {
    let mut forms = Forms::new(at);
    let critical = forms.real(Form::Jacobian)?;
    let second = forms.of(&[&critical.right, &critical.right])?;
    let curvature = dot(&critical.left, &second);
    let terms: f64 = critical.left.iter().zip(&second).map(|(p, b)| (p * b).abs()).sum();
    if curvature.abs() <= VANISHES * terms {
        return Ok(None);
    }
    let normal = gradient(&mut forms, |forms, direction| {
        Ok(-curvature.signum() * dot(&critical.left, &forms.of(&[&direction])?))
    })?;
    Ok(Some(Division { normal, positive: &[0, 1], negative: &[] }))
}

/// Computes the division of the parameter plane by a curve of critical pairs. The normal is the
/// gradient of the growth rate `Re σ` of the pair, `σ_λ = p* B(q, z_λ)` with `p* L' q = −1`.
pub(in crate::core::bifurcation) fn of_pairs(at: &mut At) -> Result<Option<Division>, Failure> {
    let Some(&omega) = at.held.first() else { return Ok(None) };
    let mut forms = Forms::new(at);
    let [q, p] = forms.complex(omega)?;
    let normal = gradient(&mut forms, |forms, direction| {
        let along = forms.along_solutions(direction)?;
        Ok(inner(&p, &forms.along((&q, omega), &along)?).re)
    })?;
    Ok(Some(Division { normal, positive: &[2], negative: &[0] }))
}

/// Computes the division of the parameter plane by a curve of period doublings. The normal is the
/// gradient of the logarithm of the modulus of the critical multiplier.
pub(in crate::core::bifurcation) fn of_doublings(at: &mut At) -> Result<Option<Division>, Failure> {
    let mut forms = Forms::new(at);
    let critical = forms.real(Form::Antiperiodic)?;
    let normal = gradient(&mut forms, |forms, direction| {
        let along = forms.along_solutions(direction)?;
        let change = forms.of(&[&critical.right, &along])?;
        Ok(-dot(&critical.left, &change) / critical.growth)
    })?;
    Ok(Some(Division { normal, positive: &[1], negative: &[0] }))
}

/// Computes the division of the parameter plane by a curve of branch points.
pub(in crate::core::bifurcation) fn of_crossings(at: &mut At) -> Result<Option<Division>, Failure> {
    if !has_rates(at) {
        return Ok(None);
    }
    let mut forms = Forms::new(at);
    let critical = forms.real(Form::Jacobian)?;
    let (q, p) = (&critical.right, &critical.left);
    let second = forms.of(&[q, q])?;
    let terms = third(&mut forms, &critical, &second)?;
    let [first, other] = forms.of_parameters()?;
    let along = [forms.along_singular(first)?, forms.along_singular(other)?];
    let mixed = [dot(p, &forms.of(&[q, &along[0]])?), dot(p, &forms.of(&[q, &along[1]])?)];
    let square = forms.deviation(&[q], 0.0)?.square;
    if is_rounding((p, &second), terms, square) {
        return Ok(of_pitchforks(mixed.map(|mixed| -mixed / critical.growth), {
            terms.map(|term| -term / critical.growth)
        }));
    }
    let curvature = dot(p, &second);
    let mut form = |i: usize, k: usize| -> Result<f64, Failure> {
        let last = dot(p, &forms.of(&[&along[i], &along[k]])?);
        Ok(mixed[i] * mixed[k] - curvature * last)
    };
    Ok(of_transcritical_points([[form(0, 0)?, form(0, 1)?], [form(1, 0)?, form(1, 1)?]]))
}

/// Returns the division of the parameter plane by a curve of pitchforks. `normal` is the gradient
/// of the growth rate of the symmetric solution; the sign of the cubic coefficient determines the
/// side of the curve on which the asymmetric solutions exist.
fn of_pitchforks(normal: [f64; 2], cubic: [f64; 2]) -> Option<Division> {
    let rate = cubic[0] + cubic[1];
    let certain = rate.abs() > VANISHES * (cubic[0].abs() + cubic[1].abs());
    let (positive, negative): (&[usize], &[usize]) =
        if rate < 0.0 { (&[0, 0, 1], &[0]) } else { (&[1], &[0, 1, 1]) };
    certain.then_some(Division { normal, positive, negative })
}

/// Returns the division of the parameter plane by a curve of transcritical points. The discriminant
/// of the quadratic equation for `ξ` is a quadratic form in the two parameters. This quadratic form
/// is the square of a linear function, so two solutions exist on each side of the curve.
fn of_transcritical_points(discriminant: [[f64; 2]; 2]) -> Option<Division> {
    let [first, second] = discriminant;
    let normal = if first[0].abs() > second[1].abs() { first } else { second };
    let both: &[usize] = &[0, 1];
    let real = first[0] + second[1] > 0.0;
    real.then_some(Division { normal, positive: both, negative: both })
}
