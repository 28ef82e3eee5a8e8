//! Krylov spaces of the inverse of a sparse matrix, and the eigenvalues of the inverse that are
//! computed from these spaces.

use super::block::{Block, LANES, combinations, dot, fill_block, orthogonalise_block, vectors_of};
use super::orthonormal::orthonormalise_block;
use crate::core::failure::Failure;
use crate::core::linalg::{normalise, orthogonalise};
use faer::linalg::solvers::DenseSolveCore;
use faer::{Mat, MatRef, Side, c64};
use std::iter::repeat_n;
use std::mem::take;

/// Heuristic: the largest number of basis vectors of a Krylov space.
const DIMENSION: usize = 240;

/// Heuristic: eigenvalues of a symmetric matrix form a cluster, with a common error estimate, if
/// their relative distance is smaller than this.
const TOGETHER: f64 = 0.01;

/// Heuristic: the length from which on the vectors of a block are made orthonormal together.
const LONG: usize = 1000;

/// Rounding: a vector that is shorter than this fraction of its components along the basis may consist
/// of rounding errors, whose components along the basis must be removed again.
const LOST: f64 = 1e-8;

/// Rounding: eigenvectors are dependent if the part of one that is orthogonal to the others is shorter
/// than this.
const DEPENDENT: f64 = 1e-8;

/// Rounding: the errors of the projected inverse matrix, relative to its Frobenius norm.
const ROUNDED: f64 = 1e-13;

/// Rounding: a vector is orthogonalised again if the remainder after orthogonalisation is shorter
/// than this fraction of the vector's original length.
const CANCELLED: f64 = 0.1;

/// Converged eigenvalues of the inverse matrix, with an orthonormal basis of the space that their
/// eigenvectors span.
#[derive(Default)]
pub(super) struct Locked {
    pub values: Vec<c64>,
    pub basis: Vec<Vec<f64>>,
    /// Approximations of the eigenvectors of further eigenvalues, without their components in the
    /// basis.
    pub others: Vec<Vec<f64>>,
}

impl Locked {
    /// Returns the modulus that an eigenvalue must exceed to be among the `count` largest.
    pub fn least(&self, count: usize) -> f64 {
        let mut sizes: Vec<f64> = self.values.iter().map(|it| it.norm()).collect();
        sizes.sort_by(|a, b| b.total_cmp(a));
        count.checked_sub(1).and_then(|last| sizes.get(last)).copied().unwrap_or(0.0)
    }
}

/// A Krylov space of the inverse matrix, orthogonal to the converged eigenvectors (the locked
/// vectors).
///
/// If the matrix `A` is not symmetric, but `D⁻¹ A D` is symmetric for a diagonal matrix `D` of
/// scales, then `D⁻¹ A D` replaces `A`.
///
/// The first basis vectors of the space are the given vectors. Each basis vector in turn is multiplied
/// by the inverse matrix, and the component of the product outside the space becomes the next basis
/// vector (A. Ruhe, Math. Comp. 33 (1979) 680).
pub(super) struct Krylov<'l> {
    locked: &'l [Vec<f64>],
    /// The diagonal scales that make the matrix symmetric.
    scales: Option<&'l [f64]>,
    /// An orthonormal basis.
    pub vectors: Vec<Vec<f64>>,
    /// The number of basis vectors that have been multiplied by the inverse.
    pub images: usize,
    /// The components, along the basis, of the products of basis vectors with the inverse matrix,
    /// stored column by column.
    projected: Vec<f64>,
    /// The number of rows of the matrix `projected`.
    rows: usize,
    /// For each basis vector that has been multiplied by the inverse, the number of basis vectors
    /// whose span contains the product.
    reach: Vec<usize>,
    /// The largest number of products with the inverse.
    most: usize,
    /// Scratch space: the vectors by which the space is extended.
    block: Vec<[f64; LANES]>,
}

impl<'l> Krylov<'l> {
    /// Creates the Krylov space that begins with given vectors of length `n`.
    pub fn new(
        starts: &[Vec<f64>],
        (locked, scales): (&'l [Vec<f64>], Option<&'l [f64]>),
        n: usize,
    ) -> Self {
        let most = DIMENSION.min(n - locked.len());
        let rows = most + starts.len();
        let projected = vec![0.0; rows * most];
        let (vectors, reach, block) = (Vec::new(), Vec::new(), Vec::new());
        let mut space =
            Krylov { locked, scales, vectors, images: 0, projected, rows, reach, most, block };
        for some in starts.chunks(LANES) {
            let mut block = take(&mut space.block);
            fill_block(&mut block, some);
            space.extend(&mut block, some.len(), 0);
            space.block = block;
        }
        space
    }

