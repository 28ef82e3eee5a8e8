//! Derivatives in several directions at a time: seeds of vector dual numbers, and their parts.

use super::scalar::Scalar;
use num_dual::{DualSVec, DualSVec64};

/// The width of a chunk of directions differentiated in one pass.
pub(in crate::core) const CHUNK: usize = 8;
/// Numbers with a chunk of derivatives.
pub(in crate::core) type Chunk = DualSVec64<CHUNK>;
/// Numbers with half a chunk of derivatives, for small problems.
pub(in crate::core) type Narrow = DualSVec64<4>;

/// `x` with the unit direction `direction` if that lies in the chunk that begins at `start`.
pub(crate) fn seeded<T: Scalar, const W: usize>(
    x: T,
    direction: usize,
    start: usize,
) -> DualSVec<T, W> {
    let number = DualSVec::from_re(x);
    if (start..start + W).contains(&direction) {
        number.derivative(direction - start)
    } else {
        number
    }
}

/// All derivatives of a chunk; a chunk that depends on nothing has none.
pub(crate) fn parts<T: Scalar, const W: usize>(number: &DualSVec<T, W>) -> [T; W] {
    number.eps.0.map_or([T::zero(); W], |eps| eps.data.0[0])
}
