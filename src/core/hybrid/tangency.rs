//! Classification of grazings.

/// The kind of grazing of an orbit of a hybrid system; the system derives the standard name of the
/// bifurcation from this kind.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Tangency {
    /// A leg in a mode touches the surface of a guard without crossing it.
    Touch {
        /// The guard.
        guard: usize,
        /// The mode.
        mode: usize,
    },
    /// An event is reached with zero approach speed.
    Slow {
        /// The guard.
        guard: usize,
        /// The mode before the event.
        mode: usize,
        /// The next mode.
        next: usize,
    },
    /// A leg of the orbit (the part between two successive events) has zero duration.
    Leg {
        /// The mode before the leg.
        before: usize,
        /// The mode of the leg.
        mode: usize,
        /// The mode after the leg.
        after: usize,
    },
    /// A decision function vanishes, so that an event starts to lead to another mode.
    Decision {
        /// The guard.
        guard: usize,
        /// The mode before the event.
        mode: usize,
        /// The next mode after the event on the orbit.
        next: usize,
    },
}
