//! What happens where an orbit grazes.

/// What happens where an orbit of a hybrid system grazes: by it a system knows how the field calls
/// the point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Tangency {
    /// A leg in a mode touches a guard that it does not pass.
    Touch {
        /// The guard.
        guard: usize,
        /// The mode.
        mode: usize,
    },
    /// An event is reached with no speed.
    Slow {
        /// The guard.
        guard: usize,
        /// The mode that ends there.
        mode: usize,
        /// The mode that follows.
        next: usize,
    },
    /// A leg lasts no time.
    Leg {
        /// The mode before it.
        before: usize,
        /// Its mode.
        mode: usize,
        /// The mode behind it.
        after: usize,
    },
    /// An event begins to lead to another mode.
    Decision {
        /// The guard.
        guard: usize,
        /// The mode that ends there.
        mode: usize,
        /// The mode that follows on the orbit.
        next: usize,
    },
}
