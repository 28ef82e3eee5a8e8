//! Promises of the plates.

mod accuracy;
mod cost;
mod failures;
mod functions;
mod modal;
pub mod models;
pub mod plate_fold;
mod reference;
mod ritz;
mod sine;
mod strip;
