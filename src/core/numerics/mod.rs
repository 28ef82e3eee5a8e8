//! Numerical methods: quadrature, interpolation, bracketed roots, and ladders of discretisations.

mod bracketed;
mod interpolation;
mod ladder;
mod quadrature;

pub(crate) use bracketed::{Limits, bracketed_zero};
pub(crate) use interpolation::{extremum, highest_derivative, lagrange, node_weights};
pub use ladder::{error_of_first, error_of_last, ladder};
pub use quadrature::gauss_legendre;
