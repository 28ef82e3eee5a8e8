//! Dense linear algebra: LU factorisation within a border, and condensation of chains of intervals.

mod chain;
mod front;
mod lu;
mod oscillation;
mod pencil;

pub use chain::Chain;
pub use lu::BorderedLu;
pub(crate) use oscillation::DenseOscillation;
pub use pencil::multipliers;
pub(in crate::core) use pencil::undetermined;
