//! Errors in stating the equilibria of a hybrid system.

use crate::core::problem::UnknownName;

/// Reasons why the equilibria of a hybrid system cannot be stated.
#[derive(Clone, Debug, PartialEq, miette::Diagnostic, thiserror::Error)]
#[non_exhaustive]
pub enum EquilibriumError {
    /// The system depends on time.
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
        /// The number of modes.
        count: usize,
    },
    /// The mode has no states.
    #[error("mode `{0}` has no states, so it has no equilibria")]
    #[diagnostic(help("use a mode with states"))]
    NoStates(String),
}
