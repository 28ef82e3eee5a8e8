//! Orbits without the legs that last no time where a branch ends: its continuation beyond a grazing at which legs vanish.

use super::hybrid::HybridOrbit;
use super::itinerary::{Itinerary, Leg};
use crate::core::bvp::{Birth, Residual};
use crate::core::condition::Failure;
use crate::core::flow::Flow;
use crate::core::hybrid::{Moment, guard_scale, time_scale};

/// An event that is approached more slowly is a touch, and a leg that is shorter lasts no time: in units of the scales.
pub(in crate::core) const VANISHES: f64 = 1e-6;

impl HybridOrbit {
    /// The orbits without the legs that last no time here: the events before them lead to the legs behind them.
    /// `None` where there are no such legs, where they belong to an event without a speed, which vanishes with them, and
    /// where no event leads past them.
    pub(super) fn without_vanished(
        &self,
        starts: &[f64],
        q: &[f64],
    ) -> Result<Option<Birth<Self>>, Failure> {
        let ((p, extras), legs) = (self.split(q), self.legs());
        let durations = self.durations(extras);
        let least = VANISHES * time_scale(self.system(), p);
        let kept: Vec<usize> = match self.smooth() {
            true => Vec::new(),
            false => (0..legs.len()).filter(|&leg| durations[leg].abs() > least).collect(),
        };
        if kept.is_empty() || kept.len() == legs.len() {
            return Ok(None);
        }
        for (k, &leg) in kept.iter().enumerate() {
            let next = kept[(k + 1) % kept.len()];
            if next != (leg + 1) % legs.len() && !self.leads_past(leg, next, starts, q)? {
                return Ok(None);
            }
        }
        let itinerary = Itinerary {
            legs: kept.iter().map(|&leg| legs[leg]).collect(),
            periods: self.itinerary.periods,
        };
        let begins = self.forced.then(|| self.time(kept[0], q));
        let starts = kept.iter().flat_map(|&leg| &starts[self.of_leg(leg)]).copied().collect();
        let extras = begins.into_iter().chain(kept.iter().map(|&leg| durations[leg])).collect();
        Ok(Some(Birth { problem: self.like(itinerary), starts, extras, beside: None }))
    }

    /// Time and state where a leg ends.
    pub(super) fn end_of(
        &self,
        leg: usize,
        starts: &[f64],
        q: &[f64],
    ) -> Result<(f64, Vec<f64>), Failure> {
        let (mut x, numbers) = (starts[self.of_leg(leg)].to_vec(), self.numbers_of(leg, q));
        let field = Residual::<f64>::on_segment(self, leg, &numbers);
        let duration = self.durations(self.split(q).1)[leg];
        Flow::<f64>::default().advance(&field, 0.0, duration, &mut x, &numbers)?;
        Ok((self.time(leg, q) + duration, x))
    }

    /// Whether the event that ends a leg has a speed, and a reset to the mode of a later one.
    fn leads_past(
        &self,
        leg: usize,
        next: usize,
        starts: &[f64],
        q: &[f64],
    ) -> Result<bool, Failure> {
        let (p, system) = (self.split(q).0, self.system());
        let Leg { mode, exit: Some(guard), accumulates: false } = self.legs()[leg] else {
            return Ok(false);
        };
        let (t, x) = self.end_of(leg, starts, q)?;
        let slow =
            VANISHES * guard_scale(system, (guard, mode), (t, &x), p) / time_scale(system, p);
        let mode_after = self.legs()[next].mode;
        let mut after = vec![0.0; self.modes[mode_after].states.len()];
        system.reset(guard, (mode, mode_after), t, &x, p, &mut after);
        let speed = Moment { system, mode, t, x: &x, p }.rate(guard).abs();
        Ok(speed > slow && after.iter().all(|x| x.is_finite()))
    }
}
