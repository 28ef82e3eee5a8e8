//! Impacting orbits born at grazings.
//!
//! Where an orbit touches a guard it passes no event yet; a moment later there is one, which begins and ends
//! a leg, with legs between that last no time: an impact of no speed, a slip of no length. With those legs
//! inserted the grazing orbit is a regular point of a branch of orbits that have the event.

use super::hybrid::{HybridOrbit, IntoHybrid};
use super::itinerary::{Itinerary, Leg};
use crate::core::bvp::{Birth, Equations, Residual};
use crate::core::condition::Failure;
use crate::core::flow::{Extrema, Flow};
use crate::core::hybrid::{Cycle, GuardNumber, MeasureNumber, Moment, guard_scale, time_scale};
use crate::core::vector::dot;
use crate::core::watch::{WatchIn, Watchable};
use num_dual::Dual64;
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

/// After a touch, an event comes at this approach speed, to see what follows.
const NUDGE: f64 = 1e-6;
/// No more events than this follow at once.
const MOST_LEGS: usize = 32;
/// Resets at a touch that move the state no farther, in units of its scales, leave it where it was.
const UNMOVED: f64 = 1e-6;

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

    /// The orbits that are born where this one touches a guard.
    pub(in crate::core) fn born(&self, starts: &[f64], q: &[f64]) -> Result<Birth<Self>, Failure> {
        let touch = self.touch(starts, q)?;
        let following = self.following(&touch, q)?;
        let legs = self.legs();
        let (before, after) = (&legs[..touch.leg], &legs[touch.leg..]);
        let first = Leg { exit: Some(touch.guard), ..after[0] };
        // The orbit begins after the touch.
        let (mut new, mut states): (Vec<Leg>, Vec<Vec<f64>>) = following.into_iter().unzip();
        // The time of the start comes first where it is an unknown.
        let begins = self.forced.then(|| self.time(touch.leg, q) + touch.since);
        let mut extras: Vec<f64> = begins.into_iter().chain(new.iter().map(|_| 0.0)).collect();
        states.push(touch.x);
        if self.smooth() {
            extras.push(self.duration_in(0, q));
        } else {
            let old = self.durations(self.split(q).1);
            new.extend(after.iter().chain(before));
            extras.push(old[touch.leg] - touch.since);
            for leg in (touch.leg + 1..legs.len()).chain(0..=touch.leg) {
                states.push(starts[self.of_leg(leg)].to_vec());
                extras.push(if leg == touch.leg { touch.since } else { old[leg] });
            }
        }
        new.push(first);
        let problem = self.like(Itinerary { legs: new, periods: self.itinerary.periods });
        Ok(Birth { problem, starts: states.concat(), extras })
    }

    /// Where the orbit comes nearest to a guard that it does not pass.
    fn touch(&self, starts: &[f64], q: &[f64]) -> Result<Touch, Failure> {
        let mut nearest: Option<Touch> = None;
        for leg in 0..self.legs().len() {
            let (mode, p) = (self.legs()[leg].mode, self.split(q).0);
            let start = &starts[self.of_leg(leg)];
            for guard in self.guards_in(mode) {
                let place = (self.time(leg, q), start);
                let scale = guard_scale(self.system(), (guard, mode), place, p);
                let watch = OnLeg { orbit: self, leg, guard, scale };
                let found = self.dip(&watch, start, &self.numbers_of(leg, q))?;
                let nearer =
                    |f: &Touch| nearest.as_ref().is_none_or(|n| f.value.abs() < n.value.abs());
                if let Some(found) = found.filter(nearer) {
                    nearest = Some(found);
                }
            }
        }
        nearest.ok_or_else(|| {
            let reason = "the orbit comes near to no guard: a branch is born where one touches (G)";
            Failure::Undetermined(reason.into())
        })
    }

    /// The local minimum of a guard on a leg that is nearest to zero, with the state there.
    fn dip(&self, watch: &OnLeg, start: &[f64], q: &[f64]) -> Result<Option<Touch>, Failure> {
        let (mut x, leg) = (start.to_vec(), watch.leg);
        let (mut extrema, mut found) = (Extrema::default(), None::<(f64, f64)>);
        let field = Residual::<f64>::on_segment(self, leg, q);
        let duration = self.duration_in(leg, q);
        let mut flow = Flow::<f64>::default();
        let outcome = flow.observe(&field, 0.0, duration, &mut x, q, |step| {
            extrema.search(watch, step, |extremum| {
                if found.is_none_or(|(_, value)| extremum.value.abs() < value.abs()) {
                    found = Some((extremum.place, extremum.value));
                }
            });
            ControlFlow::Continue(())
        });
        outcome?;
        let Some((place, value)) = found else { return Ok(None) };
        x.copy_from_slice(start);
        let since = place * duration;
        flow.advance(&field, 0.0, since, &mut x, q)?;
        Ok(Some(Touch { leg, guard: watch.guard, since, value, x }))
    }

    /// The legs that follow a touch at once, with the states at which they begin, until motion goes on in
    /// the mode that was touched. Which events come next is decided at a small approach speed; the states are
    /// those of the touch itself.
    fn following(&self, touch: &Touch, q: &[f64]) -> Result<Vec<(Leg, Vec<f64>)>, Failure> {
        let (system, mode) = (self.system(), self.legs()[touch.leg].mode);
        let p = &q[..self.parameters().len()];
        let t = self.time(touch.leg, q) + touch.since;
        let (mut limit, mut near) = (touch.x.clone(), self.nudged(touch, mode, t, p));
        let (mut guard, mut last) = (touch.guard, mode);
        let mut legs = Vec::<(Leg, Vec<f64>)>::new();
        loop {
            let next = system.next_mode(guard, last, t, &near, p);
            let reset = |x: &[f64]| {
                let mut after = vec![0.0; self.modes[next].states.len()];
                system.reset(guard, (last, next), t, x, p, &mut after);
                after
            };
            (limit, near) = (reset(&limit), reset(&near));
            if next == mode {
                return self.unmoved(touch, &limit, p).map(|()| legs);
            }
            let soonest = self.soonest(next, t, &near, p);
            let Some((time, exit)) = soonest.filter(|_| legs.len() < MOST_LEGS) else {
                return Err(Failure::Undetermined(format!(
                    "after the touch, motion does not come back to mode `{}` at once: start the branch from \
                     a simulated cycle (`orbit::from_cycle`)",
                    self.modes[mode].name
                )));
            };
            legs.push((Leg { mode: next, exit: Some(exit) }, limit.clone()));
            let mut f = vec![0.0; near.len()];
            system.field(next, t, &near, p, &mut f);
            near.iter_mut().zip(&f).for_each(|(x, f)| *x += time * f);
            (guard, last) = (exit, next);
        }
    }

    /// Refuses a touch after which motion goes on elsewhere: the orbits with the event lie apart from those without.
    fn unmoved(&self, touch: &Touch, after: &[f64], p: &[f64]) -> Result<(), Failure> {
        let mode = &self.modes[self.legs()[touch.leg].mode];
        let mut sizes = self.system().scales_of(self.legs()[touch.leg].mode, p);
        sizes.resize(after.len(), 1.0);
        let moved = |i: &usize| {
            let (before, after) = (touch.x[*i], after[*i]);
            (after - before).abs() > UNMOVED * sizes[*i].max(before.abs())
        };
        let Some(i) = (0..after.len()).find(moved) else { return Ok(()) };
        Err(Failure::Undetermined(format!(
            "at the touch the event {} takes {} from {:.6e} to {:.6e}: no branch of orbits with the event begins \
             where its reset jumps; start it from a simulated cycle (`orbit::from_cycle`)",
            self.guards[touch.guard].name, mode.states[i], touch.x[i], after[i]
        )))
    }

    /// The state of a touch with a small approach speed, still on the guard: a little along the part of
    /// `∂(dh/dt)/∂x` across `∂h/∂x`.
    fn nudged(&self, touch: &Touch, mode: usize, t: f64, p: &[f64]) -> Vec<f64> {
        let (n, system) = (touch.x.len(), self.system());
        let mut sizes = system.scales_of(mode, p);
        sizes.resize(n, 1.0);
        let speed = NUDGE * guard_scale(system, (touch.guard, mode), (t, &touch.x), p)
            / time_scale(system, p);
        let p: Vec<Dual64> = p.iter().map(|p| Dual64::from(*p)).collect();
        let (mut normal, mut slope) = (vec![0.0; n], vec![0.0; n]);
        for i in 0..n {
            let mut x: Vec<Dual64> = touch.x.iter().map(|x| Dual64::from(*x)).collect();
            x[i].eps = sizes[i];
            let changed = Moment { system, mode, t: t.into(), x: &x, p: &p };
            normal[i] = changed.guard(touch.guard).eps;
            slope[i] = changed.rate(touch.guard).eps;
        }
        let share = dot(&slope, &normal) / dot(&normal, &normal).max(f64::MIN_POSITIVE);
        slope.iter_mut().zip(&normal).for_each(|(s, n)| *s -= share * n);
        let size = dot(&slope, &slope).max(f64::MIN_POSITIVE);
        let changes = slope.iter().zip(&sizes).map(|(s, unit)| speed * s * unit / size);
        touch.x.iter().zip(changes).map(|(x, change)| x - change).collect()
    }

    /// The guard of a mode that falls to zero first, by its rate, and when.
    fn soonest(&self, mode: usize, t: f64, x: &[f64], p: &[f64]) -> Option<(f64, usize)> {
        let at = Moment { system: self.system(), mode, t, x, p };
        let times = self.guards_in(mode).filter_map(|guard| {
            let (value, rate) = (at.guard(guard), at.rate(guard));
            (rate < 0.0).then(|| ((value / -rate).max(0.0), guard))
        });
        times.min_by(|a, b| a.0.total_cmp(&b.0))
    }
}
