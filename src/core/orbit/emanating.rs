//! The itineraries of hybrid orbits, the grazings at which an itinerary changes, and the branches
//! that emanate there.

use super::hybrid::HybridOrbit;
use super::itinerary::{Itinerary, Leg};
use super::known::KnownOrbit;
use super::measures::{APPROACH, DECISION, SHORTEST};
use crate::core::bvp::{Ends, Equations, Guess, Itineraries, Monitor, Residual, Trajectory};
use crate::core::failure::Failure;
use crate::core::hybrid::{GuardOf, Moment, time_scale};
use std::sync::Arc;

/// H: the mode that follows an event is certain if the guard is approached faster than this, in
/// units of the scales.
const SURE: f64 = 1e-4;

/// Names of the monitors that are positive on admissible orbits.
pub(crate) const GRAZINGS: [&str; 4] = ["approach", "shortest", "decision", "distance"];

impl Itineraries for HybridOrbit {
    fn words(&self) -> String {
        self.itinerary.written(&*self.system)
    }

    fn with_words(&self, words: &str) -> Result<Arc<dyn Equations>, Failure> {
        let itinerary = Itinerary::read(words, &*self.system)
            .map_err(|cause| Failure::Mismatch(cause.to_string()))?;
        Ok(Arc::new(self.like(itinerary)))
    }

    fn doubled(&self) -> Option<Arc<dyn Equations>> {
        let doubled = || Arc::new(self.like(self.itinerary.repeated(2)));
        (!self.smooth()).then(|| doubled() as Arc<dyn Equations>)
    }

    /// Orbits without events over several periods, as those of doubled ones.
    fn spanning(&self, durations: f64, q: &[f64]) -> Option<(Arc<dyn Equations>, Vec<f64>)> {
        let (mut q, mut itinerary) = (q.to_vec(), self.itinerary.clone());
        match self.forced {
            _ if !self.smooth() || durations.fract() != 0.0 => return None,
            true => itinerary.periods *= durations as usize,
            false => q[self.parameters.len()..].iter_mut().for_each(|period| *period *= durations),
        }
        Some((Arc::new(self.like(itinerary)), q))
    }

    /// Under forcing an orbit may begin any number of periods later.
    fn rotated(&self, segments: usize, q: &[f64], near: &[f64]) -> Option<Vec<f64>> {
        let ((p, extras), legs) = (self.split(q), self.legs());
        let same = |(s, leg): (usize, &Leg)| *leg == legs[(s + segments) % legs.len()];
        if self.smooth() || !legs.iter().enumerate().all(same) {
            return None;
        }
        let mut durations = self.durations(extras).to_vec();
        let start = self.forced.then(|| {
            let (period, start) = (self.system.period(p), self.time(segments, q));
            start - period * ((start - near[0]) / period).round()
        });
        durations.rotate_left(segments);
        Some(start.into_iter().chain(durations).collect())
    }

    fn grazings(&self) -> Vec<usize> {
        let names = self.monitors().into_iter().map(|(name, _)| name).enumerate();
        names.filter(|(_, name)| GRAZINGS.contains(&name.as_str())).map(|(k, _)| k).collect()
    }

    /// The scale of the guards, of their rates or of time. Guards are evaluated where states have
    /// half their scales.
    fn grazing_scale(&self, monitor: usize, p: &[f64]) -> f64 {
        let (system, time) = (self.system(), time_scale(self.system(), p));
        let scale = |mode: usize| {
            self.guards_in(mode).map(move |guard| GuardOf::typical(system, guard, mode, p).scale)
        };
        let modes = self.legs().iter().map(|leg| leg.mode);
        let least = || modes.flat_map(scale).reduce(f64::min).unwrap_or(1.0);
        match self.monitors().swap_remove(monitor).1 {
            Monitor::Ends(SHORTEST) => time,
            Monitor::Ends(DECISION) => self.scale_of_decisions(p),
            Monitor::Ends(APPROACH) => least() / time,
            _ => least(),
        }
    }

