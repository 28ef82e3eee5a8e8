//! Orbits with the motion on their legs.

use super::hybrid::HybridOrbit;
use crate::core::bvp::{Residual, Trajectory};
use crate::core::condition::Failure;
use std::ops::Deref;

/// A known orbit: its problem, the trajectory on each leg, and the numbers `q`.
#[derive(Clone, Copy)]
pub(in crate::core) struct KnownOrbit<'a> {
    pub problem: &'a HybridOrbit,
    pub known: &'a [Trajectory],
    pub q: &'a [f64],
}

impl Deref for KnownOrbit<'_> {
    type Target = HybridOrbit;

    fn deref(&self) -> &HybridOrbit {
        self.problem
    }
}

impl<'a> KnownOrbit<'a> {
    /// The parameters.
    pub fn p(&self) -> &'a [f64] {
        self.problem.split(self.q).0
    }

    /// How long each leg lasts.
    pub fn lengths(&self) -> &'a [f64] {
        self.problem.durations(self.problem.split(self.q).1)
    }

    /// When a leg begins.
    pub fn begins(&self, leg: usize) -> f64 {
        self.time(leg, self.q)
    }

    /// Time and state where a leg ends.
    pub fn end_of(&self, leg: usize) -> Result<(f64, Vec<f64>), Failure> {
        let length = self.lengths()[leg];
        Ok((self.begins(leg) + length, self.state_on(leg, length)?))
    }

    /// The state at a time since the beginning of a leg.
    pub fn state_on(&self, leg: usize, since: f64) -> Result<Vec<f64>, Failure> {
        self.on_motion(leg, &self.known[leg], since)
    }

    /// The state at a time since the beginning of a motion by the field of a leg.
    pub fn on_motion(
        &self,
        leg: usize,
        motion: &Trajectory,
        since: f64,
    ) -> Result<Vec<f64>, Failure> {
        let numbers = self.numbers_of(leg, self.q);
        let field = Residual::<f64>::on_segment(self.problem, leg, &numbers);
        Ok(motion.states_at(&field, since, &numbers)?)
    }
}
