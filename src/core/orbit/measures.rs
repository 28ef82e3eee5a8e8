//! What is recorded along branches of hybrid orbits: the system's measures, and what says where
//! they graze.

use super::decision_switching::{decision_after, decisions};
use super::hybrid::HybridOrbit;
use super::itinerary::Leg;
use super::legs::OrbitLegs;
use super::switching::GRAZINGS;
use crate::core::bvp::{EndFunctions, Ends, Monitor, Watched};
use crate::core::hybrid::{
    EventNumber, FieldNumber, Guard, GuardNumber, MeasureNumber, Moment, Passage, virtual_point,
};
use crate::core::problem::{Measure, Observable};
use crate::core::scalar::Scalar;
use num_dual::Dual;

/// Functions of the states at the ends: the least approach speed, the shortest duration, the
/// penetration of the event that is approached most slowly, the least margin of decisions, and from
/// here on the system's own.
pub(super) const APPROACH: usize = 0;
pub(super) const SHORTEST: usize = 1;
const PENETRATION: usize = 2;
pub(super) const DECISION: usize = 3;
const OWN: usize = 4;

/// The scalar on each segment that has it.
pub(super) fn on_segments(scalars: impl IntoIterator<Item = Option<Observable>>) -> Vec<Watched> {
    let all = scalars.into_iter().enumerate();
    all.filter_map(|(segment, observable)| Some(Watched::new(segment, observable?))).collect()
}

/// What is recorded of orbits: the period, the system's measures, and the limits of the itinerary.
pub(super) fn monitors_of(legs: &OrbitLegs, penetration: bool) -> Vec<(String, Monitor)> {
    let measures = legs.system.measures().into_iter();
    let known = measures.map(|(name, measure)| (name, on_legs(legs, &measure)));
    let [approach, shortest, decision, distance] = GRAZINGS.map(String::from);
    let mut monitors = vec![("period".to_string(), Monitor::Duration)];
    monitors.extend(known);
    if !legs.layout.smooth {
        monitors.push((approach, Monitor::Ends(APPROACH)));
        monitors.push((shortest, Monitor::Ends(SHORTEST)));
    }
    if decisions(legs).next().is_some() {
        monitors.push((decision, Monitor::Ends(DECISION)));
    }
    let guards = watched_guards(legs);
    if penetration {
        let of_guards = || Monitor::Penetration(guards.clone());
        let measure = if legs.layout.smooth { of_guards() } else { Monitor::Ends(PENETRATION) };
        monitors.push((Measure::PENETRATION.into(), measure));
    }
    if !guards.is_empty() {
        monitors.push((distance, Monitor::Distance(guards)));
    }
    monitors
}

/// The monitor of a measure. Functions are numbered from the guards on to the system's monitors.
fn on_legs(legs: &OrbitLegs, measure: &Measure) -> Monitor {
    let numbered = |observable| match observable {
        Observable::Function(monitor) => Observable::Function(legs.guards.len() + monitor),
        state => state,
    };
    let scalars = |name: &String| {
        let in_modes = legs.system().scalars(&legs.modes, name);
        on_segments(legs.all().iter().map(|leg| in_modes[leg.mode].map(numbered)))
    };
    match measure {
        Measure::Ends(position) => Monitor::Ends(OWN + position),
        measure => measure.map(scalars),
    }
}

/// All guards along the legs, and whether they belong to the events that begin and end the leg.
fn watched_guards(legs: &OrbitLegs) -> Vec<Watched> {
    let (all, mut watched) = (legs.all(), Vec::new());
    for (s, leg) in all.iter().enumerate().filter(|(_, leg)| !leg.accumulates) {
        let before = all[(s + all.len() - 1) % all.len()];
        let entry = before.exit.map(|g| &legs.guards[g].name);
        for guard in legs.guards_in(leg.mode) {
            let Guard { name, accumulates_to, .. } = &legs.guards[guard];
            // Motion that is released from rest on a surface begins there, whatever released it.
            let rested = *accumulates_to == Some(before.mode);
            let own = [rested || entry == Some(name), leg.exit == Some(guard)];
            watched.push(Watched::function(s, guard).vanishing(own));
        }
    }
    watched
}

/// The leg that each event ends, its guard, and time and state at which it is reached; none of
/// those that accumulate.
fn events_of<'a, T: Scalar>(
    legs: &'a OrbitLegs,
    ends: Ends<'a, T>,
    q: &'a [T],
) -> impl Iterator<Item = (usize, usize, Moment<'a, T>)> + 'a {
    let (p, system, durations) = (legs.layout.p(q), legs.system(), legs.layout.durations(q));
    let mut t = legs.layout.time(0, q);
    legs.all().iter().enumerate().filter_map(move |(s, leg)| {
        t += durations[s];
        let x = &ends.end[legs.layout.states(s)];
        let guard = leg.exit.filter(|_| !leg.accumulates)?;
        Some((s, guard, Moment { system, mode: leg.mode, t, x, p }))
    })
}

impl<T> EndFunctions<T> for HybridOrbit
where
    T: EventNumber + MeasureNumber,
    Dual<T>: FieldNumber + GuardNumber,
    Dual<Dual<T>>: GuardNumber,
{
    fn of_ends_in(&self, function: usize, ends: Ends<T>, q: &[T]) -> T {
        let (legs, layout, system) = (&self.legs, &self.legs.layout, self.legs.system());
        let (p, durations) = (layout.p(q), layout.durations(q));
        let rate_at = |(_, guard, at): &(usize, usize, Moment<T>)| at.rate(*guard);
        let least = |a: T, b: T| if b.real() < a.real() { b } else { a };
        let infinite = T::from(f64::INFINITY);
        match function {
            APPROACH => {
                events_of(legs, ends, q).map(|event| -rate_at(&event)).fold(infinite, least)
            }
            // Beyond the event that is approached most slowly.
            PENETRATION => {
                let speed = |event: &_| -rate_at(event).real();
                let within = durations.iter().map(|duration| duration.real()).sum();
                let slowest = events_of(legs, ends, q).min_by(|a, b| speed(a).total_cmp(&speed(b)));
                let turn = slowest.and_then(|(_, guard, Moment { mode, t, x, .. })| {
                    let (time, x) = virtual_point(system, (guard, mode), (t, x), p, within)?;
                    Some(-system.guard(guard, mode, time, &x, p))
                });
                turn.unwrap_or_else(T::zero)
            }
            DECISION => {
                let margin =
                    |(leg, _, at): (usize, usize, Moment<T>)| decision_after(legs, leg)?.margin(at);
                events_of(legs, ends, q).filter_map(margin).fold(infinite, least)
            }
            SHORTEST => durations.iter().copied().fold(infinite, least),
            own => {
                let passage = |(s, leg): (usize, &Leg)| {
                    let (start, end) = (&ends.start[layout.states(s)], &ends.end[layout.states(s)]);
                    Passage { mode: leg.mode, exit: leg.exit, start, end }
                };
                let passages: Vec<Passage<T>> =
                    legs.all().iter().enumerate().map(passage).collect();
                system.measure(own - OWN, &passages, legs.itinerary.periods, p)
            }
        }
    }
}