    fn passes(&self, monitor: usize) -> bool {
        let ends = Monitor::Ends(APPROACH);
        [ends, Monitor::Ends(SHORTEST)].contains(&self.monitors().swap_remove(monitor).1)
    }

    /// Every event, and every accumulation, must lead to the mode that the itinerary says; legs
    /// must be able to begin and end where they do.
    fn check_ends(&self, ends: Ends<f64>, q: &[f64]) -> Result<(), Failure> {
        let ((p, extras), legs) = (self.split(q), self.legs());
        for (s, leg) in legs.iter().enumerate().filter(|(_, leg)| !leg.accumulates) {
            let begins = self.time(s, q);
            let ended = begins + Residual::<f64>::duration_in(self, s, &self.numbers_of(s, q));
            for (t, states) in [(begins, ends.start), (ended, ends.end)] {
                self.system.domain_at_ends(leg.mode, t, &states[self.of_leg(s)], p)?;
            }
        }
        let mut time = self.time(0, q);
        for (s, leg) in legs.iter().enumerate().filter(|(_, leg)| leg.exit.is_some()) {
            let (duration, x) = (self.durations(extras)[s], &ends.end[self.of_leg(s)]);
            let times = (time, duration);
            time += duration;
            match leg.accumulates {
                true => self.check_accumulation(s, times, x, p)?,
                false => {
                    let at = Moment { system: self.system(), mode: leg.mode, t: time, x, p };
                    self.check_event(s, at)?;
                }
            }
        }
        Ok(())
    }

    fn name_of_grazing(
        &self,
        monitor: usize,
        known: &[Trajectory],
        q: &[f64],
    ) -> Option<&'static str> {
        self.known(known, q).name_of_grazing(monitor)
    }

    fn emanating(&self, known: &[Trajectory], q: &[f64], which: usize) -> Result<Guess, Failure> {
        let orbit = self.known(known, q);
        let mut other = orbit.without()?;
        if other.is_none() {
            other = orbit.decided_otherwise()?;
        }
        match (other, which) {
            (None, _) => Ok(orbit.born(which)?.erased()),
            (Some(other), 0) => Ok(other.erased()),
            (Some(_), _) => Err(Failure::no_branch(which, 1)),
        }
    }

    fn across(
        &self,
        known: &[Trajectory],
        q: &[f64],
        passes: bool,
        wanted: bool,
    ) -> Result<Option<Guess>, Failure> {
        let orbit = self.known(known, q);
        if passes {
            return Ok(orbit.without()?.map(Guess::erased));
        }
        // An event that changes nothing at the touch leaves the linearisation as it is.
        let matters =
            wanted || orbit.decided_otherwise()?.is_none() && orbit.born(0)?.beside.is_none();
        Ok(match matters {
            true => Some(orbit.with_touches()?.erased()),
            false => None,
        })
    }
}

impl HybridOrbit {
    /// An orbit of these with its motion.
    pub(in crate::core) fn known<'a>(
        &'a self,
        known: &'a [Trajectory],
        q: &'a [f64],
    ) -> KnownOrbit<'a> {
        KnownOrbit { problem: self, known, q }
    }

    /// Checks the mode that follows an event. An event that is tangent or virtual is not checked.
    fn check_event(&self, leg: usize, at: Moment<f64>) -> Result<(), Failure> {
        let Moment { system, mode, t, x, p } = at;
        let Some(guard) = self.legs()[leg].exit else { return Ok(()) };
        let (approach, meant) = (-at.rate(guard), self.mode_after(leg));
        let next = system.next_mode(guard, mode, t, x, p);
        let sure = approach > SURE * at.usual_rate(guard);
        if next == meant || !sure {
            return Ok(());
        }
        let (event, mode) = (&self.guards[guard].name, &self.modes[mode].name);
        let [next, meant] = [next, meant].map(|mode| &self.modes[mode].name);
        Err(Failure::Mismatch(format!(
            "the event `{event}` of mode `{mode}`, leg {leg}, at t = {t:.6e} leads to `{next}`, not to `{meant}` as the \
             itinerary says: write an itinerary that closes, or let a simulation find it"
        )))
    }
}
