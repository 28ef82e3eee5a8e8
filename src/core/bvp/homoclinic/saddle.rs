//! The equilibrium of a homoclinic orbit, its invariant subspaces, and its eigenvalues.

use super::leading::{Leading, Side, eigen};
use crate::core::failure::Failure;
use crate::core::problem::{FieldIn, WIDTH, Wide};
use crate::core::scalar::Scalar;
use nalgebra::{DMatrix, DVector};

/// Rounding: an eigenvalue counts as non-hyperbolic if the absolute value of its real part is at
/// most this fraction of the size of the matrix.
const HYPERBOLIC: f64 = 1e-8;

/// Rounding: a vector counts as linearly dependent on earlier vectors if, after orthogonalisation,
/// its remainder is shorter than this length.
const DEPENDENT: f64 = 1e-6;

/// Heuristic: the largest distance between an equilibrium and the slowest point of the orbit, in
/// units of the states' ranges, for which the equilibrium counts as near the orbit.
const BESIDE: f64 = 0.5;

/// Rounding: Newton's iteration for an equilibrium counts as converged if its last step is shorter
/// than this length, in units of the states' ranges.
const CONVERGED: f64 = 1e-6;

/// Heuristic: the largest number of Newton iterations for an equilibrium.
const ITERATIONS: usize = 30;

/// An equilibrium with orthonormal frames of its invariant subspaces.
pub(super) struct Saddle {
    /// The equilibrium.
    pub place: Vec<f64>,
    /// The extents of the orbit (the ranges of its states), used as units of deviations.
    pub sizes: Vec<f64>,
    /// The unit of rates: the size of the Jacobian.
    pub rate: f64,
    /// The unstable subspace, in which orbits leave the equilibrium.
    pub outgoing: Frame,
    /// The stable subspace, in which orbits approach the equilibrium.
    pub incoming: Frame,
    /// The eigenvectors of the leading unstable and the leading stable eigenvalue.
    pub directions: [Vec<f64>; 2],
}

/// An orthonormal frame: the columns of `B` span an invariant subspace at the reference
/// equilibrium, and the columns of `C` span the complement of this subspace.
pub(super) struct Frame {
    pub basis: Vec<Vec<f64>>,
    complement: Vec<Vec<f64>>,
    /// The rows of a matrix `R` that gives the components of a deviation along unit eigenvectors.
    /// Distances in the subspace are measured as `|R y|`: the linear flow changes `|R y|`
    /// monotonically, whereas Euclidean distances rise and fall if the flow spirals.
    ball: Vec<Vec<f64>>,
}

impl Frame {
    /// Creates the frame of the subspace that eigenvectors span; complex eigenvectors are given by
    /// their real and imaginary parts.
    fn spanned(vectors: &[Vec<f64>], n: usize) -> Frame {
        let units = (0..n).map(|i| (0..n).map(|j| f64::from(u8::from(i == j))).collect());
        let mut all: Vec<Vec<f64>> = Vec::new();
        let mut basis = 0;
        for (k, vector) in vectors.iter().cloned().chain(units).enumerate() {
            let vector: Vec<f64> = vector;
            let mut left = DVector::from_vec(vector).normalize();
            // Two passes give full accuracy.
            for _ in 0..2 {
                for known in &all {
                    let known = DVector::from_column_slice(known);
                    left -= &known * known.dot(&left);
                }
            }
            let size = left.norm();
            if size > DEPENDENT && all.len() < n {
                all.push((left / size).as_slice().to_vec());
                basis += usize::from(k < vectors.len());
            }
        }
        let complement = all.split_off(basis);
        let ball = components(&all, vectors).unwrap_or_else(|| all.clone());
        Frame { basis: all, complement, ball }
    }

    /// Computes `Bᵀ A B`: the matrix of the linear flow in the subspace at the reference
    /// equilibrium.
    pub fn within(&self, matrix: &[f64]) -> DMatrix<f64> {
        let (n, k) = (self.basis[0].len(), self.basis.len());
        let basis = DMatrix::from_fn(n, k, |i, j| self.basis[j][i]);
        basis.transpose() * DMatrix::from_column_slice(n, n, matrix) * basis
    }

    /// Returns the length of a deviation in the subspace; in one dimension, returns the signed
    /// component. Lengths and signed components are homogeneous functions of the deviation, so that
    /// Newton's iteration converges even from points much farther away than the required distance.
    pub fn distance<T: Scalar>(&self, y: &[T]) -> T {
        if let [row] = &self.ball[..] {
            return dot(row, y);
        }
        let square = self.ball.iter().map(|row| dot(row, y));
        square.fold(T::zero(), |sum, part| sum + part * part).sqrt()
    }

    /// Returns the number of entries of the matrix `Z`.
    pub fn coordinates(&self) -> usize {
        self.basis.len() * self.complement.len()
    }

