//! Grazing points of an orbit: points at which a guard vanishes but its event does not occur.

use super::known_orbit::{KnownOrbit, VANISHES};
use crate::core::failure::Failure;
use crate::core::hybrid::{FieldNumber, GuardOf, time_scale};
use crate::core::ode::{Extrema, Flow};
use std::ops::ControlFlow;

/// A point at which an orbit is closest to a guard's surface.
pub(super) struct Touch {
    pub leg: usize,
    pub guard: usize,
    /// The time from the beginning of the leg to the point.
    pub since: f64,
    /// The value of the guard at the point.
    pub value: f64,
    pub x: Vec<f64>,
}

/// Returns the grazing points of an orbit in the order of time; if the orbit does not graze any
/// guard, returns the point at which the orbit is closest to a guard.
pub(super) fn touches(orbit: &KnownOrbit) -> Result<Vec<Touch>, Failure> {
    let (legs, mut found) = (orbit.legs, Vec::<(Touch, f64)>::new());
    for leg in (0..legs.all().len()).filter(|leg| !legs.all()[*leg].accumulates) {
        let begin = orbit.moment(leg, orbit.begins(leg), orbit.known[leg].start());
        for guard in legs.vanishing_in(begin.mode) {
            let scale = begin.scale(guard);
            let dips = dips(orbit, leg, guard, scale)?;
            found.extend(dips.into_iter().map(|touch| (touch, VANISHES * scale)));
        }
    }
    let nearest = found.iter().map(|(touch, _)| touch.value.abs()).reduce(f64::min);
    let Some(nearest) = nearest else {
        let reason = "the orbit is not close to any guard, but a branch emanates only where the \
                      orbit grazes a guard (G)";
        return Err(Failure::Undetermined(reason.into()));
    };
    found.retain(|(touch, zero)| touch.value.abs() <= zero.max(nearest));
    let mut touches: Vec<Touch> = found.into_iter().map(|(touch, _)| touch).collect();
    touches.sort_by(|a, b| a.leg.cmp(&b.leg).then(a.since.total_cmp(&b.since)));
    Ok(touches)
}

/// Returns the local minima of a guard, whose scale is `scale`, on a leg.
fn dips(orbit: &KnownOrbit, leg: usize, guard: usize, scale: f64) -> Result<Vec<Touch>, Failure> {
    let mut found = minima(orbit, leg, guard, scale)?;
    if !orbit.legs.layout.smooth {
        // A minimum this close to an event belongs to the event.
        let (unit, duration) = (time_scale(orbit.system(), orbit.p()), orbit.length(leg));
        found.retain(|(since, _)| since.min(duration - since) > VANISHES * unit);
    }
    let touch = |(since, value): (f64, f64)| {
        Ok(Touch { leg, guard, since, value, x: orbit.state_on(leg, since)? })
    };
    found.into_iter().map(touch).collect()
}

/// Returns the minima of a guard on a leg (a part of an orbit between two events), each with its
/// time since the beginning of the leg and with the value of the guard.
fn minima(
    orbit: &KnownOrbit,
    leg: usize,
    guard: usize,
    scale: f64,
) -> Result<Vec<(f64, f64)>, Failure> {
    let (system, mode, p) = (orbit.system(), orbit.legs.mode(leg), orbit.p());
    let (motion, duration, begins) = (&orbit.known[leg], orbit.length(leg), orbit.begins(leg));
    let watch = GuardOf { system, guard, mode, scale };
    let field = f64::in_mode(system, mode, 0.0);
    let (mut flow, mut extrema) = (Flow::<f64>::default(), Extrema::default());
    let mut search = |begin: f64, length: f64, states: &[f64], steps: usize| {
        let (mut found, mut left, mut x) = (Vec::new(), steps, states.to_vec());
        let outcome = flow.observe(&field, begins + begin, length, &mut x, p, |step| {
            extrema.search(&watch, step, |extremum| {
                found.push((begin + extremum.place * length, extremum.value));
            });
            left -= 1;
            if left == 0 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        });
        outcome.map(|_| found)
    };
    let ends = || motion.nodes().skip(1).map(|(time, _)| time).chain([duration]);
    let mut all = Vec::<(f64, f64)>::new();
    for ((begin, states), end) in motion.nodes().zip(ends()) {
        all.extend(search(begin, end - begin, states, usize::MAX)?);
    }
    if let (true, Some(end)) = (orbit.legs.layout.smooth, ends().next()) {
        // The end coincides with the beginning, where there may be an extremum, too.
        all.extend(search(0.0, end, motion.start(), 1)?);
        all = distinct(all, duration);
    }
    Ok(all)
}

/// Returns the points of a closed orbit without their repetitions: an extremum at the beginning of the
/// orbit can also be found at the end, because the orbit is closed only up to its errors.
fn distinct(all: Vec<(f64, f64)>, duration: f64) -> Vec<(f64, f64)> {
    let mut kept = Vec::<(f64, f64)>::new();
    for (since, value) in all {
        let is_same = |(other, _): &(f64, f64)| {
            let apart = (since - other).abs();
            apart.min(duration - apart) <= VANISHES * duration
        };
        if !kept.iter().any(is_same) {
            kept.push((since, value));
        }
    }
    kept
}
