//! The boundary-value problem of hybrid orbits.

use super::hybrid::HybridOrbit;
use super::itinerary::Itinerary;
use crate::core::bvp::{
    Birth, Ends, Equations, IntoEquations, Monitor, Residual, Return, Unknown, Watched, Watches,
};
use crate::core::condition::EvaluationError;
use crate::core::hybrid::{EventNumber, FieldNumber, GuardNumber, MeasureNumber};
use crate::core::scalar_field::{Domains, FieldIn, FieldRef, Fields};
use crate::core::watch::Observable;
use crate::core::zero::LeftDomain;
use std::sync::Arc;

impl IntoEquations for HybridOrbit {
    fn into_equations(self) -> Arc<dyn Equations> {
        Arc::new(self)
    }
}

impl Domains for HybridOrbit {
    fn domain_of(&self, segment: usize, x: &[f64], q: &[f64]) -> Result<(), LeftDomain> {
        self.system.domain_of(self.legs()[segment].mode, x, self.split(q).0)
    }

    fn states_of(&self, segment: usize) -> Vec<String> {
        self.modes[self.legs()[segment].mode].states.clone()
    }

    fn scales_of(&self, segment: usize, q: &[f64]) -> Vec<f64> {
        self.system.scales_of(self.legs()[segment].mode, self.split(q).0)
    }
}

impl<T: EventNumber> Fields<T> for HybridOrbit {
    fn field_of(&self, segment: usize, t: T, x: &[T], q: &[T], f: &mut [T]) {
        self.on_segment(segment, q).slope(t, x, q, f);
    }
}

impl<T: EventNumber> Residual<T> for HybridOrbit {
    /// The field of the leg's mode, whose time begins with the leg.
    fn on_segment<'a>(&'a self, segment: usize, q: &'a [T]) -> FieldRef<'a, T> {
        let (mode, numbers) = (self.legs()[segment].mode, self.parameters.len());
        FieldRef { numbers, ..T::in_mode(&*self.system, mode, self.time(segment, q)) }
    }

    fn duration_in(&self, segment: usize, q: &[T]) -> T {
        let (p, extras) = self.split(q);
        match (self.smooth(), self.forced) {
            (true, true) => self.cycle(p),
            _ => self.durations(extras)[segment],
        }
    }

    fn boundary_in(&self, ends: Ends<T>, q: &[T], b: &mut [T]) {
        match self.smooth() {
            true => {
                let ends = ends.start.iter().zip(ends.end);
                b.iter_mut().zip(ends).for_each(|(b, (start, end))| *b = *start - *end);
            }
            false => self.events(ends, q, b),
        }
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

    fn phase(&self) -> bool {
        self.smooth() && !self.forced
    }

    /// The first leg's states return, and under forcing the time of the start, modulo the forcing's periods.
    fn returns(&self) -> Vec<Return> {
        let mut returns = Return::of_states(self.places[1]);
        if self.forced && !self.smooth() {
            let condition = self.places[self.legs().len()] + self.legs().len();
            returns.push(Return { condition, unknown: Unknown::Extra(0) });
        }
        returns
    }

    fn grazings(&self) -> Vec<usize> {
        self.grazing_monitors()
    }

    fn grazing_scale(&self, monitor: usize, p: &[f64]) -> f64 {
        self.scale_of_grazing(monitor, p)
    }

    fn monitors(&self) -> Vec<(String, Monitor)> {
        self.all_monitors()
    }

    /// Where there is no guard, all orbits have the same itinerary.
    fn itinerary(&self) -> String {
        match self.guards.is_empty() {
            true => String::new(),
            false => self.itinerary.in_words(&self.modes, &self.guards),
        }
    }

    fn with_itinerary(&self, words: &str) -> Result<Arc<dyn Equations>, EvaluationError> {
        let itinerary = Itinerary::read(words, &*self.system)
            .map_err(|cause| EvaluationError::NotApplicable(cause.to_string()))?;
        Ok(Arc::new(self.like(itinerary)))
    }

    fn doubled(&self) -> Option<Arc<dyn Equations>> {
        let doubled = || Arc::new(self.like(self.itinerary.repeated(2)));
        (!self.smooth()).then(|| doubled() as Arc<dyn Equations>)
    }

    fn born_at_grazing(&self, starts: &[f64], q: &[f64]) -> Result<Option<Birth>, EvaluationError> {
        match self.guards.is_empty() {
            true => Ok(None),
            false => Ok(Some(self.born(starts, q)?.erased())),
        }
    }

    fn check_ends(&self, ends: Ends<f64>, q: &[f64]) -> Result<(), LeftDomain> {
        self.check_events(ends, q)
    }
}
