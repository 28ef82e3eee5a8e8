//! The boundary-value problem of hybrid orbits.

use super::accumulation::Still;
use super::emanating::GRAZINGS;
use super::hybrid::HybridOrbit;
use super::itinerary::Leg;
use super::measures::{APPROACH, DECISION, SHORTEST};
use super::same_surface_legs::mean_rate;
use crate::core::bvp::{
    Ends, Equations, IntoEquations, Itineraries, Legs, Monitor, Residual, Shape, Watched, Watches,
};
use crate::core::hybrid::{
    ChatterNumber, GuardNumber, GuardOf, MeasureNumber, Moment, ScalarOf, time_scale,
};
use crate::core::measure::Measure;
use crate::core::scalar_field::FieldRef;
use crate::core::watch::Observable;
use num_dual::Dual;
use std::sync::Arc;

impl IntoEquations for HybridOrbit {
    fn into_equations(self) -> Arc<dyn Equations> {
        Arc::new(self)
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

    /// A leg ends where its guard vanishes, or lasts until the events of its guard accumulate.
    fn leg_end_in(&self, segment: usize, times: (T, T), x: &[T], p: &[T], after: &mut [T]) -> T {
        let (legs, t) = (self.legs(), times.0 + times.1);
        let Leg { mode, exit: Some(exit), accumulates } = legs[segment] else { return T::zero() };
        let next = legs[(segment + 1) % legs.len()].mode;
        if !accumulates {
            self.system.reset(exit, (mode, next), t, x, p, after);
            let end = Moment { system: self.system(), mode, t, x, p };
            return match self.returning.get().is_some_and(|all| all[segment]) {
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

    fn shape(&self) -> Shape {
        match self.smooth() {
            true => Shape::Periodic { phase: !self.forced },
            false => Shape::Cycle(Legs { forced: self.forced }),
        }
    }

    fn refer(&self, ends: Ends<f64>, q: &[f64]) -> bool {
        if self.returning.get().is_none()
            && let Some(found) = self.begins_on_exit(ends, q)
        {
            // Another thread may have been first, with the same orbit.
            let _ = self.returning.set(found);
        }
        self.returning.get().is_some()
    }

    fn scales(&self, segment: usize, q: &[f64]) -> Vec<f64> {
        self.system.scales_of(self.legs()[segment].mode, self.split(q).0)
    }

    fn function_scale(&self, segment: usize, function: usize, q: &[f64]) -> f64 {
        let (mode, p, system) = (self.legs()[segment].mode, self.split(q).0, &*self.system);
        match function.checked_sub(self.guards.len()) {
            None => GuardOf::typical(system, function, mode, p).scale,
            Some(k) => ScalarOf::new(system, Observable::Function(k), mode, p).scale,
        }
    }

    fn extra_scale(&self, p: &[f64]) -> f64 {
        time_scale(&*self.system, p)
    }

    fn longest_step(&self, segment: usize) -> f64 {
        let guards = self.guards_in(self.legs()[segment].mode);
        let times = guards.filter_map(|guard| self.guards[guard].changes_in);
        times.filter(|time| *time > 0.0).fold(f64::INFINITY, f64::min)
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
    fn itineraries(&self) -> Option<&dyn Itineraries> {
        if self.guards.is_empty() { None } else { Some(self) }
    }
}
