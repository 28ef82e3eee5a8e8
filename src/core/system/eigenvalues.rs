//! All eigenvalues of a dense matrix `F_z`.

use crate::core::failure::Failure;
use crate::core::linalg::{Spectrum, balanced, finite_eigenvalues};
use crate::core::problem::Dynamics;
use faer::{MatRef, Side};

/// Computes all finite eigenvalues that decide stability, starting with the rightmost, from a matrix
/// `F_z` and a mass matrix that are stored column by column; without a mass matrix, the identity matrix.
pub(super) fn all_eigenvalues(
    (entries, mass): (&[f64], Option<&[f64]>),
    dynamics: Dynamics,
) -> Result<Spectrum, Failure> {
    let n = entries.len().isqrt();
    if let Some(mass) = mass {
        return finite_eigenvalues(entries, mass, n);
    }
    let unknown = Failure::Eigenvalues("eigenvalues");
    let self_adjoint = match dynamics {
        Dynamics::Potential => true,
        Dynamics::Flow => symmetric(entries, n),
        _ => false,
    };
    let mut eigenvalues: Spectrum = if self_adjoint {
        let matrix = MatRef::from_column_major_slice(entries, n, n);
        let real = matrix.self_adjoint_eigenvalues(Side::Lower).map_err(|_| unknown)?;
        real.into_iter().map(|l| (l, 0.0)).collect()
    } else {
        let balanced = balanced(entries, n);
        let matrix = MatRef::from_column_major_slice(&balanced, n, n);
        let found = matrix.eigenvalues().map_err(|_| unknown)?;
        found.into_iter().map(|l| (l.re, l.im)).collect()
    };
    if dynamics != Dynamics::Flow {
        eigenvalues.iter_mut().for_each(|l| l.0 = -l.0);
    }
    eigenvalues.sort_by(|a, b| b.0.total_cmp(&a.0).then(b.1.total_cmp(&a.1)));
    Ok(eigenvalues)
}

/// Whether a matrix is exactly symmetric, as for a discretised self-adjoint operator; eigenvalues
/// of symmetric matrices are much cheaper.
fn symmetric(matrix: &[f64], n: usize) -> bool {
    (0..n).all(|j| (0..j).all(|i| matrix[j * n + i] == matrix[i * n + j]))
}
