//! The boundary-value problem of hybrid orbits.

use super::accumulation::Still;
use super::hybrid::HybridOrbit;
use super::itinerary::{Itinerary, Leg};
use super::known::KnownOrbit;
use super::measures::{APPROACH, DECISION, SHORTEST};
use super::returning::mean_rate;
use crate::core::bvp::{
    Birth, Ends, Equations, IntoEquations, Legs, Monitor, Residual, Return, Trajectory, Unknown,
    Watched, Watches,
};
use crate::core::condition::Failure;
use crate::core::failure::OutOfDomain;
use crate::core::hybrid::{
    ChatterNumber, GuardNumber, GuardOf, MeasureNumber, Moment, ScalarOf, time_scale,
};
use crate::core::measure::Measure;
use crate::core::scalar_field::{Domains, FieldIn, FieldRef, Fields};
use crate::core::watch::Observable;
use num_dual::Dual;
use std::sync::Arc;

/// What follows an event that is approached faster, in units of the scales, is beyond doubt.
const SURE: f64 = 1e-4;

/// Names of the monitors that are positive on admissible orbits.
pub(crate) const GRAZINGS: [&str; 4] = ["approach", "shortest", "decision", "distance"];

impl IntoEquations for HybridOrbit {
    fn into_equations(self) -> Arc<dyn Equations> {
        Arc::new(self)
    }
}

impl Domains for HybridOrbit {
    fn domain_of(&self, segment: usize, x: &[f64], q: &[f64]) -> Result<(), OutOfDomain> {
        self.system.domain_of(self.legs()[segment].mode, x, self.split(q).0)
    }

    fn states_of(&self, segment: usize) -> Vec<String> {
        self.modes[self.legs()[segment].mode].states.clone()
    }

    fn scales_of(&self, segment: usize, q: &[f64]) -> Vec<f64> {
        self.system.scales_of(self.legs()[segment].mode, self.split(q).0)
    }
}

impl<T: ChatterNumber> Fields<T> for HybridOrbit
where
    Dual<T>: GuardNumber,
{
    fn field_of(&self, segment: usize, t: T, x: &[T], q: &[T], f: &mut [T]) {
        self.on_segment(segment, q).slope(t, x, q, f);
    }
}

impl<T: ChatterNumber> Residual<T> for HybridOrbit
where
    Dual<T>: GuardNumber,
{
    /// The field of the leg's mode, whose time begins with the leg. Nothing moves while infinitely
    /// many events come.
    fn on_segment<'a>(&'a self, segment: usize, q: &'a [T]) -> FieldRef<'a, T> {
        let (leg, numbers) = (self.legs()[segment], self.parameters.len());
        match leg.accumulates {
            true => FieldRef::of(&Still),
            false => FieldRef { numbers, ..T::in_mode(&*self.system, leg.mode, self.begin(q)) },
        }
    }

    fn duration_in(&self, _segment: usize, q: &[T]) -> T {
        match (self.smooth(), self.forced) {
            (true, true) => self.cycle(self.split(q).0),
            _ => q[q.len() - 1],
        }
    }

    /// An orbit without events closes; legs have [`Legs`].
    fn boundary_in(&self, ends: Ends<T>, _q: &[T], b: &mut [T]) {
        let ends = ends.start.iter().zip(ends.end);
        b.iter_mut().zip(ends).for_each(|(b, (start, end))| *b = *start - *end);
    }

    /// A leg ends where its guard vanishes, or lasts until the events of its guard accumulate.
    fn leg_end_in(&self, segment: usize, times: (T, T), x: &[T], p: &[T], after: &mut [T]) -> T {
        let (legs, t) = (self.legs(), times.0 + times.1);
        let Leg { mode, exit: Some(exit), accumulates } = legs[segment] else { return T::zero() };
        let next = legs[(segment + 1) % legs.len()].mode;
        if !accumulates {
            self.system.reset(exit, (mode, next), t, x, p, after);
            let end = Moment { system: self.system(), mode, t, x, p };
            return match self.returning[segment] {
                true => mean_rate(end, exit, times.1),
                false => end.guard(exit),
            };
        }
        let Some(last) = self.accumulation(segment, times, x, p) else {
            after.fill(T::from(f64::NAN));
            return T::from(f64::NAN);
        };
        self.system.reset(exit, (last.mode, next), last.time, &last.before, p, after);
        t - last.time
    }

    fn cycle_in(&self, p: &[T]) -> T {
        self.cycle(p)
    }

    fn integrand_in(&self, _segment: usize, _t: T, _x: &[T], _q: &[T], _g: &mut [T]) {}
}

impl<T: GuardNumber + MeasureNumber> Watches<T> for HybridOrbit {
    fn watch_in(&self, Watched { segment, observable }: Watched, t: T, x: &[T], q: &[T]) -> T {
        match observable {
            Observable::State(i) => x[i],
            Observable::Function(function) => self.function_on(segment, function, t, x, q),
        }
    }
}

impl Equations for HybridOrbit {
    fn segments(&self) -> Vec<Vec<String>> {
        self.legs().iter().map(|leg| self.modes[leg.mode].states.clone()).collect()
    }

    fn parameters(&self) -> Vec<String> {
        self.parameters.clone()
    }

