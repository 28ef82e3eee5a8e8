//! Computed orbits, with the trajectories on their legs (the parts between two events).

use super::itinerary::{Itinerary, Leg};
use super::legs::OrbitLegs;
use crate::core::bvp::{Guess, Trajectory};
use crate::core::failure::Failure;
use crate::core::hybrid::{HybridEquations, Moment, time_scale};

/// Heuristic: the approach speed of an event, in units of the scales, below which the event counts as a
/// grazing.
pub(super) const VANISHES: f64 = 1e-6;

/// Heuristic: a leg (a part of the orbit between two events) has zero length if its duration, in
/// units of the time scale, is below this value. The speed at the end of a leg that begins at rest
/// is proportional to the square of the leg's duration: if the speed vanishes to an accuracy of
/// 1e-12, the duration vanishes to 1e-6.
const NO_TIME: f64 = 1e-5;

/// A computed orbit: its legs, the trajectory on each leg, and the vector `q` of parameters and
/// further unknowns.
#[derive(Clone, Copy)]
pub(in crate::core) struct KnownOrbit<'a> {
    pub legs: &'a OrbitLegs,
    pub known: &'a [Trajectory],
    pub q: &'a [f64],
}

/// A leg with its trajectory and its duration.
pub(super) type Lasting = (Leg, Trajectory, f64);

impl<'a> KnownOrbit<'a> {
    /// The system.
    pub fn system(&self) -> &'a dyn HybridEquations {
        self.legs.system()
    }

    /// The parameters.
    pub fn p(&self) -> &'a [f64] {
        self.legs.layout.p(self.q)
    }

    /// Returns the duration of a leg.
    pub fn length(&self, leg: usize) -> f64 {
        self.legs.duration(&self.legs.layout.numbers(leg, self.q))
    }

    /// Whether the duration of a leg is positive, up to rounding.
    pub fn lasts(&self, leg: usize) -> bool {
        self.length(leg).abs() > NO_TIME * time_scale(self.system(), self.p())
    }

    /// Returns the time at which a leg begins.
    pub fn begins(&self, leg: usize) -> f64 {
        self.legs.layout.time(leg, self.q)
    }

    /// Returns the [`Moment`] of a time and a state in the mode of a leg.
    pub fn moment<'x>(&self, leg: usize, t: f64, x: &'x [f64]) -> Moment<'x, f64>
    where
        'a: 'x,
    {
        Moment { system: self.system(), mode: self.legs.mode(leg), t, x, p: self.p() }
    }

    /// Returns the time and the state at the end of a leg.
    pub fn end_of(&self, leg: usize) -> Result<(f64, Vec<f64>), Failure> {
        let length = self.length(leg);
        Ok((self.begins(leg) + length, self.state_on(leg, length)?))
    }

    /// Returns the state on a leg at a given time after the leg's beginning.
    pub fn state_on(&self, leg: usize, since: f64) -> Result<Vec<f64>, Failure> {
        self.on_motion(leg, &self.known[leg], since)
    }

    /// Returns the state on a trajectory at a given time after its beginning; the trajectory
    /// follows the field of a leg.
    pub fn on_motion(
        &self,
        leg: usize,
        motion: &Trajectory,
        since: f64,
    ) -> Result<Vec<f64>, Failure> {
        let numbers = self.legs.layout.numbers(leg, self.q);
        Ok(motion.states_at(&self.legs.field_on(leg, &numbers), since, &numbers)?)
    }

    /// Returns a leg with its trajectory and duration.
    pub(super) fn lasting(&self, leg: usize) -> Lasting {
        (self.legs.all()[leg], self.known[leg].clone(), self.length(leg))
    }

    /// Returns an initial guess for orbits of the same system with the given legs, starting at the
    /// time `begins`.
    pub(super) fn with_legs(&self, all: Vec<Lasting>, begins: f64) -> Guess<OrbitLegs> {
        // The start time comes first where it is an unknown.
        let mut extras: Vec<f64> = self.legs.layout.forced.then_some(begins).into_iter().collect();
        let (mut legs, mut trajectories) = (Vec::new(), Vec::new());
        for (leg, motion, duration) in all {
            legs.push(leg);
            trajectories.push(motion);
            extras.push(duration);
        }
        let problem = self.legs.like(Itinerary { legs, periods: self.legs.itinerary.periods });
        Guess { problem, trajectories, extras, beside: None }
    }
}
