//! The directions of the branches that cross at a branch point: the algebraic bifurcation equations.

use crate::core::condition::{At, Failure};
use crate::core::linear::Factors;
use crate::core::vector::{dot, generic, norm, normalise};
use crate::core::zero::{Border, Form};
use nalgebra::{DMatrix, DVector};

/// The null space of `J = [F_z  F_p]` where its rank is `n − m`, and of `Jᵀ`.
struct NullSpace {
    parameter: usize,
    /// `m + 1` directions of `x`.
    right: Vec<Vec<f64>>,
    /// `m` vectors.
    left: Vec<Vec<f64>>,
    factors: Factors,
}

/// Makes vectors orthonormal (Gram and Schmidt, twice).
fn orthonormal(vectors: &mut [Vec<f64>]) {
    for _ in 0..2 {
        for k in 0..vectors.len() {
            let (before, rest) = vectors.split_at_mut(k);
            for other in before.iter() {
                let overlap = dot(other, &rest[0]);
                rest[0].iter_mut().zip(other).for_each(|(v, o)| *v -= overlap * o);
            }
            normalise(&mut rest[0]);
        }
    }
}

impl NullSpace {
    /// Null vectors from a bordered matrix, whose borders are turned to them until they have settled.
    fn of(at: &mut At, parameter: usize, m: usize) -> Result<Self, Failure> {
        let (n, length) = (at.system.names().dimension(), at.x.len());
        let mut rows: Vec<Vec<f64>> = (0..=m).map(|k| generic(n + 1, 2 + k)).collect();
        let mut borders: Vec<Vec<f64>> = (0..m).map(|k| generic(n, 11 + k)).collect();
        let (right, left, factors) = Default::default();
        let mut space = NullSpace { parameter, right, left, factors };
        let mut direction = vec![0.0; length];
        direction[n + parameter] = 1.0;
        for _ in 0..4 {
            orthonormal(&mut rows);
            orthonormal(&mut borders);
            space.solve(at, &direction, &rows, &borders)?;
            for (row, right) in rows.iter_mut().zip(&space.right) {
                row[..n].copy_from_slice(&right[..n]);
                row[n] = right[n + parameter];
            }
            borders.clone_from(&space.left);
        }
        Ok(space)
    }

    fn solve(
        &mut self,
        at: &mut At,
        direction: &[f64],
        rows: &[Vec<f64>],
        borders: &[Vec<f64>],
    ) -> Result<(), Failure> {
        let (n, m) = (at.system.names().dimension(), borders.len());
        let width = m + 1;
        at.system.assemble(at.x)?;
        let mut columns = vec![0.0; n * width];
        at.system.derivative(at.x, &[direction], &mut columns[..n])?;
        columns[n..].copy_from_slice(&borders.concat());
        let of_z: Vec<f64> = rows.iter().flat_map(|row| &row[..n]).copied().collect();
        let mut corner = vec![0.0; width * width];
        (0..width).for_each(|k| corner[k * width] = rows[k][n]);
        let border = Border { width, columns: &columns, rows: &of_z, corner: &corner };
        at.system.factor(Form::Jacobian, border, &mut self.factors)?;
        let unit = |k: usize| {
            let mut unit = vec![0.0; n + width];
            unit[k] = 1.0;
            unit
        };
        self.right.clear();
        for k in 0..width {
            let mut solved = unit(n + k);
            self.factors.solve(&mut solved);
            let mut right = vec![0.0; at.x.len()];
            right[..n].copy_from_slice(&solved[..n]);
            right[n + self.parameter] = solved[n];
            self.right.push(right);
        }
        self.left.clear();
        for k in 0..m {
            let mut solved = unit(n + 1 + k);
            self.factors.solve_transposed(&mut solved);
            solved.truncate(n);
            self.left.push(solved);
        }
        Ok(())
    }

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

/// Forms that are smaller than this, compared with the second derivatives they are parts of, vanish but for rounding.
const VANISHES: f64 = 1e-9;

/// The tangents, as directions of `x`, of the branches that cross at a branch point where `m` eigenvalues vanish: the
/// directions `t = Σ αᵢ ζᵢ` in the null space of `[F_z  F_p]` that solve the algebraic bifurcation equations
///
/// ```text
///     Σ wⱼᵀ F_xx[ζᵢ, ζₖ] αᵢ αₖ = 0,    j = 1 … m
/// ```
///
/// (H. B. Keller, *Numerical solution of bifurcation and nonlinear eigenvalue problems*, 1977). For `m = 1` that is one
/// quadratic equation with two roots.
///
/// # Errors
/// [`Failure::Undetermined`] where it has no two real solutions: the point is isolated or
/// degenerate.
pub(crate) fn branches_at(
    mut at: At,
    parameter: usize,
    m: usize,
) -> Result<Vec<Vec<f64>>, Failure> {
    let space = NullSpace::of(&mut at, parameter, m)?;
    let (forms, size) = space.forms(&mut at)?;
    let largest = forms.iter().fold(0.0, |most: f64, form| most.max(form.amax()));
    let roots = match m {
        _ if largest <= VANISHES * size => Vec::new(),
        1 => quadratic(&forms[0]),
        _ => intersection(&forms),
    };
    if roots.len() < 2 {
        return Err(undetermined(&forms, m));
    }
    Ok(roots.iter().map(|root| space.direction(root)).collect())
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

/// The isolated real directions in which several quadratic forms vanish, by Newton's iteration on the unit sphere from
/// many directions.
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
