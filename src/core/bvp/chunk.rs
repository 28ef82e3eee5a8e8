//! Derivatives in several directions at a time: seeds of vector dual numbers, and their parts.

use num_dual::DualSVec64;

/// The width of a chunk of directions differentiated in one pass.
pub(super) const CHUNK: usize = 8;
/// Numbers with a chunk of derivatives.
pub(super) type Chunk = DualSVec64<CHUNK>;

/// `x` with the unit direction `direction` if that lies in the chunk that begins at `start`.
pub(super) fn seeded<const W: usize>(x: f64, direction: usize, start: usize) -> DualSVec64<W> {
    let number = DualSVec64::from(x);
    if (start..start + W).contains(&direction) {
        number.derivative(direction - start)
    } else {
        number
    }
}

/// All derivatives of a chunk; a chunk that depends on nothing has none.
pub(super) fn parts<const W: usize>(number: &DualSVec64<W>) -> [f64; W] {
    number.eps.0.map_or([0.0; W], |eps| eps.data.0[0])
}
