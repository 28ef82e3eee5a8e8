//! Promises of systems with impacts, and of their orbits.

mod amplitudes;
mod attractors;
mod codimension_two;
mod cut_cycles;
mod decisions;
mod failures;
mod fast_guards;
mod fleets;
mod grazing;
mod integrals;
mod legs;
mod mita_laws;
mod normal_forms;
mod orbits;
mod recorded;
mod references;
mod resting;
mod scales;
mod sides;
mod simulation;
mod sliding;
mod sliding_fields;
mod sliding_switches;
pub mod systems;
mod torus;
mod unstable;
mod watched;
