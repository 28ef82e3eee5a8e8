//! Orbits as simulations find them.

use super::hybrid::{HybridOrbit, IntoHybrid};
use super::itinerary::{Itinerary, Leg};
use super::legs::OrbitLegs;
use crate::core::bvp::{BoundarySystem, Guess, Method};
use crate::core::failure::Failure;
use crate::core::hybrid::{Cycle, CycleLeg};

/// How many events before an accumulation belong to it at least: from as many a simulation sees
/// that it comes, and when.
const SERIES: usize = 4;
/// And how many times as long as the rest that was not simulated they last.
const LONGER: f64 = 30.0;
/// (D) Infinitely many events within this part of the cycle are simultaneous: a state at its end is
/// not known better.
const AT_ONCE: f64 = 1e-9;

impl HybridOrbit {
    /// The orbits with the itinerary of a simulated cycle, and that cycle as one of them. Where
    /// events accumulate, the last ones of them are one leg.
    ///
    /// # Errors
    /// [`Failure`] if the simulated cycle holds nothing but events that accumulate, if they accumulate
    /// at their first one, or if the cycle is not one of the system.
    pub fn of_cycle(system: impl IntoHybrid, cycle: &Cycle) -> Result<Guess<Self>, Failure> {
        let (start, cycle_legs) = gathered(cycle)?;
        let leg =
            |leg: &CycleLeg| Leg { accumulates: leg.accumulation, ..Leg::new(leg.mode, leg.exit) };
        let legs = cycle_legs.iter().map(leg).collect();
        let itinerary = Itinerary { legs, periods: cycle.periods };
        let trajectories = cycle_legs.iter().map(|leg| leg.start.clone().into()).collect();
        let durations = cycle_legs.iter().map(|leg| leg.duration);
        let problem = HybridOrbit::of(system, itinerary)
            .map_err(|cause| Failure::Unsupported(cause.to_string()))?;
        rebounds(problem.legs(), &cycle_legs)?;
        let layout = &problem.legs().layout;
        // The time of the start comes first where it is an unknown.
        let extras = match layout.smooth && layout.forced {
            true => Vec::new(),
            false => layout.starts().then_some(start).into_iter().chain(durations).collect(),
        };
        Ok(Guess { problem, trajectories, extras, beside: None })
    }
}

/// The periodic orbits of a system with the itinerary of a simulated cycle, on a number of
/// intervals for each leg, and the unknowns `z` of that cycle, from which a branch starts.
///
/// The system is smooth or hybrid, autonomous or forced; a vector field is wrapped in
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
/// // Stable orbits, as far as their period doubling.
/// let doubling = branch.of_kind(Kind::PD).next().unwrap();
/// assert!((doubling.parameters[0] - 0.630302006160).abs() < 1e-9);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`Failure`] if the cycle contains an accumulation of events, if there is no interval, or if a
/// leg leaves the domain of its field.
pub fn from_cycle(
    system: impl IntoHybrid,
    cycle: &Cycle,
    p: &[f64],
    method: impl Into<Method>,
    intervals: usize,
) -> Result<(BoundarySystem, Vec<f64>), Failure> {
    HybridOrbit::of_cycle(system, cycle)?.discretised(p, method, intervals)
}

/// The legs of a cycle, and when the first one begins: those before an accumulation that belong to
/// it are one with it.
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
        true => Err(Failure::Unsupported(
            "the simulated cycle is nothing but events that accumulate".into(),
        )),
        false => Ok((start, gathered)),
    }
}

/// Refuses events that accumulate at their first one: the leg of the ones that follow would have no
/// length on any orbit nearby, and its duration would have no derivatives.
fn rebounds(orbit: &OrbitLegs, legs: &[CycleLeg]) -> Result<(), Failure> {
    let whole = legs.iter().map(|leg| leg.duration).sum::<f64>();
    let still = |leg: &&CycleLeg| leg.accumulation && leg.duration <= AT_ONCE * whole;
    let Some((leg, guard)) = legs.iter().find(still).and_then(|leg| Some((leg, leg.exit?))) else {
        return Ok(());
    };
    let (mode, guard) = (&orbit.modes[leg.mode].name, &orbit.guards[guard]);
    let rest = guard.accumulates_to.map_or("contact", |mode| orbit.modes[mode].name.as_str());
    Err(Failure::Unsupported(format!(
        "the events {mode}:{} accumulate at the first one (within a time of {:.1e}), as with a restitution of 0: \
         there is no rebound; let the event itself lead to the mode that follows the accumulation, as with \
         `next: \"{rest}\"` in a text model",
        guard.name, leg.duration
    )))
}

/// Which of the legs before an accumulation is the first one that belongs to it: it follows one of
/// its events, and the intervals between them shrink from there on.
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
