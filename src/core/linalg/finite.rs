//! Finite eigenvalues of a pencil `A v = λ M v` with a mass matrix `M` that can be singular.
//!
//! A rank decision splits `Uᵀ M = (M₁, 0)` and `Uᵀ A = (A₁, A₂)` with an orthogonal matrix `U`. The
//! rows of `A₂` are algebraic equations: every eigenvector with a finite eigenvalue satisfies `A₂ v
//! = 0`. With an orthonormal basis `V` of the null space of `A₂`, the smaller pencil `(A₁ V, M₁ V)`
//! has the same finite eigenvalues. The reduction is repeated until `M` is regular (J. Demmel and B.
//! Kågström, ACM TOMS 19 (1993) 160), so that infinite eigenvalues of every index are removed and do
//! not become large finite eigenvalues by rounding errors.

use super::balance::balanced;
use super::border::Spectrum;
use super::pencil::multipliers;
use crate::core::failure::{Failure, finite};
use faer::linalg::solvers::Solve;
use faer::{Mat, MatRef};

/// Rounding: a singular value counts as zero if it is smaller than this, relative to the largest
/// entries of scaled rows and columns, which are 1.
const NO_RANK: f64 = 1e-12;

/// Rounding: an algebraic equation counts as zero if it is smaller than this, relative to `A`.
const ROUNDING: f64 = 1e-15;

/// Heuristic: the eigenvalues of `M⁻¹ A` are accurate if the condition number of the scaled matrix
/// `M` is at most this.
const WELL_CONDITIONED: f64 = 1e6;

/// The matrices `A` and `M` of a pencil.
type Pencil = (Mat<f64>, Mat<f64>);

/// Computes the finite eigenvalues `λ` of `A v = λ M v` for `n × n` matrices that are stored column
/// by column, each as (real part, imaginary part), starting with the rightmost.
///
/// # Errors
/// [`Failure::Undetermined`] if `A − λ M` is singular for every `λ`, [`Failure::NotFinite`] if an
/// entry is not finite, and [`Failure::Eigenvalues`] if the iteration does not converge.
///
/// ```
/// use tangency::core::linalg::finite_eigenvalues;
/// // 2 x' = y, 0 = x + 3 y: the eigenvalue is −1/6.
/// let spectrum = finite_eigenvalues(&[0.0, 1.0, 1.0, 3.0], &[2.0, 0.0, 0.0, 0.0], 2)?;
/// assert_eq!(spectrum.len(), 1);
/// assert!((spectrum[0].0 + 1.0 / 6.0).abs() < 1e-15 && spectrum[0].1 == 0.0);
/// # Ok::<(), tangency::core::failure::Failure>(())
/// ```
pub fn finite_eigenvalues(a: &[f64], m: &[f64], n: usize) -> Result<Spectrum, Failure> {
    for entries in [a, m] {
        finite(entries, |_| "an entry of a pencil".into(), "all entries must be finite")?;
    }
    let matrix = |entries| MatRef::from_column_major_slice(entries, n, n).to_owned();
    let (mut a, mut m): Pencil = (matrix(a), matrix(m));
    scale(&mut a, &mut m);
    while let Some(smaller) = reduced(&a, &m)? {
        (a, m) = smaller;
    }
    let mut eigenvalues = of_regular(&a, &m)?;
    eigenvalues.sort_by(|a, b| b.0.total_cmp(&a.0).then(b.1.total_cmp(&a.1)));
    Ok(eigenvalues)
}

/// Multiplies rows and columns of both matrices by common factors, powers of two, so that the
/// largest entry of each row and column of `M` is near 1; where `M` has only zeros, so that the
/// largest entry of `A` is near 1.
fn scale(a: &mut Mat<f64>, m: &mut Mat<f64>) {
    let n = a.nrows();
    let factor = |of_m: f64, of_a: f64| {
        let size = if of_m > 0.0 { of_m } else { of_a };
        if size > 0.0 { (-size.log2().round()).exp2() } else { 1.0 }
    };
    for j in 0..n {
        let factor = factor(m.col(j).norm_max(), a.col(j).norm_max());
        for i in 0..n {
            a[(i, j)] *= factor;
            m[(i, j)] *= factor;
        }
    }
    for i in 0..n {
        let factor = factor(m.row(i).norm_max(), a.row(i).norm_max());
        for j in 0..n {
            a[(i, j)] *= factor;
            m[(i, j)] *= factor;
        }
    }
}

/// Removes the algebraic equations of a pencil, with as many unknowns; `None` if `M` is regular.
fn reduced(a: &Mat<f64>, m: &Mat<f64>) -> Result<Option<Pencil>, Failure> {
    let n = m.nrows();
    let not_converged = |_| Failure::Eigenvalues("singular values of a mass matrix");
    let of_m = m.svd().map_err(not_converged)?;
    let rank = (0..n).filter(|k| of_m.S()[*k] > NO_RANK).count();
    if rank == n {
        return Ok(None);
    }
    let turned = of_m.U().transpose() * a;
    let mut algebraic = turned.subrows(rank, n - rank).to_owned();
    for i in 0..n - rank {
        let size = algebraic.row(i).norm_l2();
        if size > ROUNDING * a.norm_l2() {
            (0..n).for_each(|j| algebraic[(i, j)] /= size);
        }
    }
    let of_algebraic = algebraic.svd().map_err(not_converged)?;
    if (0..n - rank).any(|k| of_algebraic.S()[k] <= NO_RANK) {
        return Err(Failure::Undetermined(
            "the eigenvalues are not determined: the mass matrix and the algebraic equations do \
             not determine the motion (`F_z − λ M` is singular for every `λ`)"
                .into(),
        ));
    }
    let basis = of_algebraic.V().subcols(n - rank, rank);
    let of_m = of_m.U().transpose() * m;
    Ok(Some((turned.subrows(0, rank) * basis, of_m.subrows(0, rank) * basis)))
}

/// Computes the eigenvalues of a pencil with a regular matrix `M`.
fn of_regular(a: &Mat<f64>, m: &Mat<f64>) -> Result<Spectrum, Failure> {
    let n = a.nrows();
    if n == 0 {
        return Ok(Spectrum::new());
    }
    let unknown = Failure::Eigenvalues("eigenvalues");
    let sizes = m.singular_values().map_err(|_| unknown.clone())?;
    let [most, least] = [sizes[0], sizes[n - 1]];
    if most <= WELL_CONDITIONED * least {
        let quotient = m.partial_piv_lu().solve(a);
        let entries: Vec<f64> = (0..n * n).map(|k| quotient[(k % n, k / n)]).collect();
        let balanced = balanced(&entries, n);
        let found = MatRef::from_column_major_slice(&balanced, n, n).eigenvalues();
        return Ok(found.map_err(|_| unknown)?.into_iter().map(|l| (l.re, l.im)).collect());
    }
    let by_rows = |matrix: &Mat<f64>, sign: f64| -> Vec<f64> {
        (0..n * n).map(|k| sign * matrix[(k / n, k % n)]).collect()
    };
    let found = multipliers(&by_rows(a, -1.0), &by_rows(m, 1.0), n)?;
    Ok(found.into_iter().filter(|l| l.0.is_finite()).collect())
}
