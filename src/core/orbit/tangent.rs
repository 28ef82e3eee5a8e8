//! How the field calls the points where orbits graze.

use super::birth::Touch;
use super::departed::VANISHES;
use super::hybrid::HybridOrbit;
use super::itinerary::Leg;
use super::measures::{APPROACH, DECISION};
use crate::core::bvp::{Equations, Monitor, Trajectory};
use crate::core::condition::Failure;
use crate::core::hybrid::{Moment, Tangency, time_scale};

/// Several surfaces are touched in one period, as by a symmetric orbit between two walls.
const DOUBLE: &str = "double grazing";

/// What happens at a time, in a state.
type Place = (Tangency, f64, Vec<f64>);

impl HybridOrbit {
    /// What the system calls the point where a monitor of grazings vanishes.
    pub(super) fn name_of_grazing(
        &self,
        monitor: usize,
        known: &[Trajectory],
        q: &[f64],
    ) -> Option<&'static str> {
        let mut several = false;
        let place = match self.monitors().swap_remove(monitor).1 {
            Monitor::Distance(_) => {
                let touches = self.touches(known, q).ok()?;
                several = touches.iter().any(|touch| touch.guard != touches[0].guard);
                Ok(touches.into_iter().next().map(|touch| self.place_of(touch, q)))
            }
            // Where a leg vanishes its event has no speed, and a decision vanishes with it.
            Monitor::Ends(function) => self
                .vanished(known, q)
                .map_or_else(|| self.at_event(function, known, q), |place| Ok(Some(place))),
            _ => Ok(None),
        };
        let (tangency, t, x) = place.ok().flatten()?;
        let kind = self.system().kind_of_tangency(tangency, t, &x, self.split(q).0);
        kind.or(several.then_some(DOUBLE))
    }

    /// A touch of a guard that the orbit does not pass.
    fn place_of(&self, touch: Touch, q: &[f64]) -> Place {
        let mode = self.legs()[touch.leg].mode;
        let t = self.time(touch.leg, q) + touch.since;
        (Tangency::Touch { guard: touch.guard, mode }, t, touch.x)
    }

    /// The first leg that lasts no time.
    fn vanished(&self, known: &[Trajectory], q: &[f64]) -> Option<Place> {
        let (legs, (p, extras)) = (self.legs(), self.split(q));
        let least = VANISHES * time_scale(self.system(), p);
        let durations = self.durations(extras);
        let leg = (0..legs.len()).find(|leg| durations[*leg].abs() <= least)?;
        let before = legs[(leg + legs.len() - 1) % legs.len()].mode;
        let tangency = Tangency::Leg { before, mode: legs[leg].mode, after: self.mode_after(leg) };
        Some((tangency, self.time(leg, q), known[leg].start().to_vec()))
    }

    /// The event with the least speed, or with the least margin of its decision.
    fn at_event(
        &self,
        function: usize,
        known: &[Trajectory],
        q: &[f64],
    ) -> Result<Option<Place>, Failure> {
        let (system, p) = (self.system(), self.split(q).0);
        let mut least: Option<(f64, Place)> = None;
        for (leg, Leg { mode, exit, accumulates }) in self.legs().iter().copied().enumerate() {
            let Some(guard) = exit.filter(|_| !accumulates) else { continue };
            let (t, x) = self.end_of(leg, known, q)?;
            let (at, next) = (Moment { system, mode, t, x: &x, p }, self.mode_after(leg));
            let (value, tangency) = match function {
                APPROACH => (Some(at.rate(guard).abs()), Tangency::Slow { guard, mode, next }),
                DECISION => (self.margin(leg, at), Tangency::Decision { guard, mode, next }),
                _ => (None, Tangency::Slow { guard, mode, next }),
            };
            let Some(value) = value.map(f64::abs) else { continue };
            if least.as_ref().is_none_or(|(known, _)| value < *known) {
                least = Some((value, (tangency, t, x)));
            }
        }
        Ok(least.map(|(_, place)| place))
    }
}
