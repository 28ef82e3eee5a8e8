//! The lowest eigenvalue of `J v = ω² M v` and its derivative: vectors in `f64`, a Rayleigh quotient
//! in any arithmetic.

use crate::core::chunk::{CHUNK, Chunk, seeded};
use crate::core::scalar::Scalar;
use crate::core::zero::ZeroProblem;
use faer::Mat;
use nalgebra::{Cholesky, DMatrix, DVector, LU, SymmetricEigen};
use num_dual::Dual;

/// Left and right eigenvectors of the lowest eigenvalue (the same ones if `J` is symmetric).
pub(super) struct Lowest {
    pub left: Vec<f64>,
    pub right: Vec<f64>,
}

/// A residual `r` with an inertia: small vibrations about `r(z) = 0` are `J v = ω² M v`, `J = ∂r/∂z`.
pub(super) trait Vibrates: ZeroProblem {
    /// The eigenvectors of the lowest `ω²` about an equilibrium; `None` where values are not finite, or the
    /// lowest eigenvalue is not real.
    fn lowest(&self, z: &[f64], p: &[f64]) -> Option<Lowest>;

    /// `ℓᵀ M(z) r` of two vectors.
    fn inertia<T: Scalar>(&self, z: &[T], vectors: &Lowest) -> T;

    /// Rayleigh's quotient for `ω²` between two eigenvectors: stationary, so that its first derivatives
    /// are those of the eigenvalue.
    fn frequency_squared<T: Scalar>(&self, z: &[T], p: &[T], vectors: &Lowest) -> T
    where
        Self: Sized,
    {
        product(self, z, p, vectors) / self.inertia(z, vectors)
    }

    /// The lowest dimensionless `ω`, `−√(−ω²)` where unstable; not a number where there is none. Exact with
    /// its first derivatives; second ones leave out that the mode changes.
    fn frequency<T: Scalar>(&self, z: &[T], p: &[T]) -> T
    where
        Self: Sized,
    {
        match self.lowest(&reals(z), &reals(p)) {
            Some(vectors) => signed_root(self.frequency_squared(z, p, &vectors)),
            None => T::constant(f64::NAN),
        }
    }
}

/// The Jacobian `∂r/∂z` of a problem's residual.
pub(super) fn jacobian<P: ZeroProblem>(problem: &P, z: &[f64], p: &[f64]) -> DMatrix<f64> {
    let n = z.len();
    let mut matrix = DMatrix::zeros(n, n);
    let mut point: Vec<_> = z.iter().map(|&value| Chunk::from(value)).collect();
    let p: Vec<_> = p.iter().map(|&value| Chunk::from(value)).collect();
    let mut values = point.clone();
    for first in (0..n).step_by(CHUNK) {
        let chunk = first..n.min(first + CHUNK);
        for j in chunk.clone() {
            point[j] = seeded(z[j], j, first);
        }
        problem.residual(&point, &p, &mut values);
        for j in chunk {
            for (i, value) in values.iter().enumerate() {
                matrix[(i, j)] = value.eps[j - first];
            }
            point[j] = z[j].into();
        }
    }
    matrix
}

/// The eigenvector of the lowest `ω²` of `J v = ω² M v`, both symmetric, `M` positive definite.
///
/// Solved as `M v = μ (J + σM) v`, `ω² = 1/μ − σ`: the mass matrix of a polynomial basis is too badly
/// conditioned to be inverted. The shift `σ` is 0, or, for an unstable equilibrium, the first of
/// `scale·4ᵏ` that makes the matrix positive definite. `None` if the matrices are not finite.
pub(super) fn lowest_symmetric(
    jacobian: &DMatrix<f64>,
    mass: &DMatrix<f64>,
    scale: f64,
) -> Option<Lowest> {
    let mut shift = 0.0;
    for _ in 0..40 {
        if let Some(factor) = Cholesky::new(jacobian + mass * shift) {
            let lower = factor.l();
            let half = lower.solve_lower_triangular(mass)?;
            let reduced = lower.solve_lower_triangular(&half.transpose())?;
            let reduced = (&reduced + reduced.transpose()) * 0.5;
            if reduced.iter().any(|value| !value.is_finite()) {
                return None;
            }
            let eigen = SymmetricEigen::new(reduced);
            let vector = eigen.eigenvectors.column(eigen.eigenvalues.imax()).into_owned();
            let right = lower.transpose().solve_upper_triangular(&vector)?.as_slice().to_vec();
            return Some(Lowest { left: right.clone(), right });
        }
        shift = if shift == 0.0 { scale } else { shift * 4.0 };
    }
    None
}

/// Left and right eigenvectors of the `ω²` of smallest real part of `J v = ω² M v`, `M` symmetric and
/// positive definite, `J` any matrix. `None` if the matrices are not finite or that `ω²` is not real.
pub(super) fn lowest_general(jacobian: &DMatrix<f64>, mass: &DMatrix<f64>) -> Option<Lowest> {
    let n = mass.nrows();
    let reduced = Cholesky::new(mass.clone())?.solve(jacobian);
    if reduced.iter().any(|entry| !entry.is_finite()) {
        return None;
    }
    let eigenvalues = Mat::from_fn(n, n, |i, k| reduced[(i, k)]).eigenvalues().ok()?;
    let lowest = eigenvalues.iter().min_by(|a, b| a.re.total_cmp(&b.re))?;
    if lowest.im.abs() > 1e-8 * lowest.re.abs() {
        return None;
    }
    // Off the eigenvalue by a little, so that the matrix of inverse iteration has an inverse.
    let shifted = jacobian - mass * (lowest.re - 1e-9 * (1.0 + lowest.re.abs()));
    let iterate = |matrix: DMatrix<f64>| -> Option<Vec<f64>> {
        let factor = LU::new(matrix);
        // No symmetry that the vector sought might lack.
        let mut vector = DVector::from_fn(n, |i, _| 1.0 / (1.0 + i as f64));
        for _ in 0..4 {
            vector = factor.solve(&(mass * vector))?.normalize();
        }
        Some(vector.as_slice().to_vec())
    };
    Some(Lowest { left: iterate(shifted.transpose())?, right: iterate(shifted)? })
}

/// `ℓᵀ (∂r/∂z) r` in the arithmetic of `z`: one evaluation of the residual at `z + εr`.
fn product<P: ZeroProblem, T: Scalar>(problem: &P, z: &[T], p: &[T], vectors: &Lowest) -> T {
    let point: Vec<_> =
        z.iter().zip(&vectors.right).map(|(&z, &r)| Dual::new(z, T::constant(r))).collect();
    let p: Vec<_> = p.iter().map(|&value| Dual::from_re(value)).collect();
    let mut values = vec![Dual::new(T::zero(), T::zero()); z.len()];
    problem.residual(&point, &p, &mut values);
    values.iter().zip(&vectors.left).fold(T::zero(), |sum, (value, &l)| sum + value.eps * l)
}

/// `ω` where `ω² ≥ 0`, else `−√(−ω²)`: an unstable plate's rate of growth, below the axis.
pub(super) fn signed_root<T: Scalar>(square: T) -> T {
    if square.real() < 0.0 { -(-square).sqrt() } else { square.sqrt() }
}

/// The real parts of numbers.
pub(super) fn reals<T: Scalar>(x: &[T]) -> Vec<f64> {
    x.iter().map(Scalar::real).collect()
}
