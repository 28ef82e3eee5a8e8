//! Dense linear algebra: LU factorisation within a border, and condensation of chains of intervals.

mod chain;
mod front;
mod lu;

pub use chain::Chain;
pub use lu::BorderedLu;
