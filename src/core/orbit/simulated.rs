//! Orbit problems created from simulated cycles.

use super::accumulation::check_rebound;
use super::hybrid::{HybridOrbit, IntoHybrid};
use super::itinerary::{Itinerary, Leg};
use super::known_orbit::VANISHES;
use super::legs::OrbitLegs;
use crate::core::bvp::{BoundarySystem, Guess, Method};
use crate::core::failure::{Failure, one_line};
use crate::core::hybrid::{Cycle, CycleLeg, Moment};
use crate::core::problem::gradient;

/// The minimal number of events, in a series of events that accumulate, before the accumulation; a
/// simulation needs this number to predict the accumulation and its time.
const SERIES: usize = 4;
/// The minimal ratio of two times: the duration of the simulated series of events, and the
/// remaining time until the events accumulate.
const LONGER: f64 = 30.0;

impl HybridOrbit {
    /// Creates the orbit problem with the itinerary of a simulated cycle, and the cycle itself as
    /// an initial guess. The last events before an accumulation are merged into one leg.
    ///
    /// # Errors
    /// [`Failure`] if all events of the cycle accumulate, if events accumulate at the first event
    /// of their series, if a guard jumps through zero, or if the cycle belongs to another system.
    pub fn of_cycle(
        system: impl IntoHybrid,
        cycle: &Cycle,
        p: &[f64],
    ) -> Result<Guess<Self>, Failure> {
        let (start, cycle_legs) = gathered(cycle)?;
        let leg =
            |leg: &CycleLeg| Leg { accumulates: leg.accumulation, ..Leg::new(leg.mode, leg.exit) };
        let legs = cycle_legs.iter().map(leg).collect();
        let itinerary = Itinerary { legs, periods: cycle.periods };
        let trajectories = cycle_legs.iter().map(|leg| leg.start.clone().into()).collect();
        let durations = cycle_legs.iter().map(|leg| leg.duration);
        let problem = HybridOrbit::of(system, itinerary)
            .map_err(|cause| Failure::Unsupported(one_line(&cause)))?;
        check_guards(problem.legs(), cycle, p)?;
        let whole = cycle.duration();
        for (leg, CycleLeg { duration, .. }) in cycle_legs.iter().enumerate() {
            check_rebound(problem.legs(), leg, *duration, whole)?;
        }
        let layout = &problem.legs().layout;
        // The start time comes first where it is an unknown.
        let extras = match layout.smooth && layout.forced {
            true => Vec::new(),
            false => layout.starts().then_some(start).into_iter().chain(durations).collect(),
        };
        Ok(Guess { problem, trajectories, extras, beside: None })
    }
}

/// Returns the system of periodic orbits with the itinerary of a simulated cycle and the given
/// number of mesh intervals per leg, and the vector `z` of unknowns of the cycle, from which a
/// branch can start.
///
/// The system can be smooth or hybrid, autonomous or forced; a vector field must be wrapped in
/// [`Smooth`](super::smooth::Smooth).
///
/// ```
/// use tangency::core::bvp::Collocation;
/// use tangency::core::continuation::Continuation;
/// use tangency::core::system::Kind;
/// use tangency::core::attractor::CycleSearch;
/// use tangency::core::hybrid::{HybridFlow, HybridSettings, HybridState};
/// use tangency::core::orbit::{Smooth, from_cycle};
/// use tangency::problems::classic::Lure;
/// let (p, start) = ([0.8, 1.0], HybridState { mode: 0, time: 0.0, x: vec![0.1, 0.0, 0.0] });
/// let mut flow = HybridFlow::new(&Smooth(Lure), HybridSettings::default())?;
/// let cycle = CycleSearch::default().find(&mut flow, start, &p)?;
/// let (mut orbits, z) = from_cycle(Smooth(Lure), &cycle, &p, Collocation::new(4)?, 20)?;
/// let branch = Continuation::new(&mut orbits)
///     .from(&z)
///     .at("alpha", 0.8)
///     .at("beta", 1.0)
///     .along("alpha", 0.6..=0.85)
///     .trace()?;
/// // Stable orbits, up to their period doubling.
/// let doubling = branch.of_kind(Kind::PD).next().unwrap();
/// assert!((doubling.parameters[0] - 0.630302006160).abs() < 1e-9);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`Failure`] if all events of the cycle accumulate, if the number of mesh intervals is 0, or if a
/// leg leaves the domain of its vector field.
pub fn from_cycle(
    system: impl IntoHybrid,
    cycle: &Cycle,
    p: &[f64],
    method: impl Into<Method>,
    intervals: usize,
) -> Result<(BoundarySystem, Vec<f64>), Failure> {
    HybridOrbit::of_cycle(system, cycle, p)?.discretised(p, method, intervals)
}

