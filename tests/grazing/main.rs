//! Promises of local maps near grazing, and of the Taylor polynomials that they are made of.

#[path = "../common/mod.rs"]
mod common;
#[path = "../hybrid/systems/mod.rs"]
mod systems;

mod attractors;
mod failures;
mod jets;
mod maps;
mod orbits;
mod orders;
mod points;
