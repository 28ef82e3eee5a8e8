//! How the field calls the points where orbits graze.

use super::birth::Touch;
use super::itinerary::Leg;
use super::known::KnownOrbit;
use super::measures::{APPROACH, DECISION};
use crate::core::bvp::{Equations, Monitor};
use crate::core::condition::Failure;
use crate::core::hybrid::{Moment, Tangency};

/// Several surfaces are touched in one period, as by a symmetric orbit between two walls.
const DOUBLE: &str = "double grazing";

/// What happens at a time, in a state.
type Place = (Tangency, f64, Vec<f64>);

impl KnownOrbit<'_> {
    /// What the system calls the point where a monitor of grazings vanishes.
    pub(super) fn name_of_grazing(&self, monitor: usize) -> Option<&'static str> {
        let mut several = false;
        let place = match self.monitors().swap_remove(monitor).1 {
            Monitor::Distance(_) => {
                let touches = self.touches().ok()?;
                several = touches.iter().any(|touch| touch.guard != touches[0].guard);
                touches.into_iter().next().map(|touch| self.place_of(touch))
            }
            // Where a leg vanishes its event has no speed, and a decision vanishes with it.
            Monitor::Ends(function) => {
                self.vanished().or_else(|| self.at_event(function).ok().flatten())
            }
            _ => None,
        };
        let (tangency, t, x) = place?;
        let kind = self.system().kind_of_tangency(tangency, t, &x, self.p());
        kind.or(several.then_some(DOUBLE))
    }

    /// A touch of a guard that the orbit does not pass.
    fn place_of(&self, Touch { leg, guard, since, x, .. }: Touch) -> Place {
        let mode = self.legs()[leg].mode;
        (Tangency::Touch { guard, mode }, self.begins(leg) + since, x)
    }

    /// The first leg that lasts no time.
    fn vanished(&self) -> Option<Place> {
        let legs = self.legs();
        let leg = (0..legs.len()).find(|leg| !self.lasts(*leg))?;
        let before = legs[(leg + legs.len() - 1) % legs.len()].mode;
        let tangency = Tangency::Leg { before, mode: legs[leg].mode, after: self.mode_after(leg) };
        Some((tangency, self.begins(leg), self.known[leg].start().to_vec()))
    }

    /// The event with the least speed, or with the least margin of its decision.
    fn at_event(&self, function: usize) -> Result<Option<Place>, Failure> {
        let (system, p) = (self.system(), self.p());
        let mut least: Option<(f64, Place)> = None;
        for (leg, Leg { mode, exit, accumulates }) in self.legs().iter().copied().enumerate() {
            let Some(guard) = exit.filter(|_| !accumulates) else { continue };
            let (t, x) = self.end_of(leg)?;
            let (at, next) = (Moment { system, mode, t, x: &x, p }, self.mode_after(leg));
            let (value, tangency) = match function {
                APPROACH => (Some(at.rate(guard)), Tangency::Slow { guard, mode, next }),
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
