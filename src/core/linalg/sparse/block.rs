//! Blocks of vectors, which are multiplied by a matrix and orthogonalised together.

use fearless_simd::{Level, Simd, SimdBase, SimdFloat, dispatch, f64x4};
use std::array::{from_mut, from_ref};

/// Heuristic: the number of vectors that are multiplied by the inverse and orthogonalised together.
pub(in crate::core) const LANES: usize = 4;

/// Heuristic: the number of rows of a block that are processed together: the rows fit into the
/// first-level cache, and the same rows of about fifty vectors into the second-level cache.
const ROWS: usize = 512;

/// Heuristic: the number of basis vectors that are read together with the rows of a block, so that each
/// row is read once for all of them, and their sums do not wait for each other.
const GROUP: usize = 4;

/// Heuristic: the number of partial sums of a scalar product, which do not wait for each other.
const SUMS: usize = 8;

/// Several vectors of the same length, stored row by row.
pub(super) type Block = [[f64; LANES]];

/// Arranges vectors side by side in lanes; unused lanes are zero.
pub(super) fn block_of(vectors: &[Vec<f64>]) -> Vec<[f64; LANES]> {
    let mut block = vec![[0.0; LANES]; vectors.first().map_or(0, Vec::len)];
    for (lane, vector) in vectors.iter().enumerate() {
        block.iter_mut().zip(vector).for_each(|(row, v)| row[lane] = *v);
    }
    block
}

/// Returns the scalar product of two vectors.
pub(super) fn dot(a: &[f64], b: &[f64]) -> f64 {
    let ((a, last_a), (b, last_b)) = (a.as_chunks::<SUMS>(), b.as_chunks::<SUMS>());
    let mut sums = [0.0; SUMS];
    for (a, b) in a.iter().zip(b) {
        for k in 0..SUMS {
            sums[k] += a[k] * b[k];
        }
    }
    let last: f64 = last_a.iter().zip(last_b).map(|(a, b)| a * b).sum();
    sums.iter().sum::<f64>() + last
}

/// Makes the vectors of a block orthogonal to orthonormal vectors, by two Gram–Schmidt passes like
/// [`orthogonalise`](crate::core::linalg::orthogonalise), but for all vectors of the block together.
/// The first pass leaves out the vectors before the position `near`, along which the block has
/// negligible components. Returns the components of the block's vectors along the given vectors.
pub(super) fn orthogonalise_block(
    block: &mut Block,
    to: &[&[f64]],
    near: usize,
) -> Vec<[f64; LANES]> {
    dispatch!(Level::new(), simd => two_passes(simd, block, to, near))
}

#[inline(always)]
fn two_passes<S: Simd>(
    simd: S,
    block: &mut Block,
    to: &[&[f64]],
    near: usize,
) -> Vec<[f64; LANES]> {
    let mut first = vec![[0.0; LANES]; to.len()];
    let mut second = first.clone();
    for (k, rows) in block.chunks(ROWS).enumerate() {
        add_products(simd, &to[near..], (rows, k * ROWS), &mut first[near..]);
    }
    // The second reading of the vectors finds them in the cache.
    for (k, rows) in block.chunks_mut(ROWS).enumerate() {
        subtract(simd, &to[near..], (rows, k * ROWS), &first[near..]);
        add_products(simd, to, (rows, k * ROWS), &mut second);
    }
    for (k, rows) in block.chunks_mut(ROWS).enumerate() {
        subtract(simd, to, (rows, k * ROWS), &second);
    }
    for (part, more) in first.iter_mut().zip(second) {
        part.iter_mut().zip(more).for_each(|(part, more)| *part += more);
    }
    first
}

/// Adds the scalar products of vectors with the vectors of a block to `sums`; `rows` are the rows of
/// the block from the row number `from` on.
#[inline(always)]
fn add_products<S: Simd>(
    simd: S,
    vectors: &[&[f64]],
    (rows, from): (&Block, usize),
    sums: &mut [[f64; LANES]],
) {
    let ((groups, last), (of_groups, of_last)) =
        (vectors.as_chunks::<GROUP>(), sums.as_chunks_mut::<GROUP>());
    for (group, sums) in groups.iter().zip(of_groups) {
        add_products_of(simd, group, (rows, from), sums);
    }
    for (vector, sums) in last.iter().zip(of_last) {
        add_products_of(simd, from_ref(vector), (rows, from), from_mut(sums));
    }
}

/// Adds the scalar products of a group of vectors with the vectors of a block.
#[inline(always)]
fn add_products_of<S: Simd, const N: usize>(
    simd: S,
    vectors: &[&[f64]; N],
    (rows, from): (&Block, usize),
    sums: &mut [[f64; LANES]; N],
) {
    let vectors = vectors.map(|vector| &vector[from..][..rows.len()]);
    let mut own = sums.map(|sum| f64x4::from_slice(simd, &sum));
    for i in 0..rows.len() {
        let row = f64x4::from_slice(simd, &rows[i]);
        for k in 0..N {
            own[k] = row.mul_add(f64x4::splat(simd, vectors[k][i]), own[k]);
        }
    }
    for (sum, own) in sums.iter_mut().zip(own) {
        own.store_slice(sum);
    }
}

/// Subtracts from the vectors of a block their components `along` vectors; `rows` are the rows of the
/// block from the row number `from` on.
#[inline(always)]
fn subtract<S: Simd>(
    simd: S,
    vectors: &[&[f64]],
    (rows, from): (&mut Block, usize),
    along: &[[f64; LANES]],
) {
    let ((groups, last), (of_groups, of_last)) =
        (vectors.as_chunks::<GROUP>(), along.as_chunks::<GROUP>());
    for (group, along) in groups.iter().zip(of_groups) {
        subtract_from(simd, rows, (group, from), along);
    }
    for (vector, along) in last.iter().zip(of_last) {
        subtract_from(simd, rows, (from_ref(vector), from), from_ref(along));
    }
}

/// Subtracts from the vectors of a block their components along a group of vectors.
#[inline(always)]
fn subtract_from<S: Simd, const N: usize>(
    simd: S,
    rows: &mut Block,
    (vectors, from): (&[&[f64]; N], usize),
    along: &[[f64; LANES]; N],
) {
    let vectors = vectors.map(|vector| &vector[from..][..rows.len()]);
    let along = along.map(|along| -f64x4::from_slice(simd, &along));
    for i in 0..rows.len() {
        let mut row = f64x4::from_slice(simd, &rows[i]);
        for k in 0..N {
            row = along[k].mul_add(f64x4::splat(simd, vectors[k][i]), row);
        }
        row.store_slice(&mut rows[i]);
    }
}
