//! Changes of the itinerary of hybrid orbits: the grazings at which the itinerary changes, and the
//! branches that emanate there. The orbits on these branches lack the vanished legs, continue in
//! another mode after a decision, or have an additional event at a grazing point.

use super::accumulation::{accumulation, check_rebound};
use super::decision_switching::{decided_otherwise, decisions};
use super::grazing_names::name_of_grazing;
use super::itinerary::{Itinerary, Leg};
use super::known_orbit::KnownOrbit;
use super::legs::OrbitLegs;
use super::measures::{APPROACH, DECISION, GRAZINGS, SHORTEST, SPACING, monitors_of};
use super::repeated::traversed_once;
use super::reset_jumps::{check_resets, jump_between};
use super::timed_events::check_timed;
use super::touch_switching::{emanating_at_touch, with_touches};
use super::vanished_legs::without;
use crate::core::bvp::{
    Ends, ErasedProblem, Guess, IntoEquations, Itineraries, Monitor, Trajectory,
};
use crate::core::failure::{Failure, one_line};
use crate::core::hybrid::{GuardOf, Moment, time_scale};
use crate::core::system::{Jump, Limit};

/// Heuristic: the mode after an event is checked only if the approach speed of the event, in units
/// of the scales, is larger than this value.
const SURE: f64 = 1e-4;

/// The present itinerary of hybrid orbits: the legs (parts between two events), and the monitors of
/// the orbits.
#[derive(Clone)]
pub(in crate::core) struct OrbitItineraries {
    pub legs: OrbitLegs,
    /// The monitors. The watched functions are the guards, followed by the system's monitors.
    pub monitors: Vec<(String, Monitor)>,
}

impl From<OrbitLegs> for OrbitItineraries {
    fn from(legs: OrbitLegs) -> Self {
        OrbitItineraries { monitors: monitors_of(&legs), legs }
    }
}

impl OrbitItineraries {
    /// Returns an orbit with the present legs and the given trajectories.
    pub(in crate::core) fn known<'a>(
        &'a self,
        known: &'a [Trajectory],
        q: &'a [f64],
    ) -> KnownOrbit<'a> {
        KnownOrbit { legs: &self.legs, known, q }
    }
}

impl Itineraries<ErasedProblem> for OrbitItineraries {
    fn words(&self) -> String {
        self.legs.itinerary.written(self.legs.system())
    }

    fn with_words(&self, words: &str) -> Result<ErasedProblem, Failure> {
        let itinerary = Itinerary::read(words, self.legs.system())
            .map_err(|cause| Failure::Mismatch(one_line(&cause)))?;
        Ok(self.legs.like(itinerary).into_equations())
    }

    fn doubled(&self) -> Option<ErasedProblem> {
        let doubled = || self.legs.like(self.legs.itinerary.repeated(2)).into_equations();
        (!self.legs.layout.smooth).then(doubled)
    }

    fn halved(&self) -> Option<ErasedProblem> {
        Some(self.legs.like(self.legs.itinerary.halved(self.legs.layout.forced)?).into_equations())
    }

    /// Returns the problem of orbits without events over several periods, such as period-doubled
    /// orbits.
    fn spanning(&self, durations: f64, q: &[f64]) -> Option<(ErasedProblem, Vec<f64>)> {
        let (mut q, mut itinerary) = (q.to_vec(), self.legs.itinerary.clone());
        match self.legs.layout.forced {
            _ if !self.legs.layout.smooth || durations.fract() != 0.0 => return None,
            true => itinerary.periods *= durations as usize,
            false => {
                q[self.legs.parameters.len()..].iter_mut().for_each(|period| *period *= durations)
            }
        }
        Some((self.legs.like(itinerary).into_equations(), q))
    }

    /// Returns the extra unknowns (the durations and the start time) of the same orbit if it starts
    /// a given number of legs later; in a forced system, the start time is shifted by a multiple of
    /// the forcing period.
    fn rotated(&self, segments: usize, q: &[f64], near: &[f64]) -> Option<Vec<f64>> {
        let legs = self.legs.all();
        let same = |(s, leg): (usize, &Leg)| *leg == legs[(s + segments) % legs.len()];
        if self.legs.layout.smooth || !legs.iter().enumerate().all(same) {
            return None;
        }
        let mut durations = self.legs.layout.durations(q).to_vec();
        let start = self.legs.layout.forced.then(|| {
            let period = self.legs.system.period(self.legs.layout.p(q));
            let start = self.legs.layout.time(segments, q);
            start - period * ((start - near[0]) / period).round()
        });
        durations.rotate_left(segments);
        Some(start.into_iter().chain(durations).collect())
    }

    /// Returns the monitors that vanish where the itinerary changes, each with its scale. Depending
    /// on the monitor, this is the scale of a guard, of a guard's rate, of a decision function, or
    /// of time. The scales of guards are evaluated at half the scales of the states.
    fn limits(&self, p: &[f64]) -> Vec<Limit> {
        let (system, time) = (self.legs.system(), time_scale(self.legs.system(), p));
        let of_guards = |mode: usize| {
            self.legs
                .vanishing_in(mode)
                .map(move |guard| GuardOf::typical(system, guard, mode, p).scale)
        };
        let least = |scales: &mut dyn Iterator<Item = f64>| scales.reduce(f64::min).unwrap_or(1.0);
        let guards = least(&mut self.legs.all().iter().flat_map(|leg| of_guards(leg.mode)));
        let of_decisions = || decisions(&self.legs).map(|decision| decision.least_scale(system, p));
        let limit = |(monitor, (_, of)): (usize, &(String, Monitor))| {
            let (scale, passes) = match of {
                Monitor::Ends(SHORTEST | SPACING) => (time, true),
                Monitor::Ends(APPROACH) => (guards / time, true),
                Monitor::Ends(DECISION) => (least(&mut of_decisions()), false),
                _ => (guards, false),
            };
            Limit { monitor, scale, passes }
        };
        let monitors = self.monitors.iter().enumerate();
        let limits = monitors.filter(|(_, (name, _))| GRAZINGS.contains(&name.as_str()));
        limits.map(limit).collect()
    }

