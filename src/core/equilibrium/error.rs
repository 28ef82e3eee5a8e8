//! Why a system has no equilibria.

use crate::core::problem::UnknownName;

/// Why equilibria of a hybrid system cannot be stated.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum EquilibriumError {
    /// Time enters the system.
    #[error("a system that is forced in time has no equilibria: follow its orbits")]
    Forced,
    /// A name that no mode has.
    #[error("{0}")]
    Unknown(#[from] UnknownName),
    /// A number that no mode has.
    #[error("there is no mode {number}: the system has {count} of them, counted from 0")]
    NoMode {
        /// The number.
        number: usize,
        /// How many modes there are.
        count: usize,
    },
    /// A mode without motion.
    #[error("mode `{0}` has no states, so that it has no equilibria: take a mode that moves")]
    NoStates(String),
}
