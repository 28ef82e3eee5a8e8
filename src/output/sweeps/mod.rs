//! Sweeps as tables of numbers, in a file format that programs in other languages can read.

mod check;
mod csv;
mod file;
mod merge;
mod scatter;
mod table;

pub use check::TableDifference;
pub(super) use csv::csv;
pub use merge::{MergeError, merge};
pub(super) use scatter::{basins, scatter};
pub use table::{Row, SWEEPS, SweepTable, Sweeps};
