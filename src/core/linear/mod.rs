//! Dense linear algebra: LU factorisation within a border, and condensation of chains of intervals.

mod chain;
mod front;
mod lu;
mod pencil;

pub use chain::Chain;
pub use lu::BorderedLu;
pub use pencil::multipliers;

/// A pivot this much smaller than what it is compared with counts as zero: the largest pivot of an
/// equilibrated matrix, or the largest entry of its row.
const SINGULAR: f64 = 1e-15;
