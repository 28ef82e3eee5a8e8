//! The legs of hybrid orbits: a system, an itinerary, and the position of each leg's states and
//! scalar unknowns in the vectors of the whole orbit.

use super::itinerary::{Itinerary, Leg};
use super::still::Still;
use crate::core::bvp::Ends;
use crate::core::hybrid::{ChatterNumber, EventNumber, Guard, HybridEquations, Mode, Moment};
use crate::core::problem::FieldRef;
use crate::core::scalar::Scalar;
use std::ops::Range;
use std::sync::Arc;

/// Discretisation: for an orbit that never leaves the surface of its mode, the multiplier in the
/// direction normal to the surface is set to `e^(−LOST)`, which is zero up to rounding. Without
/// this setting, the multiplier would be 1, since the vector field preserves deviations from the
/// surface.
const LOST: f64 = 36.0;

/// The position of each leg's states and scalar unknowns in the vectors of the whole orbit. The
/// scalar unknowns of an orbit are the vector `q = (p, e)` of parameters `p` and extra unknowns
/// `e`. The extra unknowns `e` are the durations of the legs and, under forcing, the start time.
/// For an orbit without events, the only extra unknown is the period; under forcing the period is
/// known.
#[derive(Clone)]
pub(in crate::core) struct LegLayout {
    parameters: usize,
    pub forced: bool,
    /// Whether the itinerary has no events.
    pub smooth: bool,
    /// The offsets of the legs' states in the vector of the states of all legs; the last entry is
    /// the total number of states.
    places: Vec<usize>,
}

impl LegLayout {
    /// Returns the range of a leg's states in the vector of the states of all legs.
    pub fn states(&self, leg: usize) -> Range<usize> {
        self.places[leg]..self.places[leg + 1]
    }

    /// Returns the parameters in the vector `q`.
    pub fn p<'q, T>(&self, q: &'q [T]) -> &'q [T] {
        &q[..self.parameters]
    }

    /// Whether the start time is an unknown of the orbit.
    pub fn starts(&self) -> bool {
        self.forced && !self.smooth
    }

    /// Returns the durations of the legs in the vector `q` of an orbit.
    pub fn durations<'q, T>(&self, q: &'q [T]) -> &'q [T] {
        &q[self.parameters + usize::from(self.starts())..]
    }

    /// Returns the time at which a leg begins, given the vector `q` of the orbit.
    pub fn time<T: Scalar>(&self, leg: usize, q: &[T]) -> T {
        let count = if self.smooth { 0 } else { leg + usize::from(self.forced) };
        q[self.parameters..][..count].iter().fold(T::zero(), |time, extra| time + *extra)
    }

    /// Returns the vector `q` of a single leg: parameters, start time and duration. If the
    /// itinerary has no events, the result is the vector `q` of the orbit.
    pub fn numbers(&self, leg: usize, q: &[f64]) -> Vec<f64> {
        match self.smooth {
            true => q.to_vec(),
            false => [self.p(q), &[self.time(leg, q), self.durations(q)[leg]]].concat(),
        }
    }

    /// Returns the time at which a leg begins, given the leg's vector `q`.
    pub fn begin<T: Scalar>(&self, q: &[T]) -> T {
        if self.smooth { T::zero() } else { q[self.parameters] }
    }
}

/// The legs (parts between two events) of the orbits of a hybrid system with a given itinerary.
#[derive(Clone)]
pub(in crate::core) struct OrbitLegs {
    pub system: Arc<dyn HybridEquations>,
    pub itinerary: Itinerary,
    pub modes: Vec<Mode>,
    pub guards: Vec<Guard>,
    pub parameters: Vec<String>,
    pub layout: LegLayout,
    /// Whether the penetration is recorded as a monitor.
    pub penetration: bool,
}

impl OrbitLegs {
    pub fn new(system: Arc<dyn HybridEquations>, itinerary: Itinerary, penetration: bool) -> Self {
        let (modes, guards, parameters) = (system.modes(), system.guards(), system.parameters());
        let mut places = vec![0];
        for leg in &itinerary.legs {
            places.push(places[places.len() - 1] + modes[leg.mode].states.len());
        }
        let (forced, smooth) = (system.forcing().is_periodic(), itinerary.is_smooth());
        let layout = LegLayout { parameters: parameters.len(), forced, smooth, places };
        OrbitLegs { system, itinerary, modes, guards, parameters, layout, penetration }
    }

