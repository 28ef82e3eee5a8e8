//! The lowest eigenvalue of `J v = ω² M v` and its derivative: vectors in `f64`, a Rayleigh quotient
//! in any arithmetic.

use crate::core::scalar::Scalar;
use nalgebra::{Cholesky, DMatrix, DVector, LU, Schur, SymmetricEigen};
use num_dual::{Dual, DualSVec64};

/// How many directions are differentiated at a time.
const CHUNK: usize = 8;

/// Left and right eigenvectors of the lowest eigenvalue (the same ones if `J` is symmetric).
pub(in crate::problems::plate) struct Lowest {
    pub left: Vec<f64>,
    pub right: Vec<f64>,
}

/// The Jacobian of `residual` at `z`.
pub(in crate::problems::plate) fn jacobian(
    z: &[f64],
    residual: impl Fn(&[DualSVec64<CHUNK>], &mut [DualSVec64<CHUNK>]),
) -> DMatrix<f64> {
    let n = z.len();
    let mut matrix = DMatrix::zeros(n, n);
    let mut point: Vec<_> = z.iter().map(|&value| DualSVec64::<CHUNK>::from(value)).collect();
    let mut values = point.clone();
    for first in (0..n).step_by(CHUNK) {
        let chunk = first..n.min(first + CHUNK);
        for j in chunk.clone() {
            point[j] = DualSVec64::from(z[j]).derivative(j - first);
        }
        residual(&point, &mut values);
        for j in chunk {
            for (i, value) in values.iter().enumerate() {
                matrix[(i, j)] = value.eps.0.map_or(0.0, |derivatives| derivatives[j - first]);
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
pub(in crate::problems::plate) fn lowest_symmetric(
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
pub(in crate::problems::plate) fn lowest_general(
    jacobian: &DMatrix<f64>,
    mass: &DMatrix<f64>,
) -> Option<Lowest> {
    let lower = Cholesky::new(mass.clone())?.l();
    let half = lower.solve_lower_triangular(jacobian)?;
    let reduced = lower.solve_lower_triangular(&half.transpose())?.transpose();
    if reduced.iter().any(|value| !value.is_finite()) {
        return None;
    }
    let eigenvalues = Schur::try_new(reduced.clone(), f64::EPSILON, 10_000)?.complex_eigenvalues();
    let lowest = eigenvalues.iter().min_by(|a, b| a.re.total_cmp(&b.re))?;
    if lowest.im.abs() > 1e-8 * lowest.re.abs() {
        return None;
    }
    // Off the eigenvalue by a little, so that the matrix of inverse iteration has an inverse.
    let shift = lowest.re - 1e-9 * (1.0 + lowest.re.abs());
    let shifted = &reduced - DMatrix::identity(reduced.nrows(), reduced.nrows()) * shift;
    let iterate = |factor: LU<f64, nalgebra::Dyn, nalgebra::Dyn>| -> Option<Vec<f64>> {
        let mut vector = DVector::from_element(reduced.nrows(), 1.0);
        for _ in 0..4 {
            vector = factor.solve(&vector)?.normalize();
        }
        Some(lower.transpose().solve_upper_triangular(&vector)?.as_slice().to_vec())
    };
    Some(Lowest {
        left: iterate(LU::new(shifted.transpose()))?,
        right: iterate(LU::new(shifted.clone()))?,
    })
}

/// `ℓᵀ F_z(z) r` in the arithmetic of `z`: one evaluation of the residual at `z + εr`.
pub(in crate::problems::plate) fn product<T: Scalar>(
    z: &[T],
    vectors: &Lowest,
    residual: impl Fn(&[Dual<T>], &mut [Dual<T>]),
) -> T {
    let point: Vec<_> =
        z.iter().zip(&vectors.right).map(|(&z, &r)| Dual::new(z, T::constant(r))).collect();
    let mut values = vec![Dual::new(T::zero(), T::zero()); z.len()];
    residual(&point, &mut values);
    values.iter().zip(&vectors.left).fold(T::zero(), |sum, (value, &l)| sum + value.eps * l)
}

/// `ω` where `ω² ≥ 0`, else `−√(−ω²)`: an unstable plate's rate of growth, below the axis.
pub(in crate::problems::plate) fn signed_root<T: Scalar>(square: T) -> T {
    if square.real() < 0.0 { -(-square).sqrt() } else { square.sqrt() }
}
