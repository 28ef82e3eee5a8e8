//! The legs of a hybrid orbit as measures see them.

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
