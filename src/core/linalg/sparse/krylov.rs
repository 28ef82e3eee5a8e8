//! Krylov spaces of the inverse of a sparse matrix, and the eigenvalues of the inverse that are
//! computed from these spaces.

use crate::core::failure::Failure;
use crate::core::linalg::{dot, norm, normalise, orthogonalise};
use faer::{MatRef, Side, c64};
use std::array::{from_mut, from_ref};

/// Heuristic: the number of vectors that are multiplied by the inverse and orthogonalised together.
pub(in crate::core) const LANES: usize = 4;

/// Heuristic: the largest number of basis vectors of a Krylov space.
const DIMENSION: usize = 240;

/// Heuristic: the number of rows of a block that are processed together: the rows fit into the
/// first-level cache, and the same rows of about fifty vectors into the second-level cache.
const ROWS: usize = 1024;

/// Heuristic: the number of basis vectors that are read together with the rows of a block, so that each
/// row is read once for all of them. Larger groups take no less time.
const GROUP: usize = 4;

/// Heuristic: eigenvalues of a symmetric matrix form a cluster, with a common error estimate, if
/// their relative distance is smaller than this.
const TOGETHER: f64 = 0.01;

/// Rounding: a vector is orthogonalised again if the remainder after orthogonalisation is shorter
/// than this fraction of the vector's original length.
const CANCELLED: f64 = 0.1;

/// Several vectors of the same length, stored row by row.
type Block = [[f64; LANES]];

/// Converged eigenvalues of the inverse matrix, with an orthonormal basis of the space that their
/// eigenvectors span.
#[derive(Default)]
pub(super) struct Locked {
    pub values: Vec<c64>,
    pub basis: Vec<Vec<f64>>,
    /// Approximations of the eigenvectors of further eigenvalues.
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
    /// The largest number of products with the inverse.
    most: usize,
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
        let vectors = Vec::new();
        let mut space = Krylov { locked, scales, vectors, images: 0, projected, rows, most };
        for some in starts.chunks(LANES) {
            space.extend(&mut block_of(some), some.len());
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
        let mut block = block_of(&self.vectors[self.images..][..count]);
        let scaled = |block: &mut Block, factor: fn(f64) -> f64| {
            for (row, scale) in block.iter_mut().zip(self.scales.unwrap_or_default()) {
                row.iter_mut().for_each(|value| *value *= factor(*scale));
            }
        };
        scaled(&mut block, |d| d);
        apply(&mut block);
        scaled(&mut block, |d| d.recip());
        let parts = self.extend(&mut block, count);
        for lane in 0..count {
            let column = &mut self.projected[(self.images + lane) * self.rows..][..parts.len()];
            column.iter_mut().zip(&parts).for_each(|(entry, part)| *entry = part[lane]);
        }
        self.images += count;
    }

