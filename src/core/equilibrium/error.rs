//! Errors in setting up the equations for equilibria of a hybrid system.

use crate::core::problem::UnknownName;

/// Reasons why the equations for equilibria of a hybrid system cannot be set up.
#[derive(Clone, Debug, PartialEq, miette::Diagnostic, thiserror::Error)]
#[non_exhaustive]
pub enum EquilibriumError {
    /// The hybrid system depends on time.
    #[error("a system that is forced in time has no equilibria")]
    #[diagnostic(help("follow the periodic orbits of the system"))]
    Forced,
    /// No mode has the given name.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Unknown(#[from] UnknownName),
    /// No mode has the given number.
    #[error("mode {number} does not exist: the system has {count} modes, numbered from 0")]
    NoMode {
        /// The given number.
        number: usize,
        /// The number of modes of the hybrid system.
        count: usize,
    },
    /// The mode has no states, and therefore no equilibria.
    #[error("mode `{0}` has no states, so it has no equilibria")]
    #[diagnostic(help("use a mode with states"))]
    NoStates(String),
}
