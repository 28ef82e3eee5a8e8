//! Blocks of vectors, which are multiplied by a matrix and orthogonalised together.

use crate::core::threads::side_by_side;
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

/// Heuristic: the number of strips of a large block. Two processors share four strips almost evenly,
/// even if one of them is slower.
const STRIPS: usize = 4;

/// Heuristic: a block with fewer rows times vectors than this is not divided, because starting
/// threads takes longer than the products.
const LEAST_PRODUCTS: usize = 1_000_000;

/// Heuristic: the number of partial sums of a scalar product, which do not wait for each other.
const SUMS: usize = 8;

/// Several vectors of the same length, stored row by row.
pub(super) type Block = [[f64; LANES]];

/// Arranges vectors side by side in the lanes of a block; unused lanes are zero.
pub(super) fn fill_block(block: &mut Vec<[f64; LANES]>, vectors: &[Vec<f64>]) {
    block.resize(vectors.first().map_or(0, Vec::len), [0.0; LANES]);
    for (k, rows) in block.chunks_mut(ROWS).enumerate() {
        rows.fill([0.0; LANES]);
        for (lane, vector) in vectors.iter().enumerate() {
            rows.iter_mut().zip(&vector[k * ROWS..]).for_each(|(row, v)| row[lane] = *v);
        }
    }
}

/// Returns the first `count` vectors of a block.
pub(super) fn vectors_of(block: &Block, count: usize) -> Vec<Vec<f64>> {
    let mut vectors: Vec<Vec<f64>> = (0..count).map(|_| Vec::with_capacity(block.len())).collect();
    for rows in block.chunks(ROWS) {
        for (lane, vector) in vectors.iter_mut().enumerate() {
            vector.extend(rows.iter().map(|row| row[lane]));
        }
    }
    vectors
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

/// Returns sums of vectors of the same length, multiplied by given factors; each list of factors
/// belongs to one sum.
pub(super) fn combinations(vectors: &[Vec<f64>], factors: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let (level, mut sums) = (Level::new(), Vec::new());
    let vectors: Vec<&[f64]> = vectors.iter().map(Vec::as_slice).collect();
    let mut block = vec![[0.0; LANES]; vectors.first().map_or(0, |vector| vector.len())];
    for some in factors.chunks(LANES) {
        let part = |k: usize, lane: usize| some.get(lane).map_or(0.0, |factors| -factors[k]);
        let along = (0..vectors.len()).map(|k| std::array::from_fn(|lane| part(k, lane)));
        let along: Vec<[f64; LANES]> = along.collect();
        block.fill([0.0; LANES]);
        side_by_side(
            &mut strips(&mut block, vectors.len()),
            |_, strip| dispatch!(level, simd => strip.subtract(simd, &vectors, &along)),
        );
        sums.extend(vectors_of(&block, some.len()));
    }
    sums
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
    let (level, last) = (Level::new(), &to[near..]);
    let mut strips = strips(block, to.len());
    let first = total(
        &mut strips,
        last.len(),
        |strip| dispatch!(level, simd => strip.add_products(simd, last)),
    );
    let second = total(
        &mut strips,
        to.len(),
        |strip| dispatch!(level, simd => strip.subtract_and_add_products(simd, (last, &first), to)),
    );
    side_by_side(
        &mut strips,
        |_, strip| dispatch!(level, simd => strip.subtract(simd, to, &second)),
    );
    let mut components = second;
    for (sum, part) in components[near..].iter_mut().zip(first) {
        sum.iter_mut().zip(part).for_each(|(sum, part)| *sum += part);
    }
    components
}

/// Consecutive rows of a block, which are processed on one thread.
pub(super) struct Strip<'b> {
    pub rows: &'b mut Block,
    /// The number of the first row.
    from: usize,
    /// Scalar products of vectors with the vectors of the block, over these rows.
    pub sums: Vec<[f64; LANES]>,
}

/// Divides a block into strips. The numbers of rows and vectors alone determine the strips, so that
/// results do not depend on the number of threads.
pub(super) fn strips(block: &mut Block, vectors: usize) -> Vec<Strip<'_>> {
    let length = if block.len() * vectors < LEAST_PRODUCTS {
        block.len()
    } else {
        block.len().div_ceil(STRIPS).next_multiple_of(ROWS)
    };
    let strip = |(k, rows)| Strip { rows, from: k * length, sums: Vec::new() };
    block.chunks_mut(length.max(1)).enumerate().map(strip).collect()
}

/// Calls a function that adds `count` scalar products to the sums of a strip, for all strips, and
/// returns the sums over all strips.
pub(super) fn total(
    strips: &mut [Strip],
    count: usize,
    add: impl Fn(&mut Strip) + Sync,
) -> Vec<[f64; LANES]> {
    side_by_side(strips, |_, strip| {
        strip.sums.clear();
        strip.sums.resize(count, [0.0; LANES]);
        add(strip);
    });
    let mut total = vec![[0.0; LANES]; count];
    for strip in strips {
        for (total, own) in total.iter_mut().zip(&strip.sums) {
            total.iter_mut().zip(own).for_each(|(total, own)| *total += own);
        }
    }
    total
}

impl Strip<'_> {
    #[inline(always)]
    fn add_products<S: Simd>(&mut self, simd: S, vectors: &[&[f64]]) {
        for (k, rows) in self.rows.chunks(ROWS).enumerate() {
            add_products(simd, vectors, (rows, self.from + k * ROWS), &mut self.sums);
        }
    }

    /// Subtracts the components along the last vectors, and adds scalar products with all vectors.
    #[inline(always)]
    fn subtract_and_add_products<S: Simd>(
        &mut self,
        simd: S,
        (last, along): (&[&[f64]], &[[f64; LANES]]),
        all: &[&[f64]],
    ) {
        for (k, rows) in self.rows.chunks_mut(ROWS).enumerate() {
            let from = self.from + k * ROWS;
            subtract(simd, last, (rows, from), along);
            // The second reading of the vectors finds them in the cache.
            add_products(simd, all, (rows, from), &mut self.sums);
        }
    }

    #[inline(always)]
    fn subtract<S: Simd>(&mut self, simd: S, vectors: &[&[f64]], along: &[[f64; LANES]]) {
        for (k, rows) in self.rows.chunks_mut(ROWS).enumerate() {
            subtract(simd, vectors, (rows, self.from + k * ROWS), along);
        }
    }
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
