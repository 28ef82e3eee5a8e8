//! Promises about memory, counted in the thread of each test.

mod allocations;
mod equilibria;
mod maps;
mod orbits;
