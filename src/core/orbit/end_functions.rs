//! Numbers of hybrid orbits that depend on the states at the ends of their legs.

use super::decision_switching::decision_after;
use super::hybrid::HybridOrbit;
use super::itinerary::Leg;
use super::legs::OrbitLegs;
use super::measures::{APPROACH, DECISION, OWN, PENETRATION, SHORTEST, SPACING};
use super::timed_events::spacing;
use crate::core::bvp::{EndFunctions, Ends};
use crate::core::hybrid::{
    EventNumber, FieldNumber, GuardNumber, MeasureNumber, Moment, Passage, virtual_point,
};
use crate::core::scalar::Scalar;
use num_dual::Dual;

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
        let (legs, layout, system) = (self.legs(), &self.legs().layout, self.legs().system());
        let (p, durations) = (layout.p(q), layout.durations(q));
        let rate_at = |(_, guard, at): &(usize, usize, Moment<T>)| at.rate(*guard);
        let least = |a: T, b: T| if b.real() < a.real() { b } else { a };
        let infinite = T::from(f64::INFINITY);
        let vanishing =
            || events_of(legs, ends, q).filter(|(_, guard, _)| !legs.guards[*guard].is_timed());
        match function {
            APPROACH => vanishing().map(|event| -rate_at(&event)).fold(infinite, least),
            // Beyond the event that is approached most slowly.
            PENETRATION => {
                let speed = |event: &_| -rate_at(event).real();
                let within = durations.iter().map(|duration| duration.real()).sum();
                let slowest = vanishing().min_by(|a, b| speed(a).total_cmp(&speed(b)));
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
            SPACING => spacing(legs, ends, q),
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
