//! Equations that are given as text.

mod errors;
mod fuzz;
mod language;
mod library;
mod ode;
mod restated;
