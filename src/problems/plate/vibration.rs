//! Computes the lowest eigenvalue of `J v = ω² M v` and its derivative, from eigenvectors in `f64`
//! and a Rayleigh quotient in any scalar type.

use super::modes::{Eigenproblem, signed_root};
use crate::core::problem::{Dynamics, ZeroProblem};
use crate::core::scalar::{CHUNK, Chunk, Scalar, seeded};
use faer::Mat;
use nalgebra::{Cholesky, DMatrix, DVector, LU};
use num_dual::Dual;

/// The left and right eigenvectors of the lowest eigenvalue; they are equal if `J` is symmetric.
pub(super) struct Lowest {
    pub left: Vec<f64>,
    pub right: Vec<f64>,
}

/// A problem with a residual `r` and an inertia `M`: small vibrations about `r(z) = 0` satisfy `J v
/// = ω² M v`, where `J = ∂r/∂z`.
pub(super) trait Vibrates: ZeroProblem + Sized {
    /// Returns the inertia `M(z)`, which is symmetric and positive definite, stored column by
    /// column.
    fn mass(&self, z: &[f64]) -> Vec<f64>;

    /// Returns the value `ℓᵀ M(z) r` of the bilinear form of the inertia for two vectors.
    fn inertia<T: Scalar>(&self, z: &[T], vectors: &Lowest) -> T;

    /// Returns the Jacobian `J = ∂r/∂z`, stored column by column.
    fn stiffness(&self, z: &[f64], p: &[f64]) -> Vec<f64> {
        let n = z.len();
        let p: Vec<_> = p.iter().map(|p| Chunk::from(*p)).collect();
        let mut residual = vec![Chunk::from(0.0); n];
        let mut matrix = vec![0.0; n * n];
        for start in (0..n).step_by(CHUNK) {
            let point: Vec<_> = z.iter().enumerate().map(|(i, z)| seeded(*z, i, start)).collect();
            self.residual(&point, &p, &mut residual);
            for (i, value) in residual.iter().enumerate() {
                for (j, part) in (start..n).zip(value.eps) {
                    matrix[j * n + i] = part;
                }
            }
        }
        matrix
    }

    /// Returns the eigenvectors for the lowest squared frequency `ω²` of vibrations about an
    /// equilibrium; `None` if values are not finite or the lowest eigenvalue is not real.
    fn lowest(&self, z: &[f64], p: &[f64]) -> Option<Lowest> {
        let (stiffness, mass) = (self.stiffness(z, p), self.mass(z));
        if self.dynamics() != Dynamics::Potential {
            return lowest_general(&stiffness, &mass);
        }
        let right = Eigenproblem::new(mass).solved(&stiffness)?.lowest(1).shapes.pop()?;
        Some(Lowest { left: right.clone(), right })
    }

    /// Returns the Rayleigh quotient for the squared frequency `ω²` from the left and right
    /// eigenvectors; the quotient is stationary, so its first derivatives equal the first
    /// derivatives of the eigenvalue.
    fn frequency_squared<T: Scalar>(&self, z: &[T], p: &[T], vectors: &Lowest) -> T {
        product(self, z, p, vectors) / self.inertia(z, vectors)
    }

    /// Returns the lowest dimensionless frequency `ω`; `−√(−ω²)` if the equilibrium is unstable,
    /// NaN if the lowest eigenvalue is not real. The returned frequency and its first derivatives
    /// are exact; second derivatives neglect the change of the mode.
    fn frequency<T: Scalar>(&self, z: &[T], p: &[T]) -> T {
        match self.lowest(&reals(z), &reals(p)) {
            Some(vectors) => signed_root(self.frequency_squared(z, p, &vectors)),
            None => T::constant(f64::NAN),
        }
    }
}

/// Returns the left and right eigenvectors for the eigenvalue `ω²` of `J v = ω² M v` with the
/// smallest real part, for a symmetric positive definite `M` and any matrix `J`; `None` if the
/// matrices are not finite or this `ω²` is not real.
fn lowest_general(jacobian: &[f64], mass: &[f64]) -> Option<Lowest> {
    let n = mass.len().isqrt();
    let [jacobian, mass] =
        [jacobian, mass].map(|entries| DMatrix::from_column_slice(n, n, entries));
    let reduced = Cholesky::new(mass.clone())?.solve(&jacobian);
    if reduced.iter().any(|entry| !entry.is_finite()) {
        return None;
    }
    let eigenvalues = Mat::from_fn(n, n, |i, k| reduced[(i, k)]).eigenvalues().ok()?;
    let lowest = eigenvalues.iter().min_by(|a, b| a.re.total_cmp(&b.re))?;
    if lowest.im.abs() > 1e-8 * lowest.re.abs() {
        return None;
    }
    // A small shift from the eigenvalue keeps the matrix of inverse iteration invertible.
    let shifted = jacobian - &mass * (lowest.re - 1e-9 * (1.0 + lowest.re.abs()));
    let iterate = |matrix: DMatrix<f64>| -> Option<Vec<f64>> {
        let factor = LU::new(matrix);
        // The initial vector has no symmetry, so that it is generically not orthogonal to the
        // eigenvector.
        let mut vector = DVector::from_fn(n, |i, _| 1.0 / (1.0 + i as f64));
        for _ in 0..4 {
            vector = factor.solve(&(&mass * vector))?.normalize();
        }
        Some(vector.as_slice().to_vec())
    };
    Some(Lowest { left: iterate(shifted.transpose())?, right: iterate(shifted)? })
}

/// Computes `ℓᵀ (∂r/∂z) v` for two vectors `ℓ` and `v`, in the scalar type of `z`, by one
/// evaluation of the residual `r` at `z + εv`.
fn product<P: ZeroProblem, T: Scalar>(problem: &P, z: &[T], p: &[T], vectors: &Lowest) -> T {
    let point: Vec<_> =
        z.iter().zip(&vectors.right).map(|(&z, &r)| Dual::new(z, T::constant(r))).collect();
    let p: Vec<_> = p.iter().map(|&value| Dual::from_re(value)).collect();
    let mut values = vec![Dual::new(T::zero(), T::zero()); z.len()];
    problem.residual(&point, &p, &mut values);
    values.iter().zip(&vectors.left).fold(T::zero(), |sum, (value, &l)| sum + value.eps * l)
}

/// Returns the real parts of a list of numbers.
pub(super) fn reals<T: Scalar>(x: &[T]) -> Vec<f64> {
    x.iter().map(Scalar::real).collect()
}
