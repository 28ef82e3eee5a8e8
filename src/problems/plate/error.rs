//! The errors in the description of a plate.

/// The error of a plate whose model cannot be set up; the help text of the error states a remedy.
#[derive(Clone, Debug, PartialEq, miette::Diagnostic, thiserror::Error)]
#[non_exhaustive]
pub enum PlateError {
    /// The given letters do not name the supports of four edges.
    #[error(
        "the supports \"{letters}\" must be four letters, each one S (simply supported), C \
         (clamped) or F (free)"
    )]
    #[diagnostic(help(
        "write one letter for each edge, in the order x = 0, y = 0, x = 1, y = 1, such as \"SCSF\""
    ))]
    Supports {
        /// The letters that were given as supports.
        letters: String,
    },
    /// The supports leave the plate free to move as a rigid body.
    #[error("supports {supports} leave the plate free to move as a rigid body")]
    #[diagnostic(help("hold the plate by one clamped edge or two supported edges"))]
    Unsupported {
        /// The supports.
        supports: String,
    },
    /// The sine model does not support these edges: it requires four simply supported edges.
    #[error("the model `sine` requires four supported edges (SSSS), not {supports}")]
    #[diagnostic(help("use `model=ritz`"))]
    SineSupports {
        /// The supports.
        supports: String,
    },
    /// The sine model does not support these in-plane supports: its stress function requires edges
    /// that stay straight and have no shear traction.
    #[error("the sine model of the plate cannot be used with the in-plane supports \"{in_plane}\"")]
    #[diagnostic(help(
        "choose the in-plane supports `slide` or `straight`, or a polynomial model (`model=ritz`)"
    ))]
    SineInPlane {
        /// The name of the in-plane supports.
        in_plane: &'static str,
    },
    /// The number of basis functions or modes is outside its allowed range.
    #[error("the number of {what} is {count}, but must be between {least} and {most}")]
    #[diagnostic(help("choose a number between these limits, or another model of the plate"))]
    Count {
        /// The counted quantity.
        what: &'static str,
        /// The given number.
        count: usize,
        /// The smallest allowed number of basis functions or modes.
        least: usize,
        /// The largest allowed number of basis functions or modes.
        most: usize,
    },
    /// The quadrature rule has too few points to distinguish the basis functions.
    #[error("{points} quadrature points are too few to resolve the shape functions of the plate")]
    #[diagnostic(help("use {needed} quadrature points or more"))]
    TooFewPoints {
        /// The number of points of the quadrature rule.
        points: usize,
        /// The smallest sufficient number of quadrature points.
        needed: usize,
    },
    /// The requested accuracy of the modes of vibration is out of the range that double precision
    /// allows.
    #[error("the setting mode_accuracy is {accuracy:e}, but must be between 1e-12 and 0.1")]
    AccuracyRange {
        /// The given accuracy.
        accuracy: f64,
    },
    /// The polynomial basis functions do not resolve the modes of vibration to the requested
    /// accuracy.
    #[error(
        "{modes} modes cannot reach a mode_accuracy of {accuracy:.1e}: with {} × {} functions, the \
         squared frequencies ω² of the modes have an error of {error:.1e}, and only {accurate} \
         modes are accurate enough", functions[0], functions[1]
    )]
    #[diagnostic(help(
        "request fewer modes, more functions (`orders`) if you set the orders, or a larger `mode_accuracy` \
         (free edges that meet at a corner limit the accuracy)"
    ))]
    Accuracy {
        /// The number of modes of vibration that was requested.
        modes: usize,
        /// The allowed relative error of the squared frequencies `ω²` of the modes.
        accuracy: f64,
        /// The estimated relative error of the squared frequencies `ω²` of the requested modes.
        error: f64,
        /// The numbers of basis functions of the deflection along x and y.
        functions: [usize; 2],
        /// The number of modes, counted from the lowest mode, that are accurate enough.
        accurate: usize,
    },
    /// Stresses were requested for a plate model without stretching, or with too many in-plane
    /// functions.
    #[error(
        "the in-plane stresses of the plate cannot be computed: the model has no stretching, or too \
         many in-plane functions"
    )]
    #[diagnostic(help("set `theory` to `von_karman`, or use fewer in-plane functions"))]
    NoMembrane,
    /// The value of a parameter is outside the domain of the equations.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Domain(#[from] crate::core::failure::Failure),
}

impl PlateError {
    /// Returns [`PlateError::Count`] unless `least ≤ count ≤ most`.
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
