//! How a curve leaves a branch point.

/// A branch point that a curve leaves, along a tangent that is not that of the branch which leads to it.
pub(super) struct Departure {
    pub unknowns: Vec<f64>,
    /// Of scaled length 1, both.
    pub tangent: Vec<f64>,
    pub parent: Vec<f64>,
}
