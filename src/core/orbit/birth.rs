//! Impacting orbits born at grazings.
//!
//! Where an orbit touches a guard it passes no event yet; a moment later there is one, which begins and ends
//! a leg, with legs between that last no time: an impact of no speed, a slip of no length. With those legs
//! inserted the grazing orbit is a regular point of a branch of orbits that have the event.

use super::departed::VANISHES;
use super::following::{Instant, NUDGE, Onset};
use super::hybrid::{HybridOrbit, IntoHybrid};
use super::itinerary::{Itinerary, Leg};
use crate::core::bvp::{Birth, Equations, Residual};
use crate::core::condition::Failure;
use crate::core::flow::{Extrema, Flow};
use crate::core::hybrid::{Cycle, GuardNumber, MeasureNumber, Moment, guard_scale, time_scale};
use crate::core::watch::{WatchIn, Watchable};
use std::ops::ControlFlow;

/// Where an orbit comes nearest to a guard.
struct Touch {
    leg: usize,
    guard: usize,
    /// The time since the leg's beginning.
    since: f64,
    value: f64,
    x: Vec<f64>,
}

/// A guard along a segment.
struct OnLeg<'a> {
    orbit: &'a HybridOrbit,
    leg: usize,
    guard: usize,
    /// The size of the guard's typical changes.
    scale: f64,
}

impl<T: GuardNumber + MeasureNumber> WatchIn<T> for OnLeg<'_> {
    fn value_in(&self, t: T, x: &[T], q: &[T]) -> T {
        self.orbit.function_on(self.leg, self.guard, t, x, q)
    }
}

impl Watchable<f64> for OnLeg<'_> {
    fn size(&self) -> f64 {
        self.scale
    }
}

impl HybridOrbit {
    /// The orbits with the itinerary of a simulated cycle, and that cycle as one of them.
    ///
    /// # Errors
    /// [`Failure`] if the cycle holds a series of infinitely many events, which is no itinerary.
    pub fn of_cycle(system: impl IntoHybrid, cycle: &Cycle) -> Result<Birth<Self>, Failure> {
        if cycle.legs.iter().any(|leg| leg.accumulation) {
            let reason =
                "the simulated motion chatters completely: infinitely many events are no itinerary";
            return Err(Failure::Unsupported(reason.into()));
        }
        let legs = cycle.legs.iter().map(|leg| Leg { mode: leg.mode, exit: leg.exit }).collect();
        let itinerary = Itinerary { legs, periods: cycle.periods };
        let starts = cycle.legs.iter().flat_map(|leg| leg.start.clone()).collect();
        let durations = cycle.legs.iter().map(|leg| leg.duration);
        let problem = HybridOrbit::of(system, itinerary);
        // The time of the start comes first where it is an unknown.
        let extras = match problem.extras().len().checked_sub(cycle.legs.len()) {
            None => Vec::new(),
            Some(0) => durations.collect(),
            Some(_) => std::iter::once(cycle.start).chain(durations).collect(),
        };
        Ok(Birth { problem, starts, extras })
    }

    /// The orbits that are born where this one touches guards, all at a time. They begin after the nearest touch.
    pub(in crate::core) fn born(&self, starts: &[f64], q: &[f64]) -> Result<Birth<Self>, Failure> {
        let (legs, touches) = (self.legs(), self.touches(starts, q)?);
        let nearest = touches.iter().min_by(|a, b| a.value.abs().total_cmp(&b.value.abs()));
        let nearest = nearest.map(|touch| (touch.leg, touch.since));
        let (mut all, mut first) = (Vec::<(Instant, f64)>::new(), 0);
        for leg in 0..legs.len() {
            let (mut begin, mut since) = (starts[self.of_leg(leg)].to_vec(), 0.0);
            for touch in touches.iter().filter(|touch| touch.leg == leg) {
                let ended = Leg { exit: Some(touch.guard), ..legs[leg] };
                all.push(((ended, begin), touch.since - since));
                if nearest == Some((leg, touch.since)) {
                    first = all.len();
                }
                let (following, _) = self.following_touch(touch, q)?;
                all.extend(following.into_iter().map(|instant| (instant, 0.0)));
                (begin, since) = (touch.x.clone(), touch.since);
            }
            all.push(((legs[leg], begin), self.duration_of(leg, q) - since));
        }
        all.rotate_left(first);
        if self.smooth() {
            // The start is no event: what goes on there is one leg.
            let joint = all.len() - first;
            let ((ended, _), duration) = all.remove(joint);
            let ((leg, _), before) = &mut all[joint - 1];
            *leg = ended;
            *before += duration;
        }
        let begins = nearest.map_or(0.0, |(leg, since)| self.time(leg, q) + since);
        Ok(self.with_legs(all, begins))
    }

