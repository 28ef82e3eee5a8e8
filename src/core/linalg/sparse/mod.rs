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

/// Returns the sign of the permutation that maps one order of the numbers 0, 1, 2, … to another
/// order.
fn parity([from, to]: &[Vec<usize>; 2]) -> f64 {
    let mut image = vec![0; from.len()];
    from.iter().zip(to).for_each(|(&from, &to)| image[from] = to);
    let mut seen = vec![false; image.len()];
    let mut sign = 1.0;
    for start in 0..image.len() {
        let (mut at, mut length) = (start, 0);
        while !seen[at] {
            seen[at] = true;
            at = image[at];
            length += 1;
        }
        if length > 0 && length % 2 == 0 {
            sign = -sign;
        }
    }
    sign
}
