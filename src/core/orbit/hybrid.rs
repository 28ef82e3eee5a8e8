//! Hybrid orbits as boundary-value problems.

use super::accumulation::accumulation;
use super::itinerary::{Itinerary, ItineraryError, Leg};
use super::legs::OrbitLegs;
use super::same_surface_legs::{begins_on_exit, mean_rate};
use super::switching::OrbitItineraries;
use crate::core::bvp::{
    Ends, Equations, ErasedProblem, IntoEquations, Itineraries, Monitor, Residual, Shape, Watched,
    Watches,
};
use crate::core::hybrid::{
    ChatterNumber, GuardNumber, GuardOf, HybridEquations, HybridSystem, MeasureNumber, Moment,
    ScalarOf, time_scale,
};
use crate::core::problem::{FieldRef, Observable};
use num_dual::Dual;
use std::sync::{Arc, OnceLock};

/// The periodic orbits of a hybrid system with a given itinerary, as a boundary-value problem with
/// one segment for each leg:
///
/// ```text
///     x_s' = f_s(T_s + t, x_s, p),  0 ≤ t ≤ L_s,    T_s = T_0 + L_0 + … + L_{s−1}
///     x_{s+1}(0) = r_s(T_{s+1}, x_s(L_s), p),       the last leg leading to the first
///     h_s(T_{s+1}, x_s(L_s), p) = 0
///     L_0 + … + L_{S−1} = q T(p)                    under forcing of period T
/// ```
///
/// The unknowns are the states, the durations `L_s` and, under forcing, the start time `T_0`. The
/// equations of a hybrid orbit remain regular when an event becomes tangential: a leg (a part of
/// the orbit between two events) may have zero length, and an impact may have zero speed. Since the
/// equations are regular, a branch of impacting orbits can start at the grazing point.
///
/// An orbit without events is a single segment whose end equals its start after `q` forcing
/// periods; without forcing, the period is unknown, and a phase condition is added.
#[derive(Clone)]
pub struct HybridOrbit {
    pub(in crate::core) itineraries: OrbitItineraries,
    /// For each leg (part of the orbit between two events), whether the leg ends on the surface on
    /// which it begins; computed when first needed.
    returning: OnceLock<Vec<bool>>,
}

/// Conversion of a [`HybridSystem`], owned or shared, to the system for an orbit problem.
pub trait IntoHybrid {
    /// Converts the system to a shared trait object.
    fn into_hybrid(self) -> Arc<dyn HybridEquations>;
}

impl<S: HybridSystem + 'static> IntoHybrid for S {
    fn into_hybrid(self) -> Arc<dyn HybridEquations> {
        Arc::new(self)
    }
}

impl IntoHybrid for Arc<dyn HybridEquations> {
    fn into_hybrid(self) -> Arc<dyn HybridEquations> {
        self
    }
}

impl From<OrbitLegs> for HybridOrbit {
    fn from(legs: OrbitLegs) -> Self {
        HybridOrbit { itineraries: legs.into(), returning: OnceLock::new() }
    }
}

impl HybridOrbit {
    /// Creates the orbit problem for a system and an itinerary.
    ///
    /// ```
    /// use tangency::core::orbit::{HybridOrbit, Itinerary, Leg};
    /// use tangency::problems::classic::ImpactOscillator;
    /// assert!(HybridOrbit::of(ImpactOscillator, Itinerary::smooth(0, 1)).is_ok());
    /// assert!(HybridOrbit::of(ImpactOscillator, Itinerary::smooth(7, 1)).is_err());
    /// ```
    ///
    /// # Errors
    /// [`ItineraryError`] if the itinerary has no legs or no periods, or if a mode or guard in it
    /// does not exist.
    pub fn of(system: impl IntoHybrid, itinerary: Itinerary) -> Result<Self, ItineraryError> {
        let system = system.into_hybrid();
        itinerary.check(&system.modes(), &system.guards())?;
        Ok(OrbitLegs::new(system, itinerary, false).into())
    }

    /// Records [`Measure::Penetration`](crate::core::problem::Measure::Penetration) as a monitor.
    /// The penetration is 0 if motion beyond the surface would not turn back within a period.
    pub fn with_penetration(self) -> Self {
        let OrbitLegs { system, itinerary, .. } = self.itineraries.legs;
        OrbitLegs::new(system, itinerary, true).into()
    }

    /// Returns the legs of the orbits, which are the parts between two successive events.
    pub(in crate::core) fn legs(&self) -> &OrbitLegs {
        &self.itineraries.legs
    }

    /// Returns the itinerary of the orbits.
    pub fn itinerary(&self) -> &Itinerary {
        &self.legs().itinerary
    }
}

impl IntoEquations for HybridOrbit {
    fn into_equations(self) -> ErasedProblem {
        Arc::new(self)
    }
}

impl IntoEquations for OrbitLegs {
    fn into_equations(self) -> ErasedProblem {
        HybridOrbit::from(self).into_equations()
    }
}

