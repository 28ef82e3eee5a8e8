//! The continuation core. It knows no device: equations come in as zero problems.

pub mod attractor;
pub mod bifurcation;
pub mod bvp;
pub mod chunk;
pub mod condition;
pub mod continuation;
pub mod cycles;
pub mod dense;
mod domain;
pub mod extended;
pub(crate) mod failure;
pub mod field;
pub mod flow;
pub mod grazing;
pub mod hybrid;
pub mod jet;
pub mod kind;
pub mod ladder;
pub mod linear;
pub mod measure;
pub mod motion;
pub mod names;
pub mod newton;
mod number;
pub mod orbit;
pub(crate) mod potential;
pub mod quadrature;
pub mod scalar;
pub mod scalar_field;
pub mod solution;
#[cfg(feature = "scene")]
pub mod sweep;
pub(crate) mod system_ref;
pub(crate) mod vector;
pub mod watch;
pub mod zero;
