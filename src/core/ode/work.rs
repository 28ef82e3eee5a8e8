//! What flows cost.

use std::cell::Cell;

/// What flows have done.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Work {
    /// How often they have evaluated a field.
    pub evaluations: u64,
    /// Over how much time they went, backwards or forwards.
    pub time: f64,
}

thread_local! {
    static WORK: Cell<Work> = const { Cell::new(Work { evaluations: 0, time: 0.0 }) };
}

/// What this thread's flows have done so far, on dual numbers or not: what tracing orbits by
/// shooting costs.
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

/// Counts a flow over this much time.
pub(super) fn add(evaluations: usize, length: f64) {
    let Work { evaluations: before, time } = WORK.get();
    WORK.set(Work { evaluations: before + evaluations as u64, time: time + length.abs() });
}
