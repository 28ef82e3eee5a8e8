//! Sparse matrices: sparsity patterns, the order of elimination, and LU factorisation of bordered
//! matrices.

mod balance;
mod block;
mod coloring;
mod dissection;
mod front;
mod inverse;
mod krylov;
mod largest;
mod leading;
mod lu;
mod matrix;
mod node;
mod orthonormal;
mod part;
mod partition;
mod pattern;
mod shared;
mod symmetry;
mod tree;
mod triangles;

pub(in crate::core) use block::LANES;
pub(in crate::core) use coloring::Coloring;
pub(in crate::core) use largest::{Lanes, Largest};
pub(in crate::core) use leading::{Leading, Rightmost};
pub(in crate::core) use lu::{Elimination, SparseLu, SparseShiftedLu};
pub(in crate::core) use matrix::Pencil;
pub(in crate::core) use pattern::Pattern;
pub(in crate::core) use shared::{KnownFactors, SharedLu};

/// Returns the sign of a permutation of numbers, given by pairs of a number and its image. Only the
/// numbers that differ from their images are stored.
fn parity(pairs: impl Iterator<Item = (usize, usize)>) -> f64 {
    let mut moved: Vec<(usize, usize)> = pairs.filter(|(from, to)| from != to).collect();
    moved.sort_unstable();
    let place = |number: usize| moved.partition_point(|(from, _)| *from < number);
    let images: Vec<usize> = moved.iter().map(|(_, to)| place(*to)).collect();
    let mut seen = vec![false; images.len()];
    let mut sign = 1.0;
    for start in 0..images.len() {
        let (mut at, mut length) = (start, 0);
        while !seen[at] {
            seen[at] = true;
            at = images[at];
            length += 1;
        }
        if length > 0 && length % 2 == 0 {
            sign = -sign;
        }
    }
    sign
}
