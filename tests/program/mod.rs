//! Promises of the program: commands, scenes, documents and figures.

mod archives;
mod command;
mod command_line;
mod fidelity;
mod files;
mod grids;
mod itineraries;
mod limits;
mod manifolds;
mod models;
mod output_document;
mod output_figures;
mod output_svg;
mod personas;
mod pictures;
mod reference;
mod regions;
mod requests;
mod resolution;
mod restarts;
mod returns;
pub mod scenarios;
mod scenes;
mod scenes_near_grazing;
mod scenes_of_impacts;
mod scenes_of_orbits;
mod sweeps;
