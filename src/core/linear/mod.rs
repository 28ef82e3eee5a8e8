//! Dense linear algebra: LU factorisation within a border.

mod lu;

pub use lu::BorderedLu;
