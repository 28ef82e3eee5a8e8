//! What is recorded along branches of hybrid orbits: the system's measures, and what says where they graze.

use super::hybrid::HybridOrbit;
use crate::core::bvp::{EndFunctions, Ends, Monitor, Watched};
use crate::core::hybrid::{
    EventNumber, FieldNumber, GuardNumber, MeasureNumber, Passage, guard_scale, rate, time_scale,
    virtual_point,
};
use crate::core::measure::Measure;
use crate::core::scalar::Scalar;
use crate::core::watch::Observable;
use crate::core::zero::LeftDomain;
use num_dual::Dual;

/// Functions of the states at the ends: the least approach speed, the shortest duration, the penetration of the
/// event that is approached most slowly, and from here on the system's own.
const APPROACH: usize = 0;
const SHORTEST: usize = 1;
const PENETRATION: usize = 2;
const OWN: usize = 3;

/// What follows an event that is approached faster, in units of the scales, is beyond doubt.
const SURE: f64 = 1e-4;

/// Names of the monitors that are positive on admissible orbits.
const GRAZINGS: [&str; 3] = ["approach", "shortest", "distance"];

impl HybridOrbit {
    /// All monitors by name. Guards are the functions that are watched.
    pub(super) fn all_monitors(&self) -> Vec<(String, Monitor)> {
        let measures = self.system().measures();
        let known = measures.iter().map(|(name, measure)| (name.clone(), self.monitor(measure)));
        let [approach, shortest, distance] = GRAZINGS.map(String::from);
        let mut monitors = vec![("period".to_string(), Monitor::Duration)];
        monitors.extend(known);
        if !self.smooth() {
            monitors.push((approach, Monitor::Ends(APPROACH)));
            monitors.push((shortest, Monitor::Ends(SHORTEST)));
        }
        let guards = self.watched_guards();
        if self.penetration {
            monitors.push((Measure::PENETRATION.into(), self.monitor(&Measure::Penetration)));
        }
        if !guards.is_empty() {
            monitors.push((distance, Monitor::Distance(guards)));
        }
        monitors
    }

    /// The positions of those that are positive on admissible orbits.
    pub(super) fn grazing_monitors(&self) -> Vec<usize> {
        let names = self.all_monitors().into_iter().map(|(name, _)| name).enumerate();
        names.filter(|(_, name)| GRAZINGS.contains(&name.as_str())).map(|(k, _)| k).collect()
    }

    /// The typical size of one of them: that of the guards where states have half their scales, of their rates, or of
    /// time.
    pub(super) fn scale_of_grazing(&self, monitor: usize, p: &[f64]) -> f64 {
        let (system, time) = (self.system(), time_scale(self.system(), p));
        let scale = |mode: usize| {
            let mut x = system.scales_of(mode, p);
            x.resize(self.modes[mode].states.len(), 1.0);
            x.iter_mut().for_each(|x| *x *= 0.5);
            let guards = self.guards_in(mode);
            guards.map(move |guard| guard_scale(system, (guard, mode), (0.0, &x), p))
        };
        let modes = self.legs().iter().map(|leg| leg.mode);
        let least = || modes.flat_map(scale).reduce(f64::min).unwrap_or(1.0);
        match self.all_monitors().swap_remove(monitor).1 {
            Monitor::Ends(SHORTEST) => time,
            Monitor::Ends(APPROACH) => least() / time,
            _ => least(),
        }
    }

    fn monitor(&self, measure: &Measure) -> Monitor {
        let all = |name: &String| -> Vec<Watched> {
            let on_legs = self.scalars_on_legs(name).into_iter().enumerate();
            on_legs.filter_map(|(segment, o)| Some(Watched { segment, observable: o? })).collect()
        };
        match measure {
            Measure::Maximum(state) => Monitor::Maximum(all(state)),
            Measure::Minimum(state) => Monitor::Minimum(all(state)),
            Measure::Range(state) => Monitor::Range(all(state)),
            Measure::Rising { through, value } => {
                let values = self.scalars_on_legs(value);
                let both = |w: Watched| Some((w, values[w.segment]?));
                let (through, value) = all(through).into_iter().filter_map(both).unzip();
                Monitor::Rising { through, value }
            }
            Measure::Integral(integral, names) => {
                Monitor::Integral(*integral, names.iter().flat_map(all).collect())
            }
            Measure::Penetration if self.smooth() => Monitor::Penetration(self.watched_guards()),
            Measure::Penetration => Monitor::Ends(PENETRATION),
            Measure::Cycle(k) => Monitor::Ends(OWN + k),
        }
    }

    /// The scalar of a name on each leg. Functions are numbered from the guards on to the system's monitors.
    fn scalars_on_legs(&self, name: &str) -> Vec<Option<Observable>> {
        let (in_modes, guards) = (self.system().scalars(&self.modes, name), self.guards.len());
        let numbered = |observable| match observable {
            Observable::Function(monitor) => Observable::Function(guards + monitor),
            state => state,
        };
        self.legs().iter().map(|leg| in_modes[leg.mode].map(numbered)).collect()
    }

