//! The share of the discretisation in the errors of special points.

/// Whether the discretisation error of a special point is known, and as small as requested, after
/// the refinement of the point.
#[derive(PartialEq)]
pub(super) enum MeshShare {
    /// The error is unknown.
    Unknown,
    /// The solutions are not discretised, or the error is as small as requested.
    Sufficient,
    /// The error is larger than requested, and finer discretisations are not available or do not
    /// converge.
    TooLarge(Shortfall),
}

/// A column of a special point whose discretisation error is larger than requested.
#[derive(Clone, PartialEq)]
pub(super) struct Shortfall {
    /// The name of the column.
    pub column: String,
    /// The relative error of the column.
    pub relative: f64,
}