    /// Whether the space cannot grow, because it is invariant or has the largest allowed dimension.
    pub fn is_complete(&self) -> bool {
        self.images == self.most.min(self.vectors.len())
    }

    /// Extends the space by the products of the next basis vectors with a matrix; `apply` replaces
    /// the vectors of a block by their products.
    pub fn grow(&mut self, apply: &mut impl FnMut(&mut Block)) {
        let count = LANES.min(self.vectors.len().min(self.most) - self.images);
        let mut block = take(&mut self.block);
        fill_block(&mut block, &self.vectors[self.images..][..count]);
        let scaled = |block: &mut Block, factor: fn(f64) -> f64| {
            for (row, scale) in block.iter_mut().zip(self.scales.unwrap_or_default()) {
                row.iter_mut().for_each(|value| *value *= factor(*scale));
            }
        };
        scaled(&mut block, |d| d);
        apply(&mut block);
        scaled(&mut block, |d| d.recip());
        let near = self.first_coupled();
        let parts = self.extend(&mut block, count, near);
        self.block = block;
        self.reach.extend(repeat_n(self.vectors.len(), count));
        for lane in 0..count {
            let column = &mut self.projected[(self.images + lane) * self.rows..][..parts.len()];
            column.iter_mut().zip(&parts).for_each(|(entry, part)| *entry = part[lane]);
        }
        self.images += count;
    }

    /// Returns the position, among the locked vectors and the basis, of the first vector along which
    /// the products of the next basis vectors can have components. If the matrix is symmetric, no
    /// product has a component along a basis vector whose own product lies in the span of earlier
    /// vectors (C. Lanczos, J. Res. Nat. Bur. Standards 45 (1950) 255), or along an eigenvector.
    fn first_coupled(&self) -> usize {
        match self.scales {
            Some(_) => self.locked.len() + self.reach.partition_point(|end| *end <= self.images),
            None => 0,
        }
    }

    /// Orthogonalises the first vectors of a block, adds them to the basis, and returns their components
    /// along the basis. The components along the locked vectors and the basis vectors before the
    /// position `near` consist of rounding errors.
    fn extend(&mut self, block: &mut Block, count: usize, near: usize) -> Vec<[f64; LANES]> {
        let before = self.vectors.len();
        let all: Vec<&[f64]> = self.locked.iter().chain(&self.vectors).map(Vec::as_slice).collect();
        let mut parts = orthogonalise_block(block, &all, near);
        let mut sizes = [0.0; LANES];
        for part in &parts {
            sizes.iter_mut().zip(part).for_each(|(size, part)| *size = part.abs().max(*size));
        }
        parts.drain(..self.locked.len());
        if count == LANES
            && block.len() >= LONG
            && let Some(own) = orthonormalise_block(block, sizes.map(|size| LOST * size))
        {
            self.vectors.extend(vectors_of(block, LANES));
            parts.extend(own);
            return parts;
        }
        for lane in 0..count {
            let mut vector: Vec<f64> = block.iter().map(|row| row[lane]).collect();
            let whole = dot(&vector, &vector).sqrt();
            let (own, mut rest) = orthonormalise(&mut vector, &[&self.vectors[before..]]);
            for (part, own) in parts[before..].iter_mut().zip(own) {
                part[lane] = own;
            }
            let size = whole.max(sizes[lane]);
            let is_whole = self.vectors.len() + self.locked.len() == vector.len();
            if is_whole || rest <= f64::EPSILON * size {
                continue;
            }
            if rest < CANCELLED * whole || rest <= LOST * size {
                rest *= orthonormalise(&mut vector, &[self.locked, &self.vectors]).1;
            }
            self.vectors.push(vector);
            let mut part = [0.0; LANES];
            part[lane] = rest;
            parts.push(part);
        }
        parts
    }

