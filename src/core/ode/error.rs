//! Errors in the settings of a flow.

/// An invalid setting of a flow.
#[derive(Clone, Copy, Debug, PartialEq, miette::Diagnostic, thiserror::Error)]
#[non_exhaustive]
pub enum SettingsError {
    /// A tolerance is negative, NaN, or too small for double precision.
    #[error(
        "the tolerances of a flow are {relative:.1e} (relative) and {absolute:.1e} (absolute), but \
         the relative tolerance must be at least 1e-15, and the absolute tolerance must be \
         positive"
    )]
    Tolerance {
        /// The relative tolerance.
        relative: f64,
        /// The absolute tolerance.
        absolute: f64,
    },
    /// The first or the largest step is not a positive fraction of the flow.
    #[error(
        "a step of a flow, as a fraction of the flow's duration, must be between 0 and 1, but is {0}"
    )]
    Step(f64),
    /// The largest number of steps is zero.
    #[error("the settings allow no step, but a flow needs at least one step")]
    #[diagnostic(help("allow at least one step"))]
    Steps,
}