    /// Checks that every event and every accumulation leads to the next mode of the itinerary, and
    /// that each leg begins and ends within the domain of its mode.
    fn check_ends(&self, ends: Ends<f64>, q: &[f64]) -> Result<(), Failure> {
        let (layout, p) = (&self.legs.layout, self.legs.layout.p(q));
        let times = |s: usize| (layout.time(s, q), self.legs.duration(&layout.numbers(s, q)));
        for (s, leg) in self.legs.all().iter().enumerate().filter(|(_, leg)| !leg.accumulates) {
            let (begins, duration) = times(s);
            for (t, states) in [(begins, ends.start), (begins + duration, ends.end)] {
                self.legs.system.domain_at_ends(leg.mode, t, &states[layout.states(s)], p)?;
            }
        }
        check_timed(&self.legs, ends, q)?;
        let whole = layout.durations(q).iter().sum::<f64>();
        for (s, leg) in self.legs.all().iter().enumerate() {
            let (times, x) = (times(s), &ends.end[layout.states(s)]);
            match leg.accumulates {
                true => check_accumulation(&self.legs, s, (times, whole), x, p)?,
                false => check_event(&self.legs, s, times.0 + times.1, x, p)?,
            }
        }
        Ok(())
    }

    fn jump_between(&self, orbits: [(Ends<f64>, &[f64]); 2]) -> Option<Jump> {
        jump_between(&self.legs, orbits)
    }

    fn name_of_limit(
        &self,
        monitor: usize,
        known: &[Trajectory],
        q: &[f64],
    ) -> Option<&'static str> {
        name_of_grazing(&self.known(known, q), &self.monitors[monitor].1)
    }

    fn emanating(
        &self,
        known: &[Trajectory],
        q: &[f64],
        which: usize,
    ) -> Result<Guess<ErasedProblem>, Failure> {
        let orbit = &self.known(known, q);
        check_resets(orbit)?;
        let mut other = without(orbit)?;
        if other.is_none() {
            other = decided_otherwise(orbit)?;
        }
        match (other, which) {
            (None, _) => Ok(emanating_at_touch(orbit, which)?.erased()),
            (Some(other), 0) => Ok(traversed_once(other, orbit.p())?.erased()),
            (Some(_), _) => Err(Failure::no_branch(which, 1)),
        }
    }

    fn across(
        &self,
        known: &[Trajectory],
        q: &[f64],
        passes: bool,
        wanted: bool,
    ) -> Result<Option<Guess<ErasedProblem>>, Failure> {
        let orbit = &self.known(known, q);
        if passes {
            return Ok(without(orbit)?.map(Guess::erased));
        }
        // An event that changes nothing at the grazing point does not change the linearisation.
        let matters = wanted
            || decided_otherwise(orbit)?.is_none()
                && emanating_at_touch(orbit, 0)?.beside.is_none();
        Ok(match matters {
            true => Some(with_touches(orbit)?.erased()),
            false => None,
        })
    }
}

/// Checks that an event leads to the next mode of the itinerary. Tangential events, and virtual
/// events with a negative approach speed, are not checked.
fn check_event(legs: &OrbitLegs, leg: usize, t: f64, x: &[f64], p: &[f64]) -> Result<(), Failure> {
    let Leg { mode, exit: Some(guard), .. } = legs.all()[leg] else { return Ok(()) };
    let at = Moment { system: legs.system(), mode, t, x, p };
    let (approach, meant) = (-at.rate(guard), legs.mode_after(leg));
    let next = at.system.next_mode(guard, mode, t, x, p);
    let sure = approach > SURE * at.usual_rate(guard);
    if next == meant || !sure {
        return Ok(());
    }
    let (event, mode) = (&legs.guards[guard].name, &legs.modes[mode].name);
    let [next, meant] = [next, meant].map(|mode| &legs.modes[mode].name);
    Err(Failure::Mismatch(format!(
        "the event `{event}` of mode `{mode}`, leg {leg}, at t = {t:.6e} leads to `{next}`, not to `{meant}` as in \
         the itinerary: correct the itinerary, or let a simulation find it"
    )))
}

/// Returns an error if the events of a leg do not accumulate, accumulate immediately, or lead to a
/// mode that differs from the itinerary.
fn check_accumulation(
    legs: &OrbitLegs,
    leg: usize,
    (times, whole): ((f64, f64), f64),
    x: &[f64],
    p: &[f64],
) -> Result<(), Failure> {
    check_rebound(legs, leg, times.1, whole)?;
    let meant = legs.mode_after(leg);
    let found = accumulation(legs.system(), legs.all()[leg], times, x, p);
    if found.as_ref().is_some_and(|event| event.next == meant) {
        return Ok(());
    }
    let event = legs.all()[leg].exit.map_or("", |guard| &legs.guards[guard].name);
    let to = |mode: usize| format!("lead to `{}`", legs.modes[mode].name);
    let led = found.map_or_else(|| "do not accumulate".into(), |event| to(event.next));
    Err(Failure::Mismatch(format!(
        "the events `{event}` after t = {:.6e}, leg {leg}, {led}, but in the itinerary they accumulate within \
         {:.1e} and {}: let a simulation find the itinerary",
        times.0,
        times.1,
        to(meant)
    )))
}
