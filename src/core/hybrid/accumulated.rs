//! The accumulation of infinitely many events as a single map, with derivatives.

use super::erased::{EventNumber, HybridEquations};
use super::event::Event;
use super::leg::GuardOf;
use super::simulation::{HybridFlow, HybridSettings, HybridState};
use super::support::Surface;
use crate::core::problem::{ROOM, Watchable, erased};
use crate::core::scalar::{Chunk, Jet, Narrow};
use num_dual::{Dual, Dual2, Dual64};
use std::ops::ControlFlow;

/// Rounding: events that would accumulate within this time, in units of the system's time scale,
/// are not simulated: because of rounding errors, the times of the last events would be less
/// accurate than the predicted time of the accumulation.
const REST: f64 = 1e-3;
/// Heuristic: the longest simulation of accumulating events, as a multiple of the expected time of
/// accumulation.
const LONGEST: f64 = 1e3;

/// A scalar type in which the map from an event to the accumulation of the subsequent events can be
/// evaluated.
pub(in crate::core) trait ChatterNumber: EventNumber {
    /// Computes the accumulation of a guard's events after about the `expected` time, from a state
    /// just after one of these events; `None` if the events do not accumulate, or if the scalar
    /// type does not support simulation.
    fn accumulated(
        _system: &dyn HybridEquations,
        _guard: usize,
        _start: HybridState<Self>,
        _expected: f64,
        _p: &[Self],
    ) -> Option<Event<Self>> {
        None
    }
}

erased! {
    impl ChatterNumber for [f64, Dual64, Narrow, Chunk, Dual<Chunk>] {
        fn accumulated(
            system: &dyn HybridEquations,
            guard: usize,
            start: HybridState<Self>,
            expected: f64,
            p: &[Self],
        ) -> Option<Event<Self>> {
            follow(system, guard, start, expected, p)
        }
    }
    impl ChatterNumber for [Jet<ROOM>, Dual2<Chunk>] {}
}

/// Simulates the motion up to an accumulation.
fn follow<'a, T: EventNumber>(
    system: &'a dyn HybridEquations,
    guard: usize,
    mut start: HybridState<T>,
    expected: f64,
    p: &[T],
) -> Option<Event<T>>
where
    GuardOf<'a>: Watchable<T>,
{
    let settings = HybridSettings { accumulation: REST, ..HybridSettings::default() };
    let mut flow = HybridFlow::new(system, settings).ok()?;
    // During Newton's iteration the state can lie beyond the surface.
    let surface = Surface { system, guard, mode: start.mode, t: start.time };
    if flow.guards[guard].ends(start.mode) {
        let change = surface.change(&start.x, p, false);
        start.x.iter_mut().zip(change).for_each(|(x, change)| *x += change);
    }
    let mut found = None;
    let longest = T::constant(LONGEST * expected.abs());
    let outcome = flow.advance(&mut start, longest, p, &mut |event: &Event<T>| {
        if event.accumulation && event.guard == guard {
            found = Some(event.clone());
        }
        if found.is_some() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    });
    outcome.ok().and(found)
}