    /// Orthogonalises the first vectors of a block, adds them to the basis, and returns their components
    /// along the basis.
    fn extend(&mut self, block: &mut Block, count: usize) -> Vec<[f64; LANES]> {
        let before = self.vectors.len();
        let mut parts = orthogonalise_block(block, &[self.locked, &self.vectors]);
        let mut sizes = [0.0; LANES];
        for part in &parts {
            sizes.iter_mut().zip(part).for_each(|(size, part)| *size = part.abs().max(*size));
        }
        parts.drain(..self.locked.len());
        for lane in 0..count {
            let mut vector: Vec<f64> = block.iter().map(|row| row[lane]).collect();
            let whole = norm(&vector);
            let (own, mut rest) = orthonormalise(&mut vector, &[&self.vectors[before..]]);
            for (part, own) in parts[before..].iter_mut().zip(own) {
                part[lane] = own;
            }
            let size = whole.max(sizes[lane]);
            let is_whole = self.vectors.len() + self.locked.len() == vector.len();
            if is_whole || rest <= f64::EPSILON * size {
                continue;
            }
            if rest < CANCELLED * whole {
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
        Ok(RitzPairs { values, vectors, order, rests: Vec::new(), errors: Vec::new() })
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

    /// Returns the real part of an eigenvector in the space; for the second eigenvalue of a complex
    /// pair, returns the imaginary part.
    pub fn vector(&self, k: usize, space: &[Vec<f64>]) -> Vec<f64> {
        let part = match self.values[k].im {
            im if im < 0.0 => |it: &c64| it.im,
            _ => |it: &c64| it.re,
        };
        let mut vector = vec![0.0; space[0].len()];
        for (basis, factor) in space.iter().zip(&self.vectors[k]) {
            let factor = part(factor);
            vector.iter_mut().zip(basis).for_each(|(v, b)| *v += factor * b);
        }
        vector
    }

    /// Locks converged eigenvalues: stores them with an orthonormal basis of their eigenvectors in
    /// the space.
    pub fn lock(&self, chosen: &[usize], space: &[Vec<f64>], locked: &mut Locked) {
        for &k in chosen {
            locked.values.push(self.values[k]);
            let mut vector = self.vector(k, space);
            if orthonormalise(&mut vector, &[&locked.basis]).1 > 1e-8 {
                locked.basis.push(vector);
            }
        }
    }
}

/// Arranges vectors side by side in lanes; unused lanes are zero.
fn block_of(vectors: &[Vec<f64>]) -> Vec<[f64; LANES]> {
    let mut block = vec![[0.0; LANES]; vectors.first().map_or(0, Vec::len)];
    for (lane, vector) in vectors.iter().enumerate() {
        block.iter_mut().zip(vector).for_each(|(row, v)| row[lane] = *v);
    }
    block
}

/// Makes the vectors of a block orthogonal to lists of orthonormal vectors, by two Gram–Schmidt passes
/// like [`orthogonalise`], but for all vectors of the block together. Returns the components of the
/// block's vectors along the vectors of the lists.
fn orthogonalise_block(block: &mut Block, to: &[&[Vec<f64>]]) -> Vec<[f64; LANES]> {
    let all: Vec<&[f64]> = to.iter().flat_map(|list| list.iter().map(Vec::as_slice)).collect();
    let mut first = vec![[0.0; LANES]; all.len()];
    let mut second = first.clone();
    for (k, rows) in block.chunks(ROWS).enumerate() {
        add_products(&all, (rows, k * ROWS), &mut first);
    }
    // The second reading of the vectors finds them in the cache.
    for (k, rows) in block.chunks_mut(ROWS).enumerate() {
        subtract(&all, (rows, k * ROWS), &first);
        add_products(&all, (rows, k * ROWS), &mut second);
    }
    for (k, rows) in block.chunks_mut(ROWS).enumerate() {
        subtract(&all, (rows, k * ROWS), &second);
    }
    for (part, more) in first.iter_mut().zip(second) {
        part.iter_mut().zip(more).for_each(|(part, more)| *part += more);
    }
    first
}

/// Adds the scalar products of vectors with the vectors of a block to `sums`; `rows` are the rows of
/// the block from the row number `from` on.
fn add_products(vectors: &[&[f64]], (rows, from): (&Block, usize), sums: &mut [[f64; LANES]]) {
    let ((groups, last), (of_groups, of_last)) =
        (vectors.as_chunks::<GROUP>(), sums.as_chunks_mut::<GROUP>());
    for (group, sums) in groups.iter().zip(of_groups) {
        add_products_of(group, (rows, from), sums);
    }
    for (vector, sums) in last.iter().zip(of_last) {
        add_products_of(from_ref(vector), (rows, from), from_mut(sums));
    }
}

/// Adds the scalar products of a group of vectors with the vectors of a block.
fn add_products_of<const N: usize>(
    vectors: &[&[f64]; N],
    (rows, from): (&Block, usize),
    sums: &mut [[f64; LANES]; N],
) {
    let vectors = vectors.map(|vector| &vector[from..][..rows.len()]);
    let mut own = [[0.0; LANES]; N];
    for i in 0..rows.len() {
        for k in 0..N {
            for lane in 0..LANES {
                own[k][lane] += vectors[k][i] * rows[i][lane];
            }
        }
    }
    for (sums, own) in sums.iter_mut().zip(own) {
        sums.iter_mut().zip(own).for_each(|(sum, own)| *sum += own);
    }
}

/// Subtracts from the vectors of a block their components `along` vectors; `rows` are the rows of the
/// block from the row number `from` on.
fn subtract(vectors: &[&[f64]], (rows, from): (&mut Block, usize), along: &[[f64; LANES]]) {
    let ((groups, last), (of_groups, of_last)) =
        (vectors.as_chunks::<GROUP>(), along.as_chunks::<GROUP>());
    for (group, along) in groups.iter().zip(of_groups) {
        subtract_from(rows, (group, from), along);
    }
    for (vector, along) in last.iter().zip(of_last) {
        subtract_from(rows, (from_ref(vector), from), from_ref(along));
    }
}

/// Subtracts from the vectors of a block their components along a group of vectors.
fn subtract_from<const N: usize>(
    rows: &mut Block,
    (vectors, from): (&[&[f64]; N], usize),
    along: &[[f64; LANES]; N],
) {
    let vectors = vectors.map(|vector| &vector[from..][..rows.len()]);
    for i in 0..rows.len() {
        let mut row = rows[i];
        for k in 0..N {
            for lane in 0..LANES {
                row[lane] -= along[k][lane] * vectors[k][i];
            }
        }
        rows[i] = row;
    }
}

/// Makes a vector orthogonal to lists of orthonormal vectors, and scales the remainder to length 1.
/// Returns the components of the vector along the vectors of the lists, and the length of the
/// remainder before scaling.
fn orthonormalise(vector: &mut [f64], to: &[&[Vec<f64>]]) -> (Vec<f64>, f64) {
    let parts = to.iter().flat_map(|list| orthogonalise(vector, list, dot)).collect();
    let rest = norm(vector);
    normalise(vector);
    (parts, rest)
}