    /// All guards along the legs, and whether they belong to the events that begin and end the leg.
    fn watched_guards(&self) -> Vec<(Watched, [bool; 2])> {
        let legs = self.legs();
        let mut watched = Vec::new();
        for (s, leg) in legs.iter().enumerate() {
            let entry = legs[(s + legs.len() - 1) % legs.len()].exit.map(|g| &self.guards[g].name);
            for guard in self.guards_in(leg.mode) {
                let own = [entry == Some(&self.guards[guard].name), leg.exit == Some(guard)];
                watched.push((Watched::function(s, guard), own));
            }
        }
        watched
    }

    /// Refuses an orbit with an event that leads to another mode than the itinerary says. At an event that
    /// is tangent, or virtual, nothing can be told.
    pub(super) fn check_events(&self, ends: Ends<f64>, q: &[f64]) -> Result<(), LeftDomain> {
        let ((p, extras), legs) = (self.split(q), self.legs());
        for (s, leg) in legs.iter().enumerate() {
            let Some(guard) = leg.exit else { continue };
            let (x, time) =
                (&ends.end[self.of_leg(s)], self.time(s, q) + self.durations(extras)[s]);
            let approach = -rate(self.system(), (guard, leg.mode), time, x, p);
            let meant = legs[(s + 1) % legs.len()].mode;
            let next = self.system().next_mode(guard, leg.mode, time, x, p);
            let sure = || {
                let scale = guard_scale(self.system(), (guard, leg.mode), (time, x), p);
                approach > SURE * scale / time_scale(self.system(), p)
            };
            if next != meant && sure() {
                let (event, mode) = (&self.guards[guard].name, &self.modes[leg.mode].name);
                return Err(LeftDomain {
                    quantity: format!("the time of the event `{event}` of mode `{mode}`, leg {s},"),
                    value: time,
                    verdict: "leads to another mode than the itinerary says",
                    remedy: format!(
                        "it leads to `{}`, not to `{}`: write an itinerary that closes, or let a simulation find it",
                        self.modes[next].name, self.modes[meant].name
                    ),
                });
            }
        }
        Ok(())
    }

    /// Guard and mode of each event, its time, and the state at which it is reached.
    fn events_of<'a, T: Scalar>(
        &'a self,
        ends: Ends<'a, T>,
        q: &'a [T],
    ) -> impl Iterator<Item = ((usize, usize), T, &'a [T])> + 'a {
        let durations = self.durations(self.split(q).1);
        self.legs().iter().enumerate().filter_map(move |(s, leg)| {
            let time = self.time(s, q) + durations[s];
            Some(((leg.exit?, leg.mode), time, &ends.end[self.of_leg(s)]))
        })
    }

    /// How far motion would go beyond the event that it approaches most slowly.
    fn penetration<T>(&self, ends: Ends<T>, q: &[T]) -> T
    where
        T: EventNumber,
        Dual<T>: FieldNumber + GuardNumber,
        Dual<Dual<T>>: GuardNumber,
    {
        let (p, system) = (self.split(q).0, self.system());
        let speed = |(event, time, x): &(_, T, &[T])| -rate(system, *event, *time, x, p).real();
        let durations = self.durations(self.split(q).1).iter();
        let within = durations.map(|duration| duration.real()).sum();
        let slowest = self.events_of(ends, q).min_by(|a, b| speed(a).total_cmp(&speed(b)));
        let turn = slowest.and_then(|(event, time, x)| {
            let (time, x) = virtual_point(system, event, (time, x), p, within)?;
            let (guard, mode) = event;
            Some(-system.guard(guard, mode, time, &x, p))
        });
        turn.unwrap_or_else(T::zero)
    }
}

impl<T> EndFunctions<T> for HybridOrbit
where
    T: EventNumber + MeasureNumber,
    Dual<T>: FieldNumber + GuardNumber,
    Dual<Dual<T>>: GuardNumber,
{
    fn of_ends_in(&self, function: usize, ends: Ends<T>, q: &[T]) -> T {
        let (p, extras) = self.split(q);
        let least = |a: T, b: T| if b.real() < a.real() { b } else { a };
        let infinite = T::from(f64::INFINITY);
        match function {
            APPROACH => {
                let events = self.events_of(ends, q);
                let approach = |(event, time, x)| -rate(self.system(), event, time, x, p);
                events.map(approach).fold(infinite, least)
            }
            PENETRATION => self.penetration(ends, q),
            SHORTEST => self.durations(extras).iter().copied().fold(infinite, least),
            own => {
                let passage = |(s, leg): (usize, &super::Leg)| {
                    let (start, end) = (&ends.start[self.of_leg(s)], &ends.end[self.of_leg(s)]);
                    Passage { mode: leg.mode, exit: leg.exit, start, end }
                };
                let legs: Vec<Passage<T>> = self.legs().iter().enumerate().map(passage).collect();
                let periods = self.itinerary().periods;
                self.system().measure(own - OWN, &legs, periods, p)
            }
        }
    }
}
