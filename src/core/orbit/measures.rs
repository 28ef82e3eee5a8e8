//! What is recorded along branches of hybrid orbits: the system's measures, and what says where
//! they graze.

use super::decision_switching::decisions;
use super::itinerary::Leg;
use super::legs::OrbitLegs;
use super::timed_events::has_spaces;
use crate::core::bvp::{Monitor, Watched};
use crate::core::hybrid::Guard;
use crate::core::problem::{Measure, Observable};

/// Names of the monitors that are positive on admissible orbits.
pub(crate) const GRAZINGS: [&str; 5] = ["approach", "shortest", "decision", "distance", "spacing"];

/// Functions of the states at the ends: the least approach speed, the shortest duration, the
/// penetration of the event that is approached most slowly, the least margin of decisions, the least
/// time to an event at a given time, and from here on the system's own.
pub(super) const APPROACH: usize = 0;
pub(super) const SHORTEST: usize = 1;
pub(super) const PENETRATION: usize = 2;
pub(super) const DECISION: usize = 3;
pub(super) const SPACING: usize = 4;
pub(super) const OWN: usize = 5;

/// The scalar on each segment that has it.
pub(super) fn on_segments(scalars: impl IntoIterator<Item = Option<Observable>>) -> Vec<Watched> {
    let all = scalars.into_iter().enumerate();
    all.filter_map(|(segment, observable)| Some(Watched::new(segment, observable?))).collect()
}

/// What is recorded of orbits: the period, the system's measures, and the limits of the itinerary.
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
        for guard in legs.vanishing_in(leg.mode) {
            let Guard { name, accumulates_to, .. } = &legs.guards[guard];
            // Motion that is released from rest on a surface begins there, whatever released it.
            let rested = *accumulates_to == Some(before.mode);
            let own = [rested || entry == Some(name), leg.exit == Some(guard)];
            watched.push(Watched::function(s, guard).vanishing(own));
        }
    }
    watched
}