impl<T: ChatterNumber> Residual<T> for HybridOrbit
where
    Dual<T>: GuardNumber,
{
    fn on_segment<'a>(&'a self, segment: usize, q: &'a [T]) -> FieldRef<'a, T> {
        self.legs().field_on(segment, q)
    }

    fn duration_in(&self, _segment: usize, q: &[T]) -> T {
        self.legs().duration(q)
    }

    /// Computes the equation at the end of a leg: its guard vanishes, or the leg lasts until the
    /// events of its guard accumulate.
    fn segment_end_in(
        &self,
        segment: usize,
        times: (T, T),
        x: &[T],
        p: &[T],
        after: &mut [T],
    ) -> T {
        let (leg, system) = (self.legs().all()[segment], self.legs().system());
        let Leg { mode, exit: Some(exit), accumulates } = leg else { return T::zero() };
        let (t, next) = (times.0 + times.1, self.legs().mode_after(segment));
        if !accumulates {
            system.reset(exit, (mode, next), t, x, p, after);
            let end = Moment { system, mode, t, x, p };
            return match self.returning.get().is_some_and(|all| all[segment]) {
                true => mean_rate(end, exit, times.1),
                false => end.guard(exit),
            };
        }
        let Some(last) = accumulation(system, leg, times, x, p) else {
            after.fill(T::from(f64::NAN));
            return T::from(f64::NAN);
        };
        system.reset(exit, (last.mode, next), last.time, &last.before, p, after);
        t - last.time
    }

    fn cycle_in(&self, p: &[T]) -> T {
        self.legs().cycle(p)
    }
}

impl<T: GuardNumber + MeasureNumber> Watches<T> for HybridOrbit {
    /// Evaluates a watched function, given by its index in the list that contains all guards, and
    /// then all monitors of the system.
    fn watch_in(&self, Watched { segment, observable, .. }: Watched, t: T, x: &[T], q: &[T]) -> T {
        let OrbitLegs { system, layout, guards, .. } = self.legs();
        let (mode, t, p) = (self.legs().mode(segment), layout.begin(q) + t, layout.p(q));
        match observable {
            Observable::Function(k) if k < guards.len() => system.guard(k, mode, t, x, p),
            Observable::Function(k) => system.monitor(k - guards.len(), mode, t, x, p),
            Observable::State(i) => x[i],
        }
    }
}

impl Equations for HybridOrbit {
    fn segments(&self) -> Vec<Vec<String>> {
        self.legs().all().iter().map(|leg| self.legs().modes[leg.mode].states.clone()).collect()
    }

    fn parameters(&self) -> Vec<String> {
        self.legs().parameters.clone()
    }

    fn defaults(&self) -> Vec<f64> {
        self.legs().system.defaults()
    }

    fn extras(&self) -> Vec<String> {
        let layout = &self.legs().layout;
        if layout.smooth {
            return (!layout.forced).then(|| "period".into()).into_iter().collect();
        }
        let start = layout.forced.then(|| "start".to_string());
        let durations = (0..self.legs().all().len()).map(|s| format!("duration[{s}]"));
        start.into_iter().chain(durations).collect()
    }

    fn shape(&self) -> Shape {
        let forced = self.legs().layout.forced;
        match self.legs().layout.smooth {
            true => Shape::Periodic { phase: !forced },
            false => Shape::Cycle { forced },
        }
    }

    fn refer(&self, ends: Ends<f64>, q: &[f64]) -> bool {
        if self.returning.get().is_none()
            && let Some(found) = begins_on_exit(self.legs(), ends, q)
        {
            // Another thread may already have stored the same result.
            let _ = self.returning.set(found);
        }
        self.returning.get().is_some()
    }

    fn scales(&self, segment: usize, q: &[f64]) -> Vec<f64> {
        self.legs().system.scales_of(self.legs().mode(segment), self.legs().layout.p(q))
    }

    fn function_scale(&self, segment: usize, function: usize, q: &[f64]) -> f64 {
        let (mode, p) = (self.legs().mode(segment), self.legs().layout.p(q));
        match function.checked_sub(self.legs().guards.len()) {
            None => GuardOf::typical(self.legs().system(), function, mode, p).scale,
            Some(k) => ScalarOf::new(self.legs().system(), Observable::Function(k), mode, p).scale,
        }
    }

    fn extra_scales(&self, p: &[f64]) -> Vec<f64> {
        vec![time_scale(self.legs().system(), p); self.extras().len()]
    }

    fn longest_step(&self, segment: usize) -> f64 {
        let guards = self.legs().guards_in(self.legs().mode(segment));
        let times = guards.filter_map(|guard| self.legs().guards[guard].changes_in);
        times.filter(|time| *time > 0.0).fold(f64::INFINITY, f64::min)
    }

    fn monitors(&self) -> Vec<(String, Monitor)> {
        self.itineraries.monitors.clone()
    }

    /// Returns the interface to orbits with other itineraries; `None` for a system without guards,
    /// whose orbits all have the same itinerary.
    fn itineraries(&self) -> Option<&dyn Itineraries<ErasedProblem>> {
        if self.legs().guards.is_empty() { None } else { Some(&self.itineraries) }
    }
}
