//! Numerical methods: quadrature, interpolation, bracketed roots, zero sets in the plane, and ladders
//! of discretisations.

mod bracketed;
mod contour;
mod interpolation;
mod ladder;
mod quadrature;

pub(crate) use bracketed::{Limits, bracketed_zero};
pub use contour::zero_set;
pub(crate) use interpolation::{extremum, highest_derivative, lagrange, node_weights};
pub use ladder::{error_of_first, error_of_last, ladder};
pub use quadrature::gauss_legendre;
