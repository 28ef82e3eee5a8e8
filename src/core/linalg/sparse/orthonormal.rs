//! Orthonormalisation of all vectors of a block together.

use super::block::{Block, LANES, Strip, strips, total};
use crate::core::threads::side_by_side;
use fearless_simd::{Level, Simd, SimdBase, SimdFloat, dispatch, f64x4};

/// A matrix with a row and a column for each vector of a block.
pub(super) type Square = [[f64; LANES]; LANES];

/// Heuristic: vectors are orthonormalised together if the part of each vector that is orthogonal to
/// the preceding vectors has at least this fraction of the vector's length. Rounding errors of the
/// first pass then grow by at most about the sixth power of the inverse of this fraction.
const INDEPENDENT: f64 = 0.1;

/// Replaces the vectors of a block by orthonormal vectors, and returns the upper triangular matrix `R`
/// for which the old vectors are `B = Q R`. Returns `None`, and leaves the block unchanged, if the
/// vectors are nearly dependent, or if the part of a vector that is orthogonal to the preceding vectors
/// is shorter than the length in `least`.
///
/// The Cholesky factor `R` of the matrix `Bᵀ B` of scalar products gives `Q = B R⁻¹`. A second pass
/// makes the vectors orthonormal to working accuracy (T. Fukaya, Y. Nakatsukasa, Y. Yanagisawa and Y.
/// Yamamoto, ScalA 2014).
pub(super) fn orthonormalise_block(block: &mut Block, least: [f64; LANES]) -> Option<Square> {
    let level = Level::new();
    let mut strips = strips(block, 2 * LANES);
    let products = |strip: &mut Strip| dispatch!(level, simd => strip.multiply_by_itself(simd));
    let first = cholesky(&square(total(&mut strips, LANES, products)))?;
    if (0..LANES).any(|k| first[k][k] <= least[k]) {
        return None;
    }
    let inverse = inverse_of(&first);
    let again = |strip: &mut Strip| {
        dispatch!(level, simd => {
            strip.multiply(simd, &inverse);
            strip.multiply_by_itself(simd);
        });
    };
    let second = cholesky(&square(total(&mut strips, LANES, again)));
    // After the first pass the vectors are nearly orthonormal, so that the second factor exists.
    let second = second.unwrap_or_else(identity);
    let inverse = inverse_of(&second);
    side_by_side(&mut strips, |_, strip| dispatch!(level, simd => strip.multiply(simd, &inverse)));
    Some(product(&second, &first))
}

impl Strip<'_> {
    /// Computes the scalar products of the block's vectors with each other, over the rows of the strip.
    #[inline(always)]
    fn multiply_by_itself<S: Simd>(&mut self, simd: S) {
        let mut own: [f64x4<S>; LANES] = std::array::from_fn(|_| f64x4::splat(simd, 0.0));
        for row in &*self.rows {
            let all = f64x4::from_slice(simd, row);
            for k in 0..LANES {
                own[k] = all.mul_add(f64x4::splat(simd, row[k]), own[k]);
            }
        }
        for (sum, own) in self.sums.iter_mut().zip(own) {
            own.store_slice(sum);
        }
    }

    /// Multiplies the block from the right by a matrix.
    #[inline(always)]
    fn multiply<S: Simd>(&mut self, simd: S, by: &Square) {
        let by = by.map(|row| f64x4::from_slice(simd, &row));
        for row in &mut *self.rows {
            let mut sum = f64x4::splat(simd, 0.0);
            for k in 0..LANES {
                sum = by[k].mul_add(f64x4::splat(simd, row[k]), sum);
            }
            sum.store_slice(row);
        }
    }
}

fn square(sums: Vec<[f64; LANES]>) -> Square {
    std::array::from_fn(|i| sums[i])
}

fn identity() -> Square {
    std::array::from_fn(|i| std::array::from_fn(|j| if i == j { 1.0 } else { 0.0 }))
}

/// Returns the upper triangular matrix `R` with `Rᵀ R = A` for a symmetric positive matrix `A`; `None`
/// if a diagonal entry of `R` is small in comparison with the entry of `A`.
fn cholesky(a: &Square) -> Option<Square> {
    let mut r = [[0.0; LANES]; LANES];
    for i in 0..LANES {
        let sum = |r: &Square, j: usize| (0..i).map(|k| r[k][i] * r[k][j]).sum::<f64>();
        let rest = a[i][i] - sum(&r, i);
        // A comparison with NaN is false.
        let is_independent = rest > INDEPENDENT * INDEPENDENT * a[i][i];
        if !is_independent {
            return None;
        }
        r[i][i] = rest.sqrt();
        for j in i + 1..LANES {
            r[i][j] = (a[i][j] - sum(&r, j)) / r[i][i];
        }
    }
    Some(r)
}

/// Returns the inverse of an upper triangular matrix.
fn inverse_of(r: &Square) -> Square {
    let mut inverse = [[0.0; LANES]; LANES];
    for j in 0..LANES {
        inverse[j][j] = r[j][j].recip();
        for i in (0..j).rev() {
            let sum: f64 = (i + 1..=j).map(|k| r[i][k] * inverse[k][j]).sum();
            inverse[i][j] = -sum / r[i][i];
        }
    }
    inverse
}

fn product(a: &Square, b: &Square) -> Square {
    std::array::from_fn(|i| std::array::from_fn(|j| (0..LANES).map(|k| a[i][k] * b[k][j]).sum()))
}
