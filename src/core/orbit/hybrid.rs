//! Hybrid orbits as boundary-value problems.

use super::itinerary::{Itinerary, Leg};
use crate::core::hybrid::{
    EventNumber, Guard, GuardNumber, HybridEquations, HybridSystem, MeasureNumber, Mode,
};
use crate::core::scalar::Scalar;
use crate::core::watch::Observable;
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
/// Unknown are the states, the time `T_0` of the start (under forcing), and the durations `L_s`.
/// These equations are regular where an event becomes tangent: a leg may last no time, and an
/// impact may have no speed. So an impacting branch begins at a grazing point itself.
///
/// An orbit without events is one segment that closes after `q` periods (or after a period that is
/// unknown, with a phase condition).
#[derive(Clone)]
pub struct HybridOrbit {
    pub(super) system: Arc<dyn HybridEquations>,
    pub(super) itinerary: Itinerary,
    pub(super) modes: Vec<Mode>,
    pub(super) guards: Vec<Guard>,
    pub(super) parameters: Vec<String>,
    pub(super) forced: bool,
    /// Whether there are no events.
    smooth: bool,
    /// Where the states of each leg begin among those of all legs, and their number at the end.
    pub(super) places: Vec<usize>,
    /// Of each leg, whether it ends on the surface on which it begins, once that is known.
    pub(super) returning: OnceLock<Vec<bool>>,
    /// Whether the penetration is recorded.
    pub(super) penetration: bool,
}

/// What orbits belong to: a [`HybridSystem`], or one that is shared.
pub trait IntoHybrid {
    /// The system behind its object-safe face.
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

impl HybridOrbit {
    /// The orbits of a system with an itinerary.
    pub fn of(system: impl IntoHybrid, itinerary: Itinerary) -> Self {
        let system = system.into_hybrid();
        let (modes, guards, parameters) = (system.modes(), system.guards(), system.parameters());
        let forced = system.forcing().is_periodic();
        let mut places = vec![0];
        for leg in &itinerary.legs {
            places.push(places[places.len() - 1] + modes[leg.mode].states.len());
        }
        HybridOrbit {
            returning: OnceLock::new(),
            smooth: itinerary.is_smooth(),
            system,
            itinerary,
            modes,
            guards,
            parameters,
            forced,
            places,
            penetration: false,
        }
    }

    /// Records [`Measure::Penetration`](crate::core::measure::Measure::Penetration) as a monitor, 0
    /// if motion would not turn within a period.
    pub fn with_penetration(mut self) -> Self {
        self.penetration = true;
        self
    }

    /// Orbits of the same system with another itinerary.
    pub(super) fn like(&self, itinerary: Itinerary) -> Self {
        let orbit = HybridOrbit::of(self.system.clone(), itinerary);
        HybridOrbit { penetration: self.penetration, ..orbit }
    }

    /// The system itself.
    pub fn system(&self) -> &dyn HybridEquations {
        &*self.system
    }

    /// What the orbits go through.
    pub fn itinerary(&self) -> &Itinerary {
        &self.itinerary
    }

    /// The guards of a mode.
    pub(super) fn guards_in(&self, mode: usize) -> impl Iterator<Item = usize> + '_ {
        let guards = self.guards.iter().enumerate();
        guards.filter(move |(_, guard)| guard.ends(mode)).map(|(k, _)| k)
    }

    /// A function at a time since the beginning of a leg: a guard, or after all guards a monitor.
    pub(super) fn function_on<T: GuardNumber + MeasureNumber>(
        &self,
        leg: usize,
        function: usize,
        t: T,
        x: &[T],
        q: &[T],
    ) -> T {
        let (mode, t, p) = (self.legs()[leg].mode, self.begin(q) + t, self.split(q).0);
        match function.checked_sub(self.guards.len()) {
            None => self.system.guard(function, mode, t, x, p),
            Some(monitor) => self.system.observe(Observable::Function(monitor), mode, t, x, p),
        }
    }

    pub(in crate::core) fn legs(&self) -> &[Leg] {
        &self.itinerary.legs
    }

    pub(super) fn smooth(&self) -> bool {
        self.smooth
    }

    /// The states of a leg among those of all legs.
    pub(in crate::core) fn of_leg(&self, leg: usize) -> std::ops::Range<usize> {
        self.places[leg]..self.places[leg + 1]
    }

    /// Parameters and further unknowns.
    pub(in crate::core) fn split<'q, T>(&self, q: &'q [T]) -> (&'q [T], &'q [T]) {
        q.split_at(self.parameters.len())
    }

    /// The durations among the further unknowns.
    pub(super) fn durations<'q, T>(&self, extras: &'q [T]) -> &'q [T] {
        &extras[usize::from(self.forced && !self.smooth())..]
    }

    /// The numbers of a leg: parameters, its beginning and its duration; all where there are no
    /// events.
    pub(in crate::core) fn numbers_of(&self, leg: usize, q: &[f64]) -> Vec<f64> {
        let (p, extras) = self.split(q);
        match self.smooth() {
            true => q.to_vec(),
            false => [p, &[self.time(leg, q), self.durations(extras)[leg]]].concat(),
        }
    }

    /// When a leg with the numbers `q` begins.
    pub(super) fn begin<T: Scalar>(&self, q: &[T]) -> T {
        if self.smooth() { T::zero() } else { q[self.parameters.len()] }
    }

    /// When a leg begins.
    pub(super) fn time<T: Scalar>(&self, leg: usize, q: &[T]) -> T {
        let (_, extras) = self.split(q);
        let count = if self.smooth() { 0 } else { leg + usize::from(self.forced) };
        extras[..count].iter().fold(T::zero(), |time, extra| time + *extra)
    }

    /// The time that a cycle takes under forcing.
    pub(super) fn cycle<T: EventNumber>(&self, p: &[T]) -> T {
        self.system.period(p) * self.itinerary.periods as f64
    }
}
