//! All tests, in one program: the library is compiled for users only, and what tests share is
//! compiled once.

mod allocation;
mod common;
mod continuation;
mod grazing;
mod hybrid;
mod models;
mod orbits;
mod plates;
mod program;
mod structure;
