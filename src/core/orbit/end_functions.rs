//! Functions of hybrid orbits that depend on the states at the ends of their legs.

use super::decision_switching::decision_after;
use super::hybrid::HybridOrbit;
use super::itinerary::Leg;
use super::measures::{APPROACH, DECISION, OWN, PENETRATION, SHORTEST, SPACING};
use super::timed_events::spacing;
use crate::core::bvp::{EndFunctions, Ends};
use crate::core::hybrid::{
    EventNumber, FieldNumber, GuardNumber, MeasureNumber, Moment, Passage, virtual_point,
};
use num_dual::Dual;

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
            || legs.events(ends, q).filter(|(_, guard, _)| !legs.guards[*guard].is_timed());
        match function {
            APPROACH => vanishing().map(|event| -rate_at(&event)).fold(infinite, least),
            // The penetration is measured after the event with the smallest approach speed.
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
                legs.events(ends, q).filter_map(margin).fold(infinite, least)
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
