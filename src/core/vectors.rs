//! Code that is compiled for the vector registers of the processor.

#[cfg(target_arch = "x86_64")]
use fearless_simd::{Level, Simd};

/// Runs a computation that is compiled for registers of four numbers if the processor has such
/// registers. Rows of a few numbers gain nothing from wider registers.
///
/// The closure and the functions that the closure calls must be inlined to profit. The results are
/// the same with and without the registers.
#[inline(always)]
pub(in crate::core) fn in_fours<R>(compute: impl FnOnce() -> R) -> R {
    #[cfg(target_arch = "x86_64")]
    if let Some(instructions) = Level::new().as_avx2() {
        return instructions.vectorize(compute);
    }
    compute()
}