    /// Computes `L y` for a deviation `y`, with `L = Cᵀ + Z Bᵀ`.
    pub fn project<T: Scalar>(&self, z: &[T], y: &[T]) -> Vec<T> {
        let along = |column: &Vec<f64>| dot(column, y);
        let within: Vec<T> = self.basis.iter().map(along).collect();
        let across = self.complement.iter().map(along).zip(z.chunks(self.basis.len()));
        let sum = |(across, z): (T, &[T])| {
            z.iter().zip(&within).fold(across, |sum, (z, part)| sum + *z * *part)
        };
        across.map(sum).collect()
    }

    /// Computes `L A N` for a matrix `A` given by its columns, with `N = B − C Z`, and writes it
    /// into `out`.
    pub fn invariance<T: Scalar>(&self, z: &[T], matrix: &[T], out: &mut [T]) {
        let (n, k) = (self.basis[0].len(), self.basis.len());
        for (j, basis) in self.basis.iter().enumerate() {
            let mut image = vec![T::zero(); n];
            for (b, column) in matrix.chunks_exact(n).enumerate() {
                let of_z = |sum: T, (i, c): (usize, &Vec<f64>)| sum - z[i * k + j] * c[b];
                let start = T::constant(basis[b]);
                let direction = self.complement.iter().enumerate().fold(start, of_z);
                image.iter_mut().zip(column).for_each(|(sum, a)| *sum += *a * direction);
            }
            for (i, value) in self.project(z, &image).into_iter().enumerate() {
                out[i * k + j] = value;
            }
        }
    }
}

/// Computes the rows of the matrix `(Bᵀ V)⁻¹ Bᵀ`, which gives the components of a vector along the
/// columns of `V`; these columns must lie in the span of an orthonormal basis `B`. Returns `None`
/// if the columns of `V` are linearly dependent.
fn components(basis: &[Vec<f64>], vectors: &[Vec<f64>]) -> Option<Vec<Vec<f64>>> {
    let (n, k) = (basis.first()?.len(), basis.len());
    let matrix = |columns: &[Vec<f64>]| DMatrix::from_fn(n, columns.len(), |i, j| columns[j][i]);
    let basis = matrix(basis);
    let square = basis.tr_mul(&matrix(vectors));
    let rows = square.is_square().then(|| square.try_inverse())?? * basis.transpose();
    Some((0..k).map(|i| rows.row(i).iter().copied().collect()).collect())
}

fn dot<T: Scalar>(column: &[f64], y: &[T]) -> T {
    column.iter().zip(y).fold(T::zero(), |sum, (c, y)| sum + *y * *c)
}

/// Computes the vector field at a state, and its Jacobian column by column, with states in units of
/// their ranges and rates in the unit of rates.
pub(super) fn jacobian<T: Scalar>(
    field: &impl FieldIn<T>,
    x: &[T],
    q: &[T],
    saddle: &Saddle,
) -> (Vec<T>, Vec<T>) {
    let Saddle { sizes, rate, .. } = saddle;
    let (f, mut columns) = slopes(field, x, q);
    let n = x.len();
    let value = |(f, size): (&T, &f64)| *f / (size * rate);
    let f = f.iter().zip(sizes).map(value).collect();
    for (j, column) in columns.chunks_exact_mut(n).enumerate() {
        let units = sizes.iter().map(|size| sizes[j] / (size * rate));
        column.iter_mut().zip(units).for_each(|(a, unit)| *a *= unit);
    }
    (f, columns)
}

/// Computes the vector field at a state, and its Jacobian column by column.
fn slopes<T: Scalar>(field: &impl FieldIn<T>, x: &[T], q: &[T]) -> (Vec<T>, Vec<T>) {
    let (n, zero) = (x.len(), Wide::of(T::zero()));
    let q: Vec<Wide<T>> = q.iter().map(|q| Wide::of(*q)).collect();
    let (mut columns, mut f) = (vec![T::zero(); n * n], vec![zero; n]);
    for first in (0..n).step_by(WIDTH) {
        let seeded = |(i, x): (usize, &T)| match i.checked_sub(first) {
            Some(direction) if direction < WIDTH => Wide::seeded(*x, direction),
            _ => Wide::of(*x),
        };
        let x: Vec<Wide<T>> = x.iter().enumerate().map(seeded).collect();
        field.wide_slope(zero, &x, &q, &mut f);
        for (i, f) in f.iter().enumerate() {
            (first..n).zip(f.eps).for_each(|(j, part)| columns[j * n + i] = part);
        }
    }
    (f.iter().map(|f| f.re).collect(), columns)
}

