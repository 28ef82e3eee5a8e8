//! Floquet multipliers from the reduced equations of a condensed chain.
//!
//! A [`Chain`](super::chain::Chain) leaves `n` equations `P x_0 + Q x_N = 0` between its ends, which
//! determine the solutions of the linearised equations over a period. With `x_N = μ x_0`, these `n`
//! equations become a generalised eigenvalue problem:
//!
//! ```text
//!     (P + μ Q) v = 0
//! ```
//!
//! The eigenvalues `μ` are the Floquet multipliers. The transfer matrix `−Q⁻¹P` is not formed,
//! because its rounding errors would dominate the smallest multipliers (Fairgrieve & Jepson, SIAM
//! J. Numer. Anal. 28 (1991) 1446).

use super::border::Spectrum;
use crate::core::failure::{Failure, finite, not_finite};
use faer::MatRef;
use faer::linalg::solvers::{DenseSolveCore, Solve};

/// Heuristic: the smallest number of multipliers for which the QZ iteration is slow.
const MANY: usize = 16;

/// Heuristic: the QR iteration is accepted if the absolute errors of the multipliers are at most
/// this.
const UNHARMED: f64 = 1e-11;

/// Computes the Floquet multipliers `μ` of `P x_0 + Q x_N = 0`, each as (real part, imaginary
/// part): the eigenvalues of the pencil `P + μ Q` of `n × n` matrices (stored row by row), in
/// descending order of their modulus.
///
/// For `n ≤ 2` the multipliers are computed in closed form, to the accuracy of `P` and `Q`; from `n = 3`
/// on, they are computed by the QZ iteration, with a relative error of at most about `10⁻¹⁵ max(|μ|,
/// 1/|μ|)`: seven digits and more if `μ` is 10⁸ or 10⁻⁸. From `n = 16` on, they are computed as the
/// eigenvalues of `−Q⁻¹P` if the condition number of `Q` limits the errors to 10⁻¹¹.
///
/// A singular matrix `Q` gives infinite multipliers (`f64::INFINITY` as real part), and a singular
/// matrix `P` gives multipliers that are zero.
///
/// # Errors
/// [`Failure::Undetermined`] if `P + μ Q` is singular for every `μ`, [`Failure::NotFinite`] if `P`
/// or `Q` has an entry that is not finite, and [`Failure::Eigenvalues`] if the iteration does not
/// converge.
///
/// ```
/// use tangency::core::linalg::multipliers;
/// // x_1(T) = 10¹² x_1(0), and x_2(T) = 10⁻¹² x_2(0), each solved for its larger end.
/// let mu = multipliers(&[1.0, 0.0, 0.0, 1e-12], &[-1e-12, 0.0, 0.0, -1.0], 2)?;
/// assert!((mu[0].0 / 1e12 - 1.0).abs() < 1e-15 && (mu[1].0 / 1e-12 - 1.0).abs() < 1e-15);
/// # Ok::<(), tangency::core::failure::Failure>(())
/// ```
pub fn multipliers(p: &[f64], q: &[f64], n: usize) -> Result<Spectrum, Failure> {
    for entries in [p, q] {
        finite(entries, |_| "an entry of a pencil".into(), "all entries must be finite")?;
    }
    let mut multipliers = match n {
        0 => Vec::new(),
        1 => vec![(ratio(-p[0], q[0]), 0.0)],
        2 => quadratic(p, q),
        _ => general(p, q, n)?,
    };
    if multipliers.iter().any(|(re, im)| re.is_nan() || im.is_nan()) {
        return Err(undetermined());
    }
    // The largest modulus comes first; of a complex pair, the positive imaginary part.
    let modulus = |mu: &(f64, f64)| mu.0.hypot(mu.1);
    multipliers.sort_by(|a, b| modulus(b).total_cmp(&modulus(a)).then(b.1.total_cmp(&a.1)));
    Ok(multipliers)
}

/// Computes `a / b`; a nonzero `a` divided by zero gives `+∞`.
fn ratio(a: f64, b: f64) -> f64 {
    if b == 0.0 && a != 0.0 { f64::INFINITY } else { a / b }
}

