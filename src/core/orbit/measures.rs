//! What is recorded along branches of hybrid orbits: the system's measures, and what says where
//! they graze.

use super::hybrid::HybridOrbit;
use crate::core::bvp::{EndFunctions, Ends, Monitor, Watched};
use crate::core::hybrid::{
    EventNumber, FieldNumber, Guard, GuardNumber, MeasureNumber, Moment, Passage, virtual_point,
};
use crate::core::measure::Measure;
use crate::core::scalar::Scalar;
use crate::core::watch::Observable;
use num_dual::Dual;

/// Functions of the states at the ends: the least approach speed, the shortest duration, the
/// penetration of the event that is approached most slowly, the least margin of decisions, and from
/// here on the system's own.
pub(super) const APPROACH: usize = 0;
pub(super) const SHORTEST: usize = 1;
const PENETRATION: usize = 2;
pub(super) const DECISION: usize = 3;
const OWN: usize = 4;

/// The monitor of a measure, given the scalar of a name on each segment; `None` for measures of
/// events.
pub(super) fn monitor_of(
    measure: &Measure,
    scalars: impl Fn(&str) -> Vec<Option<Observable>>,
) -> Option<Monitor> {
    let all = |name: &String| -> Vec<Watched> {
        let on_segments = scalars(name).into_iter().enumerate();
        on_segments.filter_map(|(segment, o)| Some(Watched { segment, observable: o? })).collect()
    };
    Some(match measure {
        Measure::Maximum(name) => Monitor::Maximum(all(name)),
        Measure::Minimum(name) => Monitor::Minimum(all(name)),
        Measure::Range(name) => Monitor::Range(all(name)),
        Measure::Rising { through, value } => {
            let values = scalars(value);
            let both = |w: Watched| Some((w, values[w.segment]?));
            Monitor::Rising(all(through).into_iter().filter_map(both).collect())
        }
        Measure::Integral(integral, names) => {
            Monitor::Integral(*integral, names.iter().flat_map(all).collect())
        }
        Measure::Penetration | Measure::Cycle(_) => return None,
    })
}

impl HybridOrbit {
    pub(super) fn monitor(&self, measure: &Measure) -> Monitor {
        let of_motion = || monitor_of(measure, |name| self.scalars_on_legs(name));
        match measure {
            Measure::Cycle(k) => Monitor::Ends(OWN + k),
            Measure::Penetration if !self.smooth() => Monitor::Ends(PENETRATION),
            _ => of_motion().unwrap_or_else(|| Monitor::Penetration(self.watched_guards())),
        }
    }

    /// The scalar of a name on each leg. Functions are numbered from the guards on to the system's
    /// monitors.
    fn scalars_on_legs(&self, name: &str) -> Vec<Option<Observable>> {
        let (in_modes, guards) = (self.system().scalars(&self.modes, name), self.guards.len());
        let numbered = |observable| match observable {
            Observable::Function(monitor) => Observable::Function(guards + monitor),
            state => state,
        };
        self.legs().iter().map(|leg| in_modes[leg.mode].map(numbered)).collect()
    }

    /// All guards along the legs, and whether they belong to the events that begin and end the leg.
    pub(super) fn watched_guards(&self) -> Vec<(Watched, [bool; 2])> {
        let legs = self.legs();
        let mut watched = Vec::new();
        for (s, leg) in legs.iter().enumerate().filter(|(_, leg)| !leg.accumulates) {
            let before = legs[(s + legs.len() - 1) % legs.len()];
            let entry = before.exit.map(|g| &self.guards[g].name);
            for guard in self.guards_in(leg.mode) {
                let Guard { name, accumulates_to, .. } = &self.guards[guard];
                // Motion that is released from rest on a surface begins there, whatever released
                // it.
                let rested = *accumulates_to == Some(before.mode);
                let own = [rested || entry == Some(name), leg.exit == Some(guard)];
                watched.push((Watched::function(s, guard), own));
            }
        }
        watched
    }

    /// The leg that each event ends, its guard, and time and state at which it is reached; none of
    /// those that accumulate.
    fn events_of<'a, T: Scalar>(
        &'a self,
        ends: Ends<'a, T>,
        q: &'a [T],
    ) -> impl Iterator<Item = (usize, usize, Moment<'a, T>)> + 'a {
        let ((p, extras), system) = (self.split(q), self.system());
        let durations = self.durations(extras);
        let mut t = self.time(0, q);
        self.legs().iter().enumerate().filter_map(move |(s, leg)| {
            t += durations[s];
            let x = &ends.end[self.of_leg(s)];
            let guard = leg.exit.filter(|_| !leg.accumulates)?;
            Some((s, guard, Moment { system, mode: leg.mode, t, x, p }))
        })
    }
}

impl<T> EndFunctions<T> for HybridOrbit
where
    T: EventNumber + MeasureNumber,
    Dual<T>: FieldNumber + GuardNumber,
    Dual<Dual<T>>: GuardNumber,
{
    fn of_ends_in(&self, function: usize, ends: Ends<T>, q: &[T]) -> T {
        let ((p, extras), system) = (self.split(q), self.system());
        let rate_at = |(_, guard, at): &(usize, usize, Moment<T>)| at.rate(*guard);
        let least = |a: T, b: T| if b.real() < a.real() { b } else { a };
        let infinite = T::from(f64::INFINITY);
        match function {
            APPROACH => self.events_of(ends, q).map(|event| -rate_at(&event)).fold(infinite, least),
            // Beyond the event that is approached most slowly.
            PENETRATION => {
                let speed = |event: &_| -rate_at(event).real();
                let within = self.durations(extras).iter().map(|duration| duration.real()).sum();
                let slowest = self.events_of(ends, q).min_by(|a, b| speed(a).total_cmp(&speed(b)));
                let turn = slowest.and_then(|(_, guard, Moment { mode, t, x, .. })| {
                    let (time, x) = virtual_point(system, (guard, mode), (t, x), p, within)?;
                    Some(-system.guard(guard, mode, time, &x, p))
                });
                turn.unwrap_or_else(T::zero)
            }
            DECISION => {
                let margins =
                    self.events_of(ends, q).filter_map(|(leg, _, at)| self.margin(leg, at));
                margins.fold(infinite, least)
            }
            SHORTEST => self.durations(extras).iter().copied().fold(infinite, least),
            own => {
                let passage = |(s, leg): (usize, &super::Leg)| {
                    let (start, end) = (&ends.start[self.of_leg(s)], &ends.end[self.of_leg(s)]);
                    Passage { mode: leg.mode, exit: leg.exit, start, end }
                };
                let legs: Vec<Passage<T>> = self.legs().iter().enumerate().map(passage).collect();
                system.measure(own - OWN, &legs, self.itinerary.periods, p)
            }
        }
    }
}