/// Returns the start time of the first leg, and the legs of a cycle, in which each series of
/// accumulating events is merged into one leg.
fn gathered(cycle: &Cycle) -> Result<(f64, Vec<CycleLeg>), Failure> {
    let (mut start, mut legs) = (cycle.start, cycle.legs.clone());
    let Some(last) = legs.iter().rposition(|leg| leg.accumulation) else {
        return Ok((start, legs));
    };
    start += legs[..=last].iter().map(|leg| leg.duration).sum::<f64>();
    legs.rotate_left(last + 1);
    let mut gathered = Vec::<CycleLeg>::new();
    for leg in legs {
        let first = if leg.accumulation { begins(&gathered, &leg) } else { gathered.len() };
        let before = gathered.split_off(first);
        let begun = before.first().unwrap_or(&leg);
        let (mode, start) = (begun.mode, begun.start.clone());
        let duration = before.iter().map(|leg| leg.duration).sum::<f64>() + leg.duration;
        gathered.push(CycleLeg { mode, start, duration, ..leg });
    }
    match gathered.iter().all(|leg| leg.accumulation) {
        true => Err(Failure::Unsupported("all events of the simulated cycle accumulate".into())),
        false => Ok((start, gathered)),
    }
}

/// Returns an error if a guard jumps through zero: if a guard is not zero at its event, or all its
/// derivatives are zero, no equation determines the time of the event.
fn check_guards(orbit: &OrbitLegs, cycle: &Cycle, p: &[f64]) -> Result<(), Failure> {
    let mut t = cycle.start;
    for CycleLeg { mode, exit, duration, end: x, accumulation, .. } in &cycle.legs {
        t += duration;
        let at = Moment { system: orbit.system(), mode: *mode, t, x, p };
        let vanishes = |guard: &usize| !accumulation && !orbit.guards[*guard].is_timed();
        let Some(guard) = exit.filter(vanishes) else { continue };
        let value = at.guard(guard);
        let (slopes, slope) =
            gradient((t, x), p, |t, x, p| orbit.system().guard(guard, *mode, t, x, p));
        let level = slopes.iter().chain([&slope]).all(|slope| *slope == 0.0);
        if level || value.abs() > VANISHES * at.scale(guard) {
            let (name, mode) = (&orbit.guards[guard].name, &orbit.modes[*mode].name);
            return Err(Failure::Unsupported(format!(
                "the guard `{name}` of mode `{mode}` jumps through zero: at its event, at t = \
                 {t:.6e}, the value of the guard is {value:.3e}{}. Equations of orbits need a \
                 guard that falls through zero continuously: write `b - a` in place of `if(a < b, \
                 1, -1)`, and `1 - x` in place of `1 - floor(x)`",
                if level { ", and all derivatives of the guard are zero" } else { "" }
            )));
        }
    }
    Ok(())
}

/// Returns the index of the first leg in the series of events before an accumulation: this leg
/// begins at an event of the series, and the intervals between all later events of the series
/// shrink.
fn begins(legs: &[CycleLeg], accumulation: &CycleLeg) -> usize {
    let (mut first, mut interval) = (legs.len(), accumulation.duration);
    let ended = (0..legs.len())
        .filter(|leg| legs[*leg].exit == accumulation.exit && !legs[*leg].accumulation);
    let mut lasts = interval;
    for (count, leg) in ended.rev().skip(1).enumerate() {
        let before = legs[leg + 1..first].iter().map(|leg| leg.duration).sum::<f64>();
        let another = legs[leg + 1..first].iter().any(|leg| leg.accumulation);
        let enough = count >= SERIES && lasts > LONGER * accumulation.duration;
        if before < interval || another || enough {
            break;
        }
        (first, interval, lasts) = (leg + 1, before, lasts + before);
    }
    first
}
