//! Promises of systems with impacts, and of their orbits.

#[path = "../common/mod.rs"]
mod common;

mod attractors;
mod failures;
mod fleets;
mod grazing;
mod mita_laws;
mod orbits;
mod recorded;
mod references;
mod scales;
mod simulation;
mod systems;
mod watched;
