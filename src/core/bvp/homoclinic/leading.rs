//! The leading eigenvalues of a saddle, and the components of an orbit in their directions: the test
//! functions of homoclinic orbits (A. R. Champneys, Yu. A. Kuznetsov and B. Sandstede,
//! *International Journal of Bifurcation and Chaos* 6:867, 1996).
//!
//! The Jacobian can have entries of any scalar type. Eigenvectors are computed from the real parts of
//! the entries, and the quotients `wᵀ A v / wᵀ v` are exact to first order in the derivatives.

use crate::core::scalar::Scalar;
use nalgebra::{DMatrix, DVector};
use std::array::from_fn;

/// A complex number.
pub(super) type Complex = (f64, f64);

/// Eigenvalues of a matrix with their eigenvectors.
pub(super) type Eigen = Vec<(Complex, Vec<Complex>)>;

/// Computes the eigenvalues and eigenvectors of a matrix that is given by its columns; `None` if
/// the iteration fails.
pub(super) fn eigen(matrix: &[f64], n: usize) -> Option<Eigen> {
    let matrix = faer::MatRef::from_column_major_slice(matrix, n, n);
    let found = matrix.eigen().ok()?;
    let vector = |k: usize| (0..n).map(|i| (found.U()[(i, k)].re, found.U()[(i, k)].im)).collect();
    let values = found.S().column_vector();
    Some((0..n).map(|k| ((values[k].re, values[k].im), vector(k))).collect())
}

/// One of the two hyperbolic subspaces of a saddle.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Side {
    /// The unstable subspace, in which orbits leave the saddle.
    Outgoing,
    /// The stable subspace, in which orbits approach the saddle.
    Incoming,
}

/// The eigenvalues of a matrix in descending order of their real parts, with right and left
/// eigenvectors.
pub(super) struct Leading<'m, T> {
    /// The entries of the matrix, column by column.
    matrix: &'m [T],
    right: Eigen,
    left: Eigen,
    /// The number of unstable eigenvalues at the reference equilibrium.
    unstable: usize,
}

impl<'m, T: Scalar> Leading<'m, T> {
    /// Computes the eigenvalues and eigenvectors; `None` if the eigenvalue iteration fails.
    pub fn new(matrix: &'m [T], n: usize, unstable: usize) -> Option<Self> {
        let real: Vec<f64> = matrix.iter().map(Scalar::real).collect();
        let transposed = DMatrix::from_column_slice(n, n, &real).transpose();
        let (mut right, mut known) = (eigen(&real, n)?, eigen(transposed.as_slice(), n)?);
        right.sort_by(|a, b| b.0.0.total_cmp(&a.0.0));
        let mut left = Vec::new();
        for (value, _) in &right {
            let off = |other: &Complex| f64::hypot(other.0 - value.0, other.1 - value.1);
            let near = |a: &usize, b: &usize| off(&known[*a].0).total_cmp(&off(&known[*b].0));
            let nearest = (0..known.len()).min_by(near)?;
            left.push(known.swap_remove(nearest));
        }
        Some(Leading { matrix, right, left, unstable })
    }

    /// Returns the index of the stable or unstable eigenvalue nearest to the imaginary axis (`next` =
    /// 0), or of the one `next` positions farther away.
    fn position(&self, side: Side, next: usize) -> Option<usize> {
        let at = match side {
            Side::Outgoing => self.unstable.checked_sub(1 + next)?,
            Side::Incoming => self.unstable + next,
        };
        (at < self.right.len()).then_some(at)
    }

    /// Returns the real part `Re wᵀ A v / wᵀ v` of the leading eigenvalue; at its zero, the equilibrium
    /// ceases to be a saddle.
    pub fn rate(&self, side: Side) -> Option<T> {
        Some(self.rate_at(self.position(side, 0)?))
    }

    fn rate_at(&self, at: usize) -> T {
        let (v, w) = (&self.right[at].1, &self.left[at].1);
        let times = |a: Complex, b: Complex| (a.0 * b.0 - a.1 * b.1, a.0 * b.1 + a.1 * b.0);
        let mut below = (0.0, 0.0);
        for (w, v) in w.iter().zip(v) {
            let product = times(*w, *v);
            below = (below.0 + product.0, below.1 + product.1);
        }
        let square = below.0 * below.0 + below.1 * below.1;
        let inverse = (below.0 / square, -below.1 / square);
        let mut sum = T::zero();
        for (column, v) in self.matrix.chunks_exact(w.len()).zip(v) {
            for (a, w) in column.iter().zip(w) {
                sum += *a * times(times(*w, *v), inverse).0;
            }
        }
        sum
    }

