//! Promises about memory. A program of its own, since the counter replaces the allocator of every
//! program that it is part of.

#[path = "../common/mod.rs"]
mod common;
#[path = "../orbits/cycles/mod.rs"]
mod cycles;

mod allocations;
mod equilibria;
mod orbits;