/// Computes the roots of `det(P + μ Q) = a μ² + 2 b μ + c` for `2 × 2` matrices.
fn quadratic(p: &[f64], q: &[f64]) -> Spectrum {
    let determinant = |r: &[f64], s: &[f64]| difference_of_products(r[0], s[3], r[1], s[2]);
    let (a, b, c) =
        (determinant(q, q), 0.5 * (determinant(p, q) + determinant(q, p)), determinant(p, p));
    let discriminant = difference_of_products(b, b, a, c);
    if discriminant < 0.0 {
        let imaginary = ((-discriminant).sqrt() / a).abs();
        return vec![(-b / a, imaginary), (-b / a, -imaginary)];
    }
    // One root is computed without cancellation, the other by Vieta's formula.
    let larger = -(b + discriminant.sqrt().copysign(b));
    if larger == 0.0 {
        return vec![(ratio(-c, a), 0.0); 2];
    }
    vec![(ratio(larger, a), 0.0), (c / larger, 0.0)]
}

/// Computes `a d − b c` to nearly the last digit (Kahan; Jeannerod, Louvet & Muller 2013).
fn difference_of_products(a: f64, d: f64, b: f64, c: f64) -> f64 {
    let product = b * c;
    let error = (-b).mul_add(c, product);
    a.mul_add(d, -product) + error
}

/// Computes the multipliers by the QZ iteration, after scaling all rows to the same size.
fn general(p: &[f64], q: &[f64], n: usize) -> Result<Spectrum, Failure> {
    let (mut p, mut q) = (p.to_vec(), q.to_vec());
    for (p, q) in p.chunks_exact_mut(n).zip(q.chunks_exact_mut(n)) {
        let largest = p.iter().chain(q.iter()).fold(0.0, |m: f64, a| m.max(a.abs()));
        // Subnormal numbers lack digits and make the iteration return NaN.
        let scaled = |a: f64, by: f64| if (a / by).is_subnormal() { 0.0 } else { a / by };
        p.iter_mut().for_each(|a| *a = scaled(*a, -largest));
        q.iter_mut().for_each(|a| *a = scaled(*a, largest));
    }
    if not_finite(&p).or(not_finite(&q)).is_some() {
        return Err(undetermined());
    }
    let (p, q) = (MatRef::from_row_major_slice(&p, n, n), MatRef::from_row_major_slice(&q, n, n));
    if n >= MANY
        && let Some(found) = by_quotient(p, q)
    {
        return Ok(found);
    }
    let eigen = p.generalized_eigen(q).map_err(|_| Failure::Eigenvalues("multipliers"))?;
    let (above, below) = (eigen.S_a().column_vector(), eigen.S_b().column_vector());
    let quotient = |(a, b): (&faer::c64, &faer::c64)| match (a.norm(), b.norm()) {
        (a, 0.0) if a > 0.0 => (f64::INFINITY, 0.0),
        _ => ((a / b).re, (a / b).im),
    };
    Ok(above.iter().zip(below.iter()).map(quotient).collect())
}

/// Computes the eigenvalues of `−Q⁻¹P` by the QR iteration, which takes a tenth of the time of the
/// QZ iteration; `None` if the errors would not be small compared with 1.
fn by_quotient(p: MatRef<f64>, q: MatRef<f64>) -> Option<Spectrum> {
    let lu = q.partial_piv_lu();
    let (inverse, quotient) = (lu.inverse(), lu.solve(p));
    let condition = q.norm_l2() * inverse.norm_l2();
    let error = f64::EPSILON * condition * (1.0 + quotient.norm_l2());
    if error.is_nan() || error > UNHARMED {
        return None;
    }
    let found = quotient.eigenvalues().ok()?;
    Some(found.into_iter().map(|mu| (mu.re, mu.im)).collect())
}

/// Creates the error for a pencil `P + μ Q` that is singular for every multiplier `μ`.
pub(in crate::core) fn undetermined() -> Failure {
    Failure::Undetermined(
        "the Floquet multipliers are not determined to working accuracy: the linearisation over a \
         period has a row of zeros"
            .into(),
    )
}
