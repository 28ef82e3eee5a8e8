//! Linear algebra: dense and sparse LU factorisation within a border, condensation of chains of
//! intervals, and Floquet multipliers.

mod balance;
mod border;
mod certain;
mod chain;
mod condensed;
mod cycle;
mod factors;
mod front;
mod lu;
mod pencil;
mod sparse;
mod vector;

pub(crate) use balance::{balance, balanced};
pub(crate) use certain::clear_rounding;
pub(crate) use vector::{
    advanced, along, difference, dot, generic, largest, norm, normalise, orthogonalise, refill,
};

pub use border::{Border, Form, Spectrum, SpectrumRequest};
pub use chain::Chain;
pub(in crate::core) use condensed::{Condensed, CondensedLu, RotatedLu};
pub(in crate::core) use cycle::{Blocks, Cycle};
pub(crate) use factors::ShiftedLu;
pub use factors::{Factorisation, Factors};
pub use lu::BorderedLu;
pub(in crate::core) use lu::{differ, solved, unit};
pub use pencil::multipliers;
pub(in crate::core) use pencil::undetermined;
pub(in crate::core) use sparse::{
    Elimination, Leading, Pattern, Rightmost, SparseLu, SparseShiftedLu,
};