    /// Computes the eigenvalues of the projected inverse matrix.
    ///
    /// # Errors
    /// [`Failure`] if the eigenvalue iteration does not converge.
    pub fn ritz(&self) -> Result<RitzPairs, Failure> {
        let (m, symmetric) = (self.images, self.scales.is_some());
        let square = MatRef::from_column_major_slice_with_stride(&self.projected, m, m, self.rows);
        let mut ritz = RitzPairs::of(square, symmetric)?;
        ritz.rests = ritz.vectors.iter().map(|vector| self.rest(vector)).collect();
        ritz.errors = if symmetric { ritz.symmetric_errors() } else { ritz.rests.clone() };
        Ok(ritz)
    }

    /// Returns the residual of an eigenvector of the projected inverse: the length of the component
    /// of its image outside the space.
    fn rest(&self, vector: &[c64]) -> f64 {
        let outside = self.images..self.vectors.len();
        let component = |i: usize| {
            let columns = self.projected.chunks_exact(self.rows).zip(vector);
            columns.map(|(column, y)| *y * column[i]).sum::<c64>().norm_sqr()
        };
        outside.map(component).sum::<f64>().sqrt()
    }
}

/// The eigenvalues of a projected matrix, with their eigenvectors and errors.
pub(super) struct RitzPairs {
    pub values: Vec<c64>,
    /// The eigenvectors, scaled to length 1.
    vectors: Vec<Vec<c64>>,
    /// The positions of the eigenvalues in descending order of their modulus; in a complex pair, the
    /// eigenvalue with positive imaginary part is the first.
    pub order: Vec<usize>,
    /// The lengths of the eigenvectors' residuals.
    rests: Vec<f64>,
    /// The errors of the eigenvalues.
    pub errors: Vec<f64>,
    /// The Frobenius norm of the projected matrix.
    norm: f64,
}

impl RitzPairs {
    fn of(matrix: MatRef<f64>, symmetric: bool) -> Result<Self, Failure> {
        let unknown = Failure::Eigenvalues("eigenvalues");
        let m = matrix.nrows();
        let (values, vectors): (Vec<c64>, _) = if symmetric {
            let mean = (matrix + matrix.transpose()) * faer::Scale(0.5);
            let found = mean.self_adjoint_eigen(Side::Lower).map_err(|_| unknown)?;
            let vector = |k| (0..m).map(|i| c64::new(found.U()[(i, k)], 0.0)).collect();
            let values = (0..m).map(|k| c64::new(found.S()[k], 0.0)).collect();
            (values, (0..m).map(vector).collect())
        } else {
            let found = matrix.eigen().map_err(|_| unknown)?;
            let vector = |k| {
                let vector: Vec<c64> = (0..m).map(|i| found.U()[(i, k)]).collect();
                let length = vector.iter().map(|it| it.norm_sqr()).sum::<f64>().sqrt();
                vector.into_iter().map(|it| it / length).collect()
            };
            ((0..m).map(|k| found.S()[k]).collect(), (0..m).map(vector).collect())
        };
        let mut order: Vec<usize> = (0..m).collect();
        order.sort_by(|&a, &b| {
            let [a, b]: [c64; 2] = [values[a], values[b]];
            b.norm().total_cmp(&a.norm()).then(b.im.total_cmp(&a.im))
        });
        let (rests, errors, norm) = (Vec::new(), Vec::new(), matrix.norm_l2());
        Ok(RitzPairs { values, vectors, order, rests, errors, norm })
    }

    /// Returns the errors of the eigenvalues of a symmetric matrix: each error is the residual or, if
    /// smaller, the square of the residual divided by the distance to the other eigenvalues (C.-K. Li
    /// and R.-C. Li, Linear Algebra Appl. 395 (2005) 183). The eigenvalues of a cluster share one error
    /// estimate.
    fn symmetric_errors(&self) -> Vec<f64> {
        let all = || self.values.iter().map(|value| value.re).zip(&self.rests);
        let error = |(value, rest): (f64, &f64)| {
            let (mut square, mut gap) = (0.0, f64::INFINITY);
            for (other, own) in all() {
                let distance = (other - value).abs();
                if distance <= TOGETHER * value.abs() {
                    square += own * own;
                } else {
                    gap = gap.min(distance - own);
                }
            }
            if gap > 0.0 { rest.min(square / gap) } else { *rest }
        };
        all().map(error).collect()
    }

    pub fn size(&self, k: usize) -> f64 {
        self.values[k].norm()
    }

