//! Promises of boundary-value problems and smooth periodic orbits.

#[path = "../common/mod.rs"]
mod common;

mod boundary;
mod boundary_values;
mod collocation;
mod curves;
mod cycles;
mod failures;
mod multipliers;
mod orbits;
mod simulation;