    /// Returns the squared difference of the two leading eigenvalues, negative if they are complex:
    /// `(m₁₁ − m₂₂)² + 4 m₁₂ m₂₁` for the matrix `M = (Wᵀ V)⁻¹ Wᵀ A V`, where `V` and `W` span the
    /// right and left invariant subspaces of the two eigenvalues. Returns `None` if the subspace
    /// has only one eigenvalue.
    pub fn discriminant(&self, side: Side) -> Option<T> {
        let [one, two] = [self.position(side, 0)?, self.position(side, 1)?];
        let (values, n) = ([self.right[one].0, self.right[two].0], self.left.len());
        if (values[0].1 == 0.0) != (values[1].1 == 0.0) {
            // The second eigenvalue belongs to a complex pair, with a different real part.
            let difference = self.rate_at(one) - self.rate_at(two);
            return Some(difference * difference);
        }
        let (v, w) = self.subspaces([one, two], n)?;
        let w = (w.transpose() * &v).try_inverse()? * w.transpose();
        let entry = |i: usize, j: usize| {
            let columns = self.matrix.chunks_exact(n).zip(v.column(j));
            columns.fold(T::zero(), |sum, (column, v)| {
                let image = column.iter().enumerate();
                image.fold(sum, |sum, (k, a)| sum + *a * (w[(i, k)] * v))
            })
        };
        let [[a, b], [c, d]] = from_fn(|i| from_fn(|j| entry(i, j)));
        Some((a - d) * (a - d) + b * c * 4.0)
    }

    /// Returns orthonormal bases of the right and the left invariant subspace of two eigenvalues,
    /// from the projector `1 − Σ v wᵀ / wᵀ v`, summed over all other eigenvalues, because the
    /// eigenvectors of two equal eigenvalues are parallel.
    fn subspaces(&self, pair: [usize; 2], n: usize) -> Option<(DMatrix<f64>, DMatrix<f64>)> {
        let mut projector = DMatrix::<f64>::identity(n, n);
        for k in (0..n).filter(|k| !pair.contains(k)) {
            let column = |of: &Eigen| {
                DVector::from_iterator(n, of[k].1.iter().map(|c| nalgebra::Complex::new(c.0, c.1)))
            };
            let (v, w) = (column(&self.right), column(&self.left));
            let size = w.dot(&v);
            projector -= (v * w.transpose() / size).map(|c| c.re);
        }
        let found = projector.svd(true, true);
        let (left, right) = (found.u?, found.v_t?.transpose());
        Some((left.columns(0, 2).into_owned(), right.columns(0, 2).into_owned()))
    }

    /// Returns the component `wᵀ y / |w|` of a deviation `y` along the leading eigenvector, where `w` is
    /// the left eigenvector; the orientation of the eigenvector is the one for which `reference` has a
    /// positive component. If the leading eigenvalues are complex, returns the size of the deviation's
    /// component in their plane.
    pub fn component(&self, side: Side, reference: &[f64], y: &[T]) -> Option<T> {
        let at = self.position(side, 0)?;
        let (value, w) = (self.right[at].0, &self.left[at].1);
        if value.1 != 0.0 {
            let part = |part: fn(&Complex) -> f64| {
                y.iter().zip(w).fold(T::zero(), |sum, (y, w)| sum + *y * part(w))
            };
            let (re, im) = (part(|c| c.0), part(|c| c.1));
            return Some((re * re + im * im).sqrt());
        }
        let w = self.left_vector(at, reference)?;
        Some(w.iter().zip(y).fold(T::zero(), |sum, (w, y)| sum + *w * *y))
    }

    /// Returns the left eigenvector of a real eigenvalue, of length 1, with derivatives: `w + h` with
    /// `wᵀ h = 0` and `(Aᵀ − λ) h = −(Aᵀ − λ) w`.
    fn left_vector(&self, at: usize, reference: &[f64]) -> Option<Vec<T>> {
        let n = self.left.len();
        let w = DVector::from_iterator(n, self.left[at].1.iter().map(|c| c.0)).normalize();
        let v = DVector::from_iterator(n, self.right[at].1.iter().map(|c| c.0)).normalize();
        let along: f64 = v.iter().zip(reference).map(|(v, r)| v * r).sum();
        let w = if along * w.dot(&v) < 0.0 { -w } else { w };
        let value = self.rate_at(at);
        let mut bordered = DMatrix::zeros(n + 1, n + 1);
        for (i, column) in self.matrix.chunks_exact(n).enumerate() {
            for (j, a) in column.iter().enumerate() {
                bordered[(i, j)] = a.real();
            }
            bordered[(i, i)] -= value.real();
            (bordered[(i, n)], bordered[(n, i)]) = (v[i], w[i]);
        }
        let inverse = bordered.try_inverse()?;
        let rest = |(i, column): (usize, &[T])| {
            let image = column.iter().zip(w.iter());
            image.fold(value * -w[i], |sum, (a, w)| sum + *a * *w)
        };
        let rest: Vec<T> = self.matrix.chunks_exact(n).enumerate().map(rest).collect();
        let corrected = |i: usize| {
            let terms = rest.iter().enumerate();
            terms.fold(T::constant(w[i]), |sum, (j, r)| sum - *r * inverse[(i, j)])
        };
        Some((0..n).map(corrected).collect())
    }

    /// Returns the eigenvector of the leading eigenvalue in the stable or the unstable subspace,
    /// oriented so that its largest component is positive. The returned vector is zero if the leading
    /// eigenvalue is complex.
    pub fn reference(&self, side: Side) -> Option<Vec<f64>> {
        let at = self.position(side, 0)?;
        let real = self.right[at].0.1 == 0.0;
        let v: Vec<f64> = self.right[at].1.iter().map(|c| if real { c.0 } else { 0.0 }).collect();
        let largest =
            v.iter().fold(0.0, |most: f64, c| if c.abs() > most.abs() { *c } else { most });
        Some(v.iter().map(|c| c * largest.signum()).collect())
    }
}