    fn extras(&self) -> Vec<String> {
        match (self.smooth(), self.forced) {
            (true, true) => Vec::new(),
            (true, false) => vec!["period".into()],
            (false, forced) => {
                let start = forced.then(|| "start".to_string());
                let durations = (0..self.legs().len()).map(|s| format!("duration[{s}]"));
                start.into_iter().chain(durations).collect()
            }
        }
    }

    fn integrals(&self) -> usize {
        0
    }

    fn moves(&self) -> bool {
        true
    }

    fn legs(&self) -> Option<Legs> {
        (!self.smooth()).then_some(Legs { forced: self.forced })
    }

    fn phase(&self) -> bool {
        self.smooth() && !self.forced
    }

    /// The first leg's states return, and under forcing the time of the start, modulo the forcing's
    /// periods.
    fn returns(&self) -> Vec<Return> {
        let mut returns = Return::of_states(self.places[1]);
        if self.forced && !self.smooth() {
            let condition = self.places[self.legs().len()] + self.legs().len();
            returns.push(Return { condition, unknown: Unknown::Extra(0) });
        }
        returns
    }

    fn grazings(&self) -> Vec<usize> {
        let names = self.monitors().into_iter().map(|(name, _)| name).enumerate();
        names.filter(|(_, name)| GRAZINGS.contains(&name.as_str())).map(|(k, _)| k).collect()
    }

    /// That of the guards where states have half their scales, of their rates, or of time.
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

    fn watch_scale(&self, Watched { segment, observable }: Watched, q: &[f64]) -> f64 {
        let (mode, p, guards) = (self.legs()[segment].mode, self.split(q).0, self.guards.len());
        let system = &*self.system;
        match observable {
            Observable::State(i) => system.scales_of(mode, p).get(i).copied().unwrap_or(1.0),
            Observable::Function(k) if k < guards => GuardOf::typical(system, k, mode, p).scale,
            Observable::Function(k) => {
                ScalarOf::new(system, Observable::Function(k - guards), mode, p).scale
            }
        }
    }

    fn longest_step(&self, segment: usize) -> f64 {
        let guards = self.guards_in(self.legs()[segment].mode);
        let times = guards.filter_map(|guard| self.guards[guard].changes_in);
        times.filter(|time| *time > 0.0).fold(f64::INFINITY, f64::min)
    }

    fn extra_scale(&self, p: &[f64]) -> f64 {
        time_scale(&*self.system, p)
    }

    /// Guards are the functions that are watched.
    fn monitors(&self) -> Vec<(String, Monitor)> {
        let measures = self.system().measures();
        let known = measures.iter().map(|(name, measure)| (name.clone(), self.monitor(measure)));
        let [approach, shortest, decision, distance] = GRAZINGS.map(String::from);
        let mut monitors = vec![("period".to_string(), Monitor::Duration)];
        monitors.extend(known);
        if !self.smooth() {
            monitors.push((approach, Monitor::Ends(APPROACH)));
            monitors.push((shortest, Monitor::Ends(SHORTEST)));
        }
        if self.decides() {
            monitors.push((decision, Monitor::Ends(DECISION)));
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

    /// Where there is no guard, all orbits have the same itinerary.
    fn itinerary(&self) -> String {
        if self.guards.is_empty() { String::new() } else { self.itinerary.written(&*self.system) }
    }

    fn with_itinerary(&self, words: &str) -> Result<Arc<dyn Equations>, Failure> {
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

    fn born_at_grazing(
        &self,
        known: &[Trajectory],
        q: &[f64],
        which: usize,
    ) -> Result<Option<Birth>, Failure> {
        if self.guards.is_empty() {
            return Ok(None);
        }
        let orbit = self.known(known, q);
        let mut birth = orbit.without()?;
        if birth.is_none() {
            birth = orbit.decided_otherwise()?;
        }
        match (birth, which) {
            (None, _) => Ok(Some(orbit.born(which)?.erased())),
            (Some(birth), 0) => Ok(Some(birth.erased())),
            (Some(_), _) => Err(Failure::no_branch(which, 1)),
        }
    }

    fn kind_of_grazing(
        &self,
        monitor: usize,
        known: &[Trajectory],
        q: &[f64],
    ) -> Option<&'static str> {
        self.known(known, q).name_of_grazing(monitor)
    }

    fn without_touched(&self, known: &[Trajectory], q: &[f64]) -> Result<Option<Birth>, Failure> {
        Ok(self.known(known, q).without()?.map(Birth::erased))
    }

    fn with_touched(&self, known: &[Trajectory], q: &[f64]) -> Result<Option<Birth>, Failure> {
        match self.guards.is_empty() {
            true => Ok(None),
            false => Ok(Some(self.known(known, q).with_touches()?.erased())),
        }
    }

    fn touch_matters(&self, known: &[Trajectory], q: &[f64]) -> Result<bool, Failure> {
        let orbit = self.known(known, q);
        Ok(!self.guards.is_empty()
            && orbit.decided_otherwise()?.is_none()
            && orbit.born(0)?.beside.is_none())
    }

    fn is_of_event(&self, monitor: usize) -> bool {
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

    /// At an event that is tangent, or virtual, nothing can be told.
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
