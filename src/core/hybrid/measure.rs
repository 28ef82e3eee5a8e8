//! What is measured on a hybrid orbit.

/// A number of a hybrid orbit that is recorded along a branch.
///
/// States are given by name; the extremes are those over all legs whose mode has the state, inside legs
/// as well as at their ends.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Measure {
    /// The largest value of a state.
    Maximum(String),
    /// The smallest value of a state.
    Minimum(String),
    /// The difference between the largest and the smallest value of a state.
    Range(String),
    /// The largest value of a state where another one passes through zero, rising; 0 where it never does.
    Rising {
        /// The state that rises through zero.
        through: String,
        /// The state whose value is taken.
        value: String,
    },
    /// How far motion goes beyond the surface of the event that it approaches most slowly, or would go were the
    /// surface not there ([`virtual_point`](super::virtual_point)): the size of the guard there. Of a motion without
    /// events, the least distance from a surface, negative.
    Penetration,
    /// A number that the system computes from the states at the ends of all legs, by its position
    /// ([`HybridSystem::measure`](super::HybridSystem::measure)).
    Cycle(usize),
}

impl Measure {
    /// The name of [`Penetration`](Self::Penetration), which every hybrid system has.
    pub const PENETRATION: &str = "penetration";
}

/// One leg of a hybrid orbit, seen by its ends.
#[derive(Clone, Copy, Debug)]
pub struct Passage<'a, T> {
    /// The mode.
    pub mode: usize,
    /// The guard at which it ends; `None` if it does not end.
    pub exit: Option<usize>,
    /// The state where it begins.
    pub start: &'a [T],
    /// The state where it ends, before the event.
    pub end: &'a [T],
}