    /// Returns the positions of all eigenvalues whose modulus can reach `least`; if `least` is 0, the
    /// bound is the modulus of the last of the `wanted` largest eigenvalues.
    pub fn candidates(&self, wanted: usize, least: f64) -> Vec<usize> {
        let last = self.order[wanted.min(self.order.len()) - 1];
        let least = if least > 0.0 { least } else { self.size(last) };
        let may_be = |k: &usize| self.size(*k) + self.rests[*k] >= least;
        self.order.iter().copied().filter(may_be).collect()
    }

    /// Returns the components, along the basis of the space, of the real part of an eigenvector; for
    /// the second eigenvalue of a complex pair, of the imaginary part.
    fn components(&self, k: usize) -> Vec<f64> {
        let part = match self.values[k].im {
            im if im < 0.0 => |it: &c64| it.im,
            _ => |it: &c64| it.re,
        };
        self.vectors[k].iter().map(part).collect()
    }

    /// Returns the real parts of eigenvectors in the space; for the second eigenvalue of a complex
    /// pair, the imaginary part.
    pub fn vectors_in<'k>(
        &self,
        chosen: impl Iterator<Item = &'k usize>,
        space: &[Vec<f64>],
    ) -> Vec<Vec<f64>> {
        let components: Vec<Vec<f64>> = chosen.map(|k| self.components(*k)).collect();
        combinations(&space[..self.values.len()], &components)
    }

    /// Sets those eigenvalues to zero that are zero up to rounding errors, which change an eigenvalue by
    /// its condition number times the errors of the matrix. Differential-algebraic equations of index `k`
    /// have zero eigenvalues in Jordan blocks of size `k`, and rounding errors change such an eigenvalue
    /// by their `k`-th root.
    pub fn clear_zeros(&mut self) {
        let m = self.values.len();
        let vectors = Mat::from_fn(m, m, |i, k| self.vectors[k][i]);
        let left = vectors.partial_piv_lu().inverse();
        let error = ROUNDED * self.norm;
        for (k, value) in self.values.iter_mut().enumerate() {
            let condition = (0..m).map(|i| left[(k, i)].norm_sqr()).sum::<f64>().sqrt();
            // A comparison with NaN is false.
            let is_known = value.norm() > error * condition;
            if !is_known {
                // The sign of the imaginary part distinguishes the two eigenvalues of a pair.
                *value = c64::new(0.0, value.im.signum() * ZERO);
            }
        }
    }

    /// Locks converged eigenvalues: stores them with an orthonormal basis of their eigenvectors in
    /// the space, which is orthogonal to the vectors that are already locked. An eigenvalue is left
    /// out if its eigenvector depends on the other eigenvectors: a later space, orthogonal to the basis,
    /// contains the eigenvalue. Also stores the parts of other eigenvectors that are orthogonal to this
    /// basis.
    pub fn lock<'k>(
        &self,
        chosen: &[usize],
        others: impl Iterator<Item = &'k usize>,
        (space, locked): (&[Vec<f64>], &mut Locked),
    ) {
        let mut basis: Vec<Vec<f64>> = Vec::new();
        let mut extend = |k: &usize| {
            let mut components = self.components(*k);
            let is_independent = orthonormalise(&mut components, &[&basis]).1 > DEPENDENT;
            if is_independent {
                basis.push(components);
            }
            is_independent
        };
        let independent: Vec<&usize> = chosen.iter().filter(|k| extend(k)).collect();
        others.for_each(|k| _ = extend(k));
        let mut vectors = combinations(&space[..self.values.len()], &basis);
        locked.others.extend(vectors.split_off(independent.len()));
        locked.basis.extend(vectors);
        locked.values.extend(independent.into_iter().map(|k| self.values[*k]));
    }
}

/// The imaginary part of eigenvalues that are zero up to rounding errors.
const ZERO: f64 = f64::MIN_POSITIVE;

/// Whether an eigenvalue was set to zero.
pub(super) fn is_zero(value: c64) -> bool {
    value.norm() <= ZERO
}

/// Makes a vector orthogonal to lists of orthonormal vectors, and scales the remainder to length 1.
/// Returns the components of the vector along the vectors of the lists, and the length of the
/// remainder before scaling.
fn orthonormalise(vector: &mut [f64], to: &[&[Vec<f64>]]) -> (Vec<f64>, f64) {
    let parts = to.iter().flat_map(|list| orthogonalise(vector, list, dot)).collect();
    let rest = dot(vector, vector).sqrt();
    normalise(vector);
    (parts, rest)
}