impl Saddle {
    /// Finds an equilibrium by Newton's iteration from a given state, and computes its invariant
    /// subspaces.
    ///
    /// # Errors
    /// [`Failure::Mismatch`] if no equilibrium is near the given state, or if the equilibrium is
    /// not a hyperbolic saddle.
    pub fn near(
        field: &impl FieldIn<f64>,
        place: &[f64],
        q: &[f64],
        sizes: Vec<f64>,
    ) -> Result<Saddle, Failure> {
        let none = |reason: String| {
            Failure::Mismatch(format!(
                "a branch of homoclinic orbits cannot start at this \
                                       solution: {reason}"
            ))
        };
        let (n, mut x, mut last) = (place.len(), place.to_vec(), f64::NAN);
        for _ in 0..ITERATIONS {
            let (f, columns) = slopes(field, &x, q);
            let matrix = DMatrix::from_vec(n, n, columns);
            let way = matrix.lu().solve(&DVector::from_vec(f));
            let way = way.ok_or_else(|| {
                none(
                    "the Jacobian matrix near the slowest point of the \
                                              orbit is singular"
                        .into(),
                )
            })?;
            x.iter_mut().zip(way.iter()).for_each(|(x, way)| *x -= way);
            last =
                way.iter().zip(&sizes).map(|(way, size)| (way / size).powi(2)).sum::<f64>().sqrt();
        }
        if last.is_nan() || last > CONVERGED {
            return Err(none(format!(
                "Newton's iteration for the equilibrium does not converge: the length of its last \
                 step is {last:.1e} of the orbit's extent"
            )));
        }
        let far =
            x.iter().zip(place).zip(&sizes).map(|((x, from), size)| ((x - from) / size).abs());
        let far = far.fold(0.0, |most: f64, way| if way.is_nan() { way } else { most.max(way) });
        if far.is_nan() || far >= BESIDE {
            return Err(none(format!(
                "Newton's iteration converges to an equilibrium too far from the orbit: the \
                 distance from the orbit's slowest point is {far:.1e} times the orbit's extent"
            )));
        }
        let empty = || Frame::spanned(&[], n);
        let (outgoing, incoming) = (empty(), empty());
        let directions = [Vec::new(), Vec::new()];
        let mut saddle =
            Saddle { place: x.clone(), sizes, rate: 1.0, outgoing, incoming, directions };
        let (_, matrix) = jacobian(field, &x, q, &saddle);
        saddle.rate = DMatrix::from_column_slice(n, n, &matrix).norm();
        let (_, matrix) = jacobian(field, &x, q, &saddle);
        let all = eigen(&matrix, n).ok_or(Failure::Eigenvalues("eigenvalues of the saddle"))?;
        if let Some((value, _)) = all.iter().find(|(value, _)| value.0.abs() <= HYPERBOLIC) {
            let rate = value.0 * saddle.rate;
            return Err(none(format!(
                "the equilibrium is not hyperbolic: one of its eigenvalues has the real part \
                 {rate:.1e}"
            )));
        }
        let spanned = |sign: f64| {
            let own = all.iter().filter(|(value, _)| value.0 * sign > 0.0 && value.1 >= 0.0);
            let parts = own.flat_map(|(value, vector)| {
                let real = vector.iter().map(|it| it.0).collect();
                let imaginary = (value.1 > 0.0).then(|| vector.iter().map(|it| it.1).collect());
                std::iter::once(real).chain(imaginary)
            });
            Frame::spanned(&parts.collect::<Vec<Vec<f64>>>(), n)
        };
        (saddle.outgoing, saddle.incoming) = (spanned(1.0), spanned(-1.0));
        if saddle.outgoing.basis.is_empty() || saddle.incoming.basis.is_empty() {
            let kind = if saddle.outgoing.basis.is_empty() { "stable" } else { "unstable" };
            return Err(none(format!(
                "the equilibrium is not a saddle: all its eigenvalues are \
                                     {kind}"
            )));
        }
        let found = saddle.outgoing.basis.len() + saddle.incoming.basis.len();
        if found != n {
            return Err(none(format!(
                "the equilibrium has {found} independent eigenvectors but {n} states, because \
                 eigenvalues coincide"
            )));
        }
        if let Some(leading) = saddle.leading(&matrix) {
            saddle.directions = [Side::Outgoing, Side::Incoming]
                .map(|side| leading.reference(side).unwrap_or_default());
        }
        Ok(saddle)
    }

    /// Returns the number of states.
    pub fn dimension(&self) -> usize {
        self.place.len()
    }

    /// Computes the leading eigenvalues of a Jacobian that is close to the Jacobian of the
    /// reference equilibrium.
    pub fn leading<'m, T: Scalar>(&self, matrix: &'m [T]) -> Option<Leading<'m, T>> {
        Leading::new(matrix, self.dimension(), self.outgoing.basis.len())
    }

    /// Returns the deviation of a state from the equilibrium, in units of the extents (the ranges
    /// of the states).
    pub fn deviation(&self, x: &[f64]) -> Vec<f64> {
        x.iter().zip(&self.place).zip(&self.sizes).map(|((x, at), size)| (x - at) / size).collect()
    }

    /// Returns the distance of a state from the equilibrium, in units of the extents (the ranges of
    /// the states).
    pub fn distance(&self, x: &[f64]) -> f64 {
        self.deviation(x).iter().map(|y| y * y).sum::<f64>().sqrt()
    }
}
