//! The directions of the branches that cross at a branch point, from the algebraic bifurcation
//! equations (H. B. Keller, 1977).

use super::at::At;
use super::null::NullVectors;
use crate::core::failure::Failure;
use crate::core::linalg::{Form, dot, generic};
use crate::core::numerics::{isolated_root, starting_direction};
use nalgebra::{DMatrix, DVector};

impl NullVectors {
    /// Computes the quadratic forms `wⱼᵀ F_xx[ζᵢ, ζₖ]` and the size of their largest term.
    fn forms(&self, at: &mut At) -> Result<(Vec<DMatrix<f64>>, f64), Failure> {
        let count = self.right.len();
        let mut second = vec![0.0; at.system.names().dimension()];
        let mut forms = vec![DMatrix::zeros(count, count); self.left.len()];
        let mut size = 0.0_f64;
        for i in 0..count {
            for k in 0..=i {
                let directions = [&self.right[i][..], &self.right[k]];
                at.system.derivative(at.x, &directions, &mut second)?;
                for (form, left) in forms.iter_mut().zip(&self.left) {
                    let terms = left.iter().zip(&second).map(|(w, s)| (w * s).abs());
                    size = size.max(terms.fold(0.0, f64::max));
                    let value = dot(left, &second);
                    (form[(i, k)], form[(k, i)]) = (value, value);
                }
            }
        }
        Ok((forms, size))
    }

    /// Computes the direction `Σ aᵢ ζᵢ`, with rounding errors set to zero.
    fn direction(&mut self, at: &mut At, a: &[f64]) -> Result<Vec<f64>, Failure> {
        let mut direction = vec![0.0; at.x.len()];
        for (a, right) in a.iter().zip(&self.right) {
            direction.iter_mut().zip(right).for_each(|(d, r)| *d += a * r);
        }
        self.clear_rounding(&mut *at.system, at.x, &mut direction)?;
        Ok(direction)
    }
}

/// Rounding: a quadratic form, which is a sum of second derivatives, counts as zero if it is
/// smaller than this factor times the largest term of the sum.
const VANISHES: f64 = 1e-9;

/// Returns the tangents, as directions of `x`, of the branches that cross at a branch point where
/// `m` eigenvalues vanish: the directions `t = Σ αᵢ ζᵢ` in the null space of `[F_z  F_p]` that
/// solve the algebraic bifurcation equations
///
/// ```text
///     Σ wⱼᵀ F_xx[ζᵢ, ζₖ] αᵢ αₖ = 0,    j = 1 … m
/// ```
///
/// (H. B. Keller, *Numerical solution of bifurcation and nonlinear eigenvalue problems*, 1977). For
/// `m = 1` the algebraic bifurcation equations are one quadratic equation with two roots.
///
/// # Errors
/// [`Failure::Undetermined`] if the algebraic bifurcation equations do not have two isolated real
/// solutions: the branch point is isolated or degenerate.
pub(crate) fn branches_at(
    mut at: At,
    parameter: usize,
    m: usize,
) -> Result<Vec<Vec<f64>>, Failure> {
    let mut null = NullVectors::new(Form::Jacobian, Some(parameter));
    null.start(at.system, at.x, (m, at.null.units()))?;
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
    roots.iter().map(|root| null.direction(&mut at, root)).collect()
}

/// Rounding: `F_p` counts as lying in the range of `F_z` if its component outside this range is
/// smaller than this factor times the size of `F_p`, at a nearby point or where the unknowns change by
/// their sizes. At a special point that is located to 1e-10, the relative error of the null vectors is
/// smaller than this factor.
const IN_RANGE: f64 = 1e-5;

/// Whether `F_p` lies in the range of `F_z` at a point where `m` eigenvalues vanish. Branches cross
/// at the point if `F_p` lies in the range of `F_z`; otherwise the branch has a fold at the point.
/// `beside` is a nearby point.
pub(crate) fn parameter_in_range(
    at: At,
    beside: &[f64],
    (parameter, m): (usize, usize),
) -> Result<bool, Failure> {
    let At { system, x, null: known, .. } = at;
    let n = system.names().dimension();
    let (mut direction, mut slope) = (vec![0.0; x.len()], vec![0.0; n]);
    direction[n + parameter] = 1.0;
    system.derivative(beside, &[&direction], &mut slope)?;
    let nearby = slope.clone();
    // In a symmetric state `F_p` may vanish. The threshold then follows from the change of `F_p` that
    // changes of the unknowns by their sizes cause, so that errors of the state do not decide the kind.
    let mut sizes = generic(n, 3);
    for (size, unit) in sizes.iter_mut().zip(known.sizes(n)).filter(|(_, unit)| **unit > 0.0) {
        *size *= unit;
    }
    sizes.resize(x.len(), 0.0);
    let mut changed = vec![0.0; n];
    if system.derivative(x, &[&direction, &sizes], &mut changed).is_err() {
        changed.fill(0.0);
    }
    let mut null = NullVectors::new(Form::Jacobian, None);
    null.start(system, x, (m, known.units()))?;
    system.derivative(x, &[&direction], &mut slope)?;
    let terms = |left: &[f64], f: &[f64]| left.iter().zip(f).map(|(w, f)| (w * f).abs()).sum();
    let size = |left: &[f64]| f64::max(terms(left, &nearby), terms(left, &changed));
    Ok(null.left.iter().all(|left| dot(left, &slope).abs() <= IN_RANGE * size(left)))
}

