//! What can be wrong with the description of a plate.

/// A plate that cannot be set up, and what to change.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PlateError {
    /// Letters that do not name four edges.
    #[error(
        "supports \"{letters}\": write four letters out of S (simply supported), C (clamped) and \
         F (free), for the edges x = 0, y = 0, x = 1, y = 1, such as \"SCSF\""
    )]
    Supports {
        /// The name as written.
        letters: String,
    },
    /// Nothing holds the plate.
    #[error(
        "supports {supports} leave the plate free to move as a rigid body: hold it by one clamped \
         edge or two supported ones"
    )]
    Unsupported {
        /// The supports.
        supports: String,
    },
    /// Supports that the sine model does not have.
    #[error(
        "the model `sine` is for four supported edges (SSSS), not for {supports}; use `model=ritz`"
    )]
    SineSupports {
        /// The supports.
        supports: String,
    },
    /// Edges that the stress function cannot describe: its shear traction vanishes on straight
    /// edges.
    #[error(
        "the sine model has no in-plane edges \"{in_plane}\": choose slide or straight, or a polynomial \
         model (model=ritz)"
    )]
    SineInPlane {
        /// The name of the edges in the plane.
        in_plane: &'static str,
    },
    /// More or fewer functions or modes than can be worked with.
    #[error("{count} {what}: choose between {least} and {most}, or another model of the plate")]
    Count {
        /// The counted quantity.
        what: &'static str,
        /// The offending number.
        count: usize,
        /// The smallest possible.
        least: usize,
        /// The largest possible.
        most: usize,
    },
    /// A quadrature that cannot tell the functions apart.
    #[error("{points} quadrature points do not resolve the functions: use {needed} or more")]
    TooFewPoints {
        /// The number of points.
        points: usize,
        /// The smallest number accepted.
        needed: usize,
    },
    /// An accuracy of modes that no arithmetic of 16 digits gives, or none at all.
    #[error("mode_accuracy is {accuracy:e}: choose between 1e-12 and 0.1")]
    AccuracyRange {
        /// The accuracy.
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
        /// The number of modes.
        modes: usize,
        /// The relative error of `ω²` allowed.
        accuracy: f64,
        /// The estimated one.
        error: f64,
        /// The numbers of transverse functions along x and y.
        functions: [usize; 2],
        /// How many of the lowest modes are accurate enough.
        accurate: usize,
    },
    /// Stresses were asked of a plate without stretching, or with too many in-plane functions for
    /// them.
    #[error("the plate has no in-plane stresses: set theory to von_karman, with fewer functions")]
    NoMembrane,
    /// A value of a parameter without meaning.
    #[error(transparent)]
    Domain(#[from] crate::core::failure::Failure),
}

impl PlateError {
    /// [`PlateError::Count`] unless `least ≤ count ≤ most`.
    pub(super) fn check(
        what: &'static str,
        count: usize,
        [least, most]: [usize; 2],
    ) -> Result<(), PlateError> {
        if (least..=most).contains(&count) {
            return Ok(());
        }
        Err(PlateError::Count { what, count, least, most })
    }
}