    /// Returns the legs of orbits of the same system with another itinerary.
    pub fn like(&self, itinerary: Itinerary) -> OrbitLegs {
        OrbitLegs::new(self.system.clone(), itinerary, self.penetration)
    }

    /// The hybrid system.
    pub fn system(&self) -> &dyn HybridEquations {
        &*self.system
    }

    /// All legs.
    pub fn all(&self) -> &[Leg] {
        &self.itinerary.legs
    }

    /// Returns the mode of a leg.
    pub fn mode(&self, leg: usize) -> usize {
        self.all()[leg].mode
    }

    /// Iterates over the events of an orbit; each item contains the leg (part of the orbit) that
    /// the event ends, the guard of the event, and the time and state of the event. Legs that end
    /// at an accumulation of events are skipped.
    pub fn events<'a, T: Scalar>(
        &'a self,
        ends: Ends<'a, T>,
        q: &'a [T],
    ) -> impl Iterator<Item = (usize, usize, Moment<'a, T>)> + 'a {
        let (p, system, durations) = (self.layout.p(q), self.system(), self.layout.durations(q));
        let mut t = self.layout.time(0, q);
        // Orbits without events under forcing have no durations.
        self.all().iter().zip(durations).enumerate().filter_map(move |(s, (leg, duration))| {
            t += *duration;
            let x = &ends.end[self.layout.states(s)];
            let guard = leg.exit.filter(|_| !leg.accumulates)?;
            Some((s, guard, Moment { system, mode: leg.mode, t, x, p }))
        })
    }

    /// Returns the mode that follows a leg.
    pub fn mode_after(&self, leg: usize) -> usize {
        self.mode((leg + 1) % self.all().len())
    }

    /// Returns the guards of a mode.
    pub fn guards_in(&self, mode: usize) -> impl Iterator<Item = usize> + '_ {
        let guards = self.guards.iter().enumerate();
        guards.filter(move |(_, guard)| guard.ends(mode)).map(|(k, _)| k)
    }

    /// Returns the guards of a mode whose events occur where the guard vanishes, excluding events
    /// at given times.
    pub fn vanishing_in(&self, mode: usize) -> impl Iterator<Item = usize> + '_ {
        self.guards_in(mode).filter(|guard| !self.guards[*guard].is_timed())
    }

    /// Returns the guards of a mode that have timed events, which occur at given times.
    pub fn timed_in(&self, mode: usize) -> impl Iterator<Item = usize> + '_ {
        self.guards_in(mode).filter(|guard| self.guards[*guard].is_timed())
    }

    /// Returns the vector field on a leg, given the leg's vector `q`; time is measured from the
    /// start of the leg. The vector field is zero on a leg that represents accumulating events,
    /// because the states of such a leg are constant.
    pub fn field_on<'a, T: ChatterNumber>(&'a self, leg: usize, q: &'a [T]) -> FieldRef<'a, T> {
        let (Leg { mode, accumulates, .. }, numbers) = (self.all()[leg], self.parameters.len());
        if accumulates {
            return FieldRef::of(&Still);
        }
        let lasting = self.layout.smooth && self.modes[mode].on_surface;
        let attraction = lasting.then(|| T::from(LOST) / self.duration(q));
        FieldRef { numbers, attraction, ..T::in_mode(self.system(), mode, self.layout.begin(q)) }
    }

    /// Returns the duration of a leg, given the leg's vector `q`.
    pub fn duration<T: EventNumber>(&self, q: &[T]) -> T {
        match self.layout.smooth && self.layout.forced {
            true => self.cycle(self.layout.p(q)),
            false => q[q.len() - 1],
        }
    }

    /// Returns the duration of a cycle of a forced system.
    pub fn cycle<T: EventNumber>(&self, p: &[T]) -> T {
        self.system.period(p) * self.itinerary.periods as f64
    }
}
