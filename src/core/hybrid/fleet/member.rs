//! The individual motions of a batched simulation.

use crate::core::hybrid::simulation::HybridState;

/// One of many motions that are simulated in parallel.
#[derive(Clone, Debug, PartialEq)]
pub struct Member<T> {
    /// The mode, time and state of the motion.
    pub state: HybridState<T>,
    /// The parameters.
    pub p: Vec<T>,
}
