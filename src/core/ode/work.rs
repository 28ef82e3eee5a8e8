//! The cost of flows, counted for each thread.

use std::cell::Cell;

/// The computational work of flows.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Work {
    /// The number of evaluations of vector fields.
    pub evaluations: u64,
    /// The total duration of the flows, counting backward flows as positive.
    pub time: f64,
}

thread_local! {
    static WORK: Cell<Work> = const { Cell::new(Work { evaluations: 0, time: 0.0 }) };
}

/// Returns the work of all flows of this thread so far, in any scalar type: the cost of tracing
/// orbits by shooting.
///
/// ```
/// use tangency::core::ode::{Flow, Settings, work};
/// use tangency::problems::classic::Lure;
/// let before = work();
/// let mut flow = Flow::<f64>::new(Settings::default()).unwrap();
/// let statistics = flow.advance(&Lure, 0.0, 1.0, &mut [0.1, 0.0, 0.0], &[0.8, 1.0]).unwrap();
/// assert_eq!(work().evaluations - before.evaluations, statistics.evaluations as u64);
/// assert_eq!(work().time - before.time, 1.0);
/// ```
pub fn work() -> Work {
    WORK.get()
}

/// Adds the evaluations and the duration of one flow to the counted work of this thread. A trial solution
/// may have an infinite duration, which is not counted.
pub(super) fn add(evaluations: usize, length: f64) {
    let Work { evaluations: before, time } = WORK.get();
    let duration = if length.is_finite() { length.abs() } else { 0.0 };
    WORK.set(Work { evaluations: before + evaluations as u64, time: time + duration });
}
