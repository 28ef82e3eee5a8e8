//! The share of the discretisation in the errors of special points.

/// The knowledge of the discretisation error of a special point after its refinement.
#[derive(PartialEq)]
pub(super) enum MeshShare {
    /// The error is unknown.
    Unknown,
    /// The solutions are not discretised, or the error is as small as requested.
    Sufficient,
    /// The error is larger than requested, because no finer discretisation is available.
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
