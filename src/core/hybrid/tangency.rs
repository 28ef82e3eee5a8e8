//! Classification of grazings.

/// The event that makes an orbit of a hybrid system graze; a system derives the standard name of the
/// point from it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Tangency {
    /// A leg in a mode touches a guard without passing it.
    Touch {
        /// The guard.
        guard: usize,
        /// The mode.
        mode: usize,
    },
    /// An event is reached with zero speed.
    Slow {
        /// The guard.
        guard: usize,
        /// The mode that the event ends.
        mode: usize,
        /// The next mode.
        next: usize,
    },
    /// A leg has zero duration.
    Leg {
        /// The mode before the leg.
        before: usize,
        /// The mode of the leg.
        mode: usize,
        /// The mode after the leg.
        after: usize,
    },
    /// An event starts to lead to another mode.
    Decision {
        /// The guard.
        guard: usize,
        /// The mode that the event ends.
        mode: usize,
        /// The next mode on the orbit.
        next: usize,
    },
}
