//! Promises of local maps near grazing, and of the Taylor polynomials that they are made of.

mod attractors;
mod compliant;
mod failures;
mod jets;
mod maps;
mod orbits;
mod orders;
mod points;