/// Rounding: the coefficient `b₃` is zero if the coefficient is smaller than this fraction of the
/// derivative of third order after a change of the parameter.
const NO_CUBIC: f64 = 1e-10;

/// Computes the arclength `s` after which the parameter has changed by `distance` along a branch
/// that emanates vertically, in a given direction, from a branch point. The parameter changes by `p
/// = b₃ s²/b₁ + …`, where
///
/// ```text
///     b₁ = wᵀ F_xx[t, e_p],   b₃ = −wᵀ (F_xxx[t, t, t] + 3 F_xx[t, y])/6,   J y = −F_xx[t, t].
/// ```
///
/// The arclength is computed with each left null vector, and the smallest one is returned; `None`
/// if the arclength is infinite or undefined for all left null vectors.
pub(crate) fn vertical_reach(
    at: At,
    (parameter, m): (usize, usize),
    distance: f64,
    direction: &[f64],
) -> Result<Option<f64>, Failure> {
    let At { system, x, null: known, .. } = at;
    let n = system.names().dimension();
    let mut null = NullVectors::new(Form::Jacobian, Some(parameter));
    null.start(system, x, (m, known.units()))?;
    let (mut along_p, mut bend) = (vec![0.0; x.len()], vec![0.0; x.len()]);
    along_p[n + parameter] = 1.0;
    let mut second = vec![0.0; n + m + 1];
    system.derivative(x, &[direction, direction], &mut second[..n])?;
    null.factors.solve(&mut second);
    bend[..n].copy_from_slice(&second[..n]);
    bend[n + parameter] = second[n];
    let [mut third, mut mixed, mut cross] = [0; 3].map(|_| vec![0.0; n]);
    system.derivative(x, &[direction, direction, direction], &mut third)?;
    system.derivative(x, &[direction, &bend], &mut mixed)?;
    system.derivative(x, &[direction, &along_p], &mut cross)?;
    let (mut beside, mut changed) = (x.to_vec(), vec![0.0; n]);
    beside[n + parameter] += distance;
    system.derivative(&beside, &[direction, direction, direction], &mut changed)?;
    let reach = |left: &Vec<f64>| {
        let cubic = dot(left, &third) - 3.0 * dot(left, &mixed);
        let is_zero = cubic.abs() <= NO_CUBIC * dot(left, &changed).abs();
        let square = 6.0 * distance * dot(left, &cross) / cubic;
        if is_zero { f64::INFINITY } else { square.abs().sqrt() }
    };
    let known = null.left.iter().map(reach).filter(|reach| reach.is_finite() && *reach > 0.0);
    Ok(known.reduce(f64::min))
}

fn undetermined(forms: &[DMatrix<f64>], m: usize) -> Failure {
    Failure::Undetermined(if m == 1 {
        let [a, b, c] = [(0, 0), (0, 1), (1, 1)].map(|k| forms[0][k]);
        format!(
            "the algebraic bifurcation equation {a:.3e} α² + 2·{b:.3e} αβ + {c:.3e} β² = 0 has no \
             two distinct real solutions: the branch point is isolated or degenerate, and \
             switching to another branch is impossible"
        )
    } else {
        format!(
            "the {m} algebraic bifurcation equations at this branch point of multiplicity {m} have \
             no two isolated real solutions: third-order terms determine the crossing branches, \
             and switching to another branch is not supported"
        )
    })
}

/// Computes the two roots `(α, β)` of one quadratic equation, without cancellation.
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

/// The number of starting directions of Newton's method per unknown.
const STARTS: usize = 60;

/// Computes the isolated real directions in which several quadratic forms vanish.
fn intersection(forms: &[DMatrix<f64>]) -> Vec<Vec<f64>> {
    let count = forms.len() + 1;
    let size = forms.iter().fold(0.0, |most: f64, form| most.max(form.amax()));
    let linearised = |a: &DVector<f64>| {
        let (mut residual, mut matrix) = (DVector::zeros(count), DMatrix::zeros(count, count));
        for (j, form) in forms.iter().enumerate() {
            let slope = form * a;
            residual[j] = a.dot(&slope) / size;
            matrix.set_row(j, &(2.0 / size * slope.transpose()));
        }
        residual[count - 1] = 0.5 * (a.norm_squared() - 1.0);
        matrix.set_row(count - 1, &a.transpose());
        (residual, matrix)
    };
    let mut roots: Vec<DVector<f64>> = Vec::new();
    for seed in 0..STARTS * count {
        let Some(root) = isolated_root(starting_direction(count, seed), linearised) else {
            continue;
        };
        if roots.iter().all(|other| other.dot(&root).abs() < 1.0 - 1e-9) {
            roots.push(root);
        }
    }
    roots.iter().map(|root| root.as_slice().to_vec()).collect()
}
