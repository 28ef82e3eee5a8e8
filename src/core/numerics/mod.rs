//! Numerical methods: quadrature, interpolation, bracketed and isolated roots, zero sets in the plane,
//! and ladders of discretisations.

mod bracketed;
mod contour;
mod interpolation;
mod isolated_root;
mod ladder;
mod quadrature;

pub(crate) use bracketed::{Limits, bracketed_zero};
pub use contour::zero_set;
pub(crate) use interpolation::{extremum, highest_derivative, lagrange, node_weights};
pub(crate) use isolated_root::{isolated_root, starting_direction};
pub use ladder::{error_of_first, error_of_last, ladder};
pub use quadrature::gauss_legendre;
