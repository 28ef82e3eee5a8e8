//! What can be wrong with the description of a modal model.

use crate::problems::plate::PlateError;

/// Settings from which no [`Modal`](super::Modal) can be made.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ModalError {
    /// A number of modes that cannot be worked with.
    #[error("{modes} modes: choose between 1 and {most}, or use the full model")]
    Modes {
        /// The number asked for.
        modes: usize,
        /// The largest number.
        most: usize,
    },
    /// An accuracy that no arithmetic of 16 digits gives, or none at all.
    #[error("mode_accuracy is {accuracy:e}: choose between 1e-12 and 0.1")]
    AccuracyRange {
        /// The accuracy asked for.
        accuracy: f64,
    },
    /// Modes that the polynomials do not resolve.
    #[error(
        "{modes} modes cannot meet mode_accuracy {accuracy:.1e}: with {} × {} functions their ω² are \
         off by {error:.1e}, and {accurate} of them are accurate enough; ask for fewer modes, for more \
         functions (orders) if you set them, or for a larger mode_accuracy (free edges meeting at a \
         corner limit it)", functions[0], functions[1]
    )]
    Accuracy {
        /// The number asked for.
        modes: usize,
        /// The relative error of `ω²` asked for.
        accuracy: f64,
        /// The estimated one.
        error: f64,
        /// The numbers of transverse functions along x and y.
        functions: [usize; 2],
        /// How many of the lowest modes are accurate enough.
        accurate: usize,
    },
    /// A plate that cannot be set up.
    #[error(transparent)]
    Plate(#[from] PlateError),
}