    /// Orbits with these legs, by the states with which they begin, and their durations.
    pub(super) fn with_legs(&self, legs: Vec<(Instant, f64)>, begins: f64) -> Birth<Self> {
        // The time of the start comes first where it is an unknown.
        let begins = self.forced.then_some(begins);
        let extras = begins.into_iter().chain(legs.iter().map(|leg| leg.1)).collect();
        let (legs, starts): (Vec<Leg>, Vec<Vec<f64>>) = legs.into_iter().map(|leg| leg.0).unzip();
        let problem = self.like(Itinerary { legs, periods: self.itinerary.periods });
        Birth { problem, starts: starts.concat(), extras }
    }

    /// How long a leg lasts.
    fn duration_of(&self, leg: usize, q: &[f64]) -> f64 {
        match self.smooth() {
            true => self.duration_in(leg, q),
            false => self.durations(self.split(q).1)[leg],
        }
    }

    /// Where the orbit touches guards that it does not pass, in order; where it touches none, the place where it comes
    /// nearest to one.
    fn touches(&self, starts: &[f64], q: &[f64]) -> Result<Vec<Touch>, Failure> {
        let mut found: Vec<(Touch, f64)> = Vec::new();
        for leg in 0..self.legs().len() {
            let (mode, p) = (self.legs()[leg].mode, self.split(q).0);
            let start = &starts[self.of_leg(leg)];
            for guard in self.guards_in(mode) {
                let place = (self.time(leg, q), start);
                let scale = guard_scale(self.system(), (guard, mode), place, p);
                let watch = OnLeg { orbit: self, leg, guard, scale };
                let dips = self.dips(&watch, start, &self.numbers_of(leg, q))?;
                found.extend(dips.into_iter().map(|touch| (touch, VANISHES * scale)));
            }
        }
        let nearest = found.iter().map(|(touch, _)| touch.value.abs()).reduce(f64::min);
        let Some(nearest) = nearest else {
            let reason = "the orbit comes near to no guard: a branch is born where one touches (G)";
            return Err(Failure::Undetermined(reason.into()));
        };
        found.retain(|(touch, zero)| touch.value.abs() <= zero.max(nearest));
        let mut touches: Vec<Touch> = found.into_iter().map(|(touch, _)| touch).collect();
        touches.sort_by(|a, b| a.leg.cmp(&b.leg).then(a.since.total_cmp(&b.since)));
        Ok(touches)
    }

    /// The local minima of a guard on a leg, with the states there.
    fn dips(&self, watch: &OnLeg, start: &[f64], q: &[f64]) -> Result<Vec<Touch>, Failure> {
        let (mut x, leg) = (start.to_vec(), watch.leg);
        let (mut extrema, mut found) = (Extrema::default(), Vec::<(f64, f64)>::new());
        let field = Residual::<f64>::on_segment(self, leg, q);
        let duration = self.duration_in(leg, q);
        let mut flow = Flow::<f64>::default();
        let outcome = flow.observe(&field, 0.0, duration, &mut x, q, |step| {
            extrema.search(watch, step, |extremum| found.push((extremum.place, extremum.value)));
            ControlFlow::Continue(())
        });
        outcome?;
        let touch = |(place, value): (f64, f64)| {
            let (mut x, since) = (start.to_vec(), place * duration);
            flow.advance(&field, 0.0, since, &mut x, q)?;
            Ok(Touch { leg, guard: watch.guard, since, value, x })
        };
        found.into_iter().map(touch).collect()
    }

    /// The legs that follow a touch at once, until motion goes on in the mode that was touched: decided at a small approach
    /// speed.
    fn following_touch(
        &self,
        touch: &Touch,
        q: &[f64],
    ) -> Result<(Vec<Instant>, Vec<f64>), Failure> {
        let (system, mode, guard) = (self.system(), self.legs()[touch.leg].mode, touch.guard);
        let p = self.split(q).0;
        let t = self.time(touch.leg, q) + touch.since;
        let at = Moment { system, mode, t, x: &touch.x, p };
        let scale = guard_scale(system, (guard, mode), (t, &touch.x), p);
        let speed = NUDGE * scale / time_scale(system, p);
        let near = self.nudged(guard, at, |at| at.rate(guard), -speed);
        let onset = Onset { guard, mode, next: None, at: (t, touch.x.clone()), near };
        self.following(onset, mode, p)
    }
}
