//! Members of a fleet.

use crate::core::hybrid::simulation::HybridState;

/// One of many motions.
#[derive(Clone, Debug, PartialEq)]
pub struct Member<T> {
    /// The mode, time and states.
    pub state: HybridState<T>,
    /// The parameters.
    pub p: Vec<T>,
}
