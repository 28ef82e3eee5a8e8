//! The continuation core. It knows no device: equations come in as zero problems.

pub mod continuation;
pub mod dense;
pub mod linear;
pub mod quadrature;
pub mod scalar;
pub mod zero;
