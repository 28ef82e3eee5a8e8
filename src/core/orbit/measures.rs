//! Monitors of hybrid orbits: the system's measures, and the monitors that vanish at grazings.

use super::decision_switching::decisions;
use super::itinerary::Leg;
use super::legs::OrbitLegs;
use super::timed_events::has_spaces;
use crate::core::bvp::{Monitor, Watched};
use crate::core::hybrid::Guard;
use crate::core::problem::{Measure, Observable};

/// The names of the monitors that are positive on admissible orbits and vanish at grazings.
pub(crate) const GRAZINGS: [&str; 5] = ["approach", "shortest", "decision", "distance", "spacing"];

/// The indices of the functions of the states at the ends of legs (parts of an orbit between two
/// events): the smallest approach speed, the shortest duration, the penetration after the event
/// with the smallest approach speed, the smallest decision margin, and the shortest time to a timed
/// event. The indices of the functions that the system itself defines follow these indices.
pub(super) const APPROACH: usize = 0;
pub(super) const SHORTEST: usize = 1;
pub(super) const PENETRATION: usize = 2;
pub(super) const DECISION: usize = 3;
pub(super) const SPACING: usize = 4;
pub(super) const OWN: usize = 5;

/// Returns the segments on which a scalar is defined, each with the watched function that
/// represents the scalar on this segment.
pub(super) fn on_segments(scalars: impl IntoIterator<Item = Option<Observable>>) -> Vec<Watched> {
    let all = scalars.into_iter().enumerate();
    all.filter_map(|(segment, observable)| Some(Watched::new(segment, observable?))).collect()
}

/// Returns the monitors of the orbits: the period, the system's measures, and the monitors that
/// vanish at grazings.
pub(super) fn monitors_of(legs: &OrbitLegs) -> Vec<(String, Monitor)> {
    let measures = legs.system.measures().into_iter();
    let known = measures.map(|(name, measure)| (name, on_legs(legs, &measure)));
    let [approach, shortest, decision, distance, spacing] = GRAZINGS.map(String::from);
    let mut monitors = vec![("period".to_string(), Monitor::Duration)];
    monitors.extend(known);
    if !legs.layout.smooth {
        let vanishing = |leg: &Leg| leg.exit.is_some_and(|guard| !legs.guards[guard].is_timed());
        if legs.all().iter().any(vanishing) {
            monitors.push((approach, Monitor::Ends(APPROACH)));
        }
        monitors.push((shortest, Monitor::Ends(SHORTEST)));
    }
    if decisions(legs).next().is_some() {
        monitors.push((decision, Monitor::Ends(DECISION)));
    }
    if has_spaces(legs) {
        monitors.push((spacing, Monitor::Ends(SPACING)));
    }
    let guards = watched_guards(legs);
    if legs.penetration {
        let of_guards = || Monitor::Penetration(guards.clone());
        let measure = if legs.layout.smooth { of_guards() } else { Monitor::Ends(PENETRATION) };
        monitors.push((Measure::PENETRATION.into(), measure));
    }
    if !guards.is_empty() {
        monitors.push((distance, Monitor::Distance(guards)));
    }
    monitors
}

/// Returns the monitor that computes a measure on the orbits. The watched functions are the guards,
/// followed by the system's monitors.
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

/// Returns all guards along the legs (parts between two events) of the orbits, each with two flags:
/// whether the guard belongs to the event at the beginning of its leg, and whether it belongs to
/// the event at the end.
fn watched_guards(legs: &OrbitLegs) -> Vec<Watched> {
    let (all, mut watched) = (legs.all(), Vec::new());
    for (s, leg) in all.iter().enumerate().filter(|(_, leg)| !leg.accumulates) {
        let before = all[(s + all.len() - 1) % all.len()];
        let entry = before.exit.map(|g| &legs.guards[g].name);
        for guard in legs.vanishing_in(leg.mode) {
            let Guard { name, accumulates_to, .. } = &legs.guards[guard];
            // Motion released from rest on a surface begins on that surface, whatever event
            // releases it.
            let rested = *accumulates_to == Some(before.mode);
            let own = [rested || entry == Some(name), leg.exit == Some(guard)];
            // An event at a given time may move the state beyond a surface.
            let is_timed = before.exit.is_some_and(|guard| legs.guards[guard].is_timed());
            // Several guards of one surface have the same name.
            let ends_elsewhere = leg.exit.is_some_and(|exit| legs.guards[exit].name != *name);
            let free = [is_timed, ends_elsewhere].map(|free| free && !legs.layout.smooth);
            watched.push(Watched::function(s, guard).vanishing(own).with_free_ends(free));
        }
    }
    watched
}
