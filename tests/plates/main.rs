//! Promises of the plates.

mod accuracy;
mod cost;
mod failures;
mod modal;
mod models;
mod plate_fold;
mod reference;
mod ritz;
mod sine;
mod strip;
