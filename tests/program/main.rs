//! Promises of the program: commands, scenes, documents and figures.

#[path = "../common/mod.rs"]
mod common;

mod command_line;
mod fidelity;
mod itineraries;
mod output_document;
mod output_figures;
mod readme;
mod scenarios;
mod scenes;
mod scenes_near_grazing;
mod scenes_of_impacts;
mod scenes_of_orbits;
mod sweeps;
