//! What can be wrong with the description of a sine model.

use crate::problems::plate::InPlane;

/// Settings from which no [`SinePlate`](super::SinePlate) can be made.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum SineError {
    /// A plate without unknowns.
    #[error("0 modes leave nothing to solve for: ask for 1 or more")]
    NoModes,
    /// More modes than the rows of coefficients hold.
    #[error(
        "{modes} modes need wave number {needed}, above {largest}: ask for fewer, or use a \
         polynomial model, which converges faster"
    )]
    TooManyModes {
        /// The number asked for.
        modes: usize,
        /// The largest wave number among them.
        needed: usize,
        /// The largest wave number provided for.
        largest: usize,
    },
    /// A quadrature that cannot tell the functions apart.
    #[error(
        "{points} quadrature points in a half direction do not resolve wave number {largest}: use \
         {needed} or more"
    )]
    TooFewPoints {
        /// The number asked for.
        points: usize,
        /// The largest wave number.
        largest: usize,
        /// The smallest number accepted.
        needed: usize,
    },
    /// Edges that the stress function cannot describe: its shear traction vanishes on straight edges.
    #[error(
        "the sine model has no in-plane edges \"{}\": choose slide or straight, or a polynomial \
         model (model=ritz)", in_plane.name()
    )]
    InPlane {
        /// The edges asked for.
        in_plane: InPlane,
    },
}
