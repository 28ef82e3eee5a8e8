//! Dense linear algebra: LU factorisation within a border, and condensation of chains of intervals.

mod chain;
mod front;
mod lu;
mod pencil;

pub use chain::Chain;
pub use lu::BorderedLu;
pub use pencil::multipliers;
