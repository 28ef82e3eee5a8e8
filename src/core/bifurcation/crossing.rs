//! The directions of the branches that cross at a branch point: the algebraic bifurcation
//! equations.

use super::at::At;
use super::null::NullVectors;
use crate::core::failure::Failure;
use crate::core::linalg::{Form, dot, generic, norm, normalise};
use nalgebra::{DMatrix, DVector};

impl NullVectors {
    /// The forms `wⱼᵀ F_xx[ζᵢ, ζₖ]`, and how large `F_xx[ζᵢ, ζₖ]` is.
    fn forms(&self, at: &mut At) -> Result<(Vec<DMatrix<f64>>, f64), Failure> {
        let count = self.right.len();
        let mut second = vec![0.0; at.system.names().dimension()];
        let mut forms = vec![DMatrix::zeros(count, count); self.left.len()];
        let mut size = 0.0_f64;
        for i in 0..count {
            for k in 0..=i {
                let directions = [&self.right[i][..], &self.right[k]];
                at.system.derivative(at.x, &directions, &mut second)?;
                size = size.max(norm(&second));
                for (form, left) in forms.iter_mut().zip(&self.left) {
                    let value = dot(left, &second) / norm(left);
                    (form[(i, k)], form[(k, i)]) = (value, value);
                }
            }
        }
        Ok((forms, size))
    }

    /// The direction `Σ aᵢ ζᵢ`, of length 1.
    fn direction(&self, a: &[f64]) -> Vec<f64> {
        let mut direction = vec![0.0; self.right[0].len()];
        for (a, right) in a.iter().zip(&self.right) {
            direction.iter_mut().zip(right).for_each(|(d, r)| *d += a * r);
        }
        normalise(&mut direction);
        direction
    }
}

/// Forms that are smaller than this, compared with the second derivatives they are parts of, vanish
/// but for rounding.
const VANISHES: f64 = 1e-9;

/// The tangents, as directions of `x`, of the branches that cross at a branch point where `m`
/// eigenvalues vanish: the directions `t = Σ αᵢ ζᵢ` in the null space of `[F_z  F_p]` that solve
/// the algebraic bifurcation equations
///
/// ```text
///     Σ wⱼᵀ F_xx[ζᵢ, ζₖ] αᵢ αₖ = 0,    j = 1 … m
/// ```
///
/// (H. B. Keller, *Numerical solution of bifurcation and nonlinear eigenvalue problems*, 1977). For
/// `m = 1` that is one quadratic equation with two roots.
///
/// # Errors
/// [`Failure::Undetermined`] where it has no two real solutions: the point is isolated or
/// degenerate.
pub(crate) fn branches_at(
    mut at: At,
    parameter: usize,
    m: usize,
) -> Result<Vec<Vec<f64>>, Failure> {
    let mut null = NullVectors::new(Form::Jacobian, Some(parameter));
    null.start(at.system, at.x, m)?;
    let (forms, size) = null.forms(&mut at)?;
    let largest = forms.iter().fold(0.0, |most: f64, form| most.max(form.amax()));
    let roots = match m {
        _ if largest <= VANISHES * size => Vec::new(),
        1 => quadratic(&forms[0]),
        _ => intersection(&forms),
    };
    if roots.len() < 2 {
        return Err(undetermined(&forms, m));
    }
    Ok(roots.iter().map(|root| null.direction(root)).collect())
}

/// (R) The part of `F_p` outside of the range of `F_z`, compared with `F_p` nearby, that is
/// rounding: at a special point which is known to 1e-10 the null vectors are good to more digits
/// than this.
const IN_RANGE: f64 = 1e-5;

/// Whether `F_p` lies in the range of `F_z` where `m` eigenvalues vanish: then branches cross
/// there, and otherwise the parameter turns. `beside` is a point near it.
pub(crate) fn parameter_in_range(
    at: At,
    beside: &[f64],
    (parameter, m): (usize, usize),
) -> Result<bool, Failure> {
    let At { system, x, .. } = at;
    let n = system.names().dimension();
    let (mut direction, mut slope) = (vec![0.0; x.len()], vec![0.0; n]);
    direction[n + parameter] = 1.0;
    system.derivative(beside, &[&direction], &mut slope)?;
    let largest = IN_RANGE * norm(&slope);
    let mut null = NullVectors::new(Form::Jacobian, None);
    null.start(system, x, m)?;
    system.derivative(x, &[&direction], &mut slope)?;
    Ok(null.left.iter().all(|left| dot(left, &slope).abs() <= largest * norm(left)))
}

fn undetermined(forms: &[DMatrix<f64>], m: usize) -> Failure {
    Failure::Undetermined(if m == 1 {
        let [a, b, c] = [(0, 0), (0, 1), (1, 1)].map(|k| forms[0][k]);
        format!(
            "the algebraic bifurcation equation {a:.3e} α² + 2·{b:.3e} αβ + {c:.3e} β² = 0 has no two \
             distinct real solutions: the branch point is isolated or degenerate, and no branch can be \
             switched to"
        )
    } else {
        format!(
            "the {m} algebraic bifurcation equations at this branch point of multiplicity {m} have no two isolated \
             real solutions: terms of third order decide which branches cross, and no branch can be switched to"
        )
    })
}

/// The two roots `(α, β)` of one equation, without cancellation.
fn quadratic(form: &DMatrix<f64>) -> Vec<Vec<f64>> {
    let [a, b, c] = [(0, 0), (0, 1), (1, 1)].map(|k| form[k]);
    let (discriminant, size) = (b * b - a * c, form.amax());
    if discriminant <= 1e-10 * size * size {
        return Vec::new();
    }
    // q = −(b + sign(b)√disc), roots (α : β) = (q : a) and (c : q).
    let q = -(b + discriminant.sqrt().copysign(b));
    vec![vec![q, a], vec![c, q]]
}

/// How many directions Newton's iteration starts from, for each unknown.
const STARTS: usize = 60;

/// The isolated real directions in which several quadratic forms vanish, by Newton's iteration on
/// the unit sphere from many directions.
fn intersection(forms: &[DMatrix<f64>]) -> Vec<Vec<f64>> {
    let count = forms.len() + 1;
    let mut roots: Vec<DVector<f64>> = Vec::new();
    for seed in 0..STARTS * count {
        let start = DVector::from_vec(generic(count, seed)) - DVector::repeat(count, 0.1);
        let Some(root) = polished(forms, start.normalize()) else { continue };
        if roots.iter().all(|other| other.dot(&root).abs() < 1.0 - 1e-9) {
            roots.push(root);
        }
    }
    roots.iter().map(|root| root.as_slice().to_vec()).collect()
}

/// A root near a direction, if it is isolated.
fn polished(forms: &[DMatrix<f64>], mut a: DVector<f64>) -> Option<DVector<f64>> {
    let count = a.len();
    let size = forms.iter().fold(0.0, |most: f64, form| most.max(form.amax()));
    for _ in 0..50 {
        let mut matrix = DMatrix::zeros(count, count);
        let mut residual = DVector::zeros(count);
        for (j, form) in forms.iter().enumerate() {
            let slope = form * &a;
            residual[j] = a.dot(&slope) / size;
            matrix.set_row(j, &(2.0 / size * slope.transpose()));
        }
        matrix.set_row(count - 1, &a.transpose());
        let lu = matrix.lu();
        let isolated = lu.u().diagonal().iter().all(|pivot| pivot.abs() > 1e-7);
        let correction = lu.solve(&residual)?;
        a -= &correction;
        a.normalize_mut();
        if correction.norm() < 1e-13 {
            return isolated.then_some(a);
        }
    }
    None
}
