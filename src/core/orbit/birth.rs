//! Impacting orbits born at grazings.
//!
//! Where an orbit touches a guard it passes no event yet; a moment later there is one, which begins and ends
//! a leg, with legs between that last no time: an impact of no speed, a slip of no length. With those legs
//! inserted the grazing orbit is a regular point of a branch of orbits that have the event.

use super::departed::{VANISHES, joined_to};
use super::following::{Following, Lasting, NUDGE, Onset};
use super::hybrid::HybridOrbit;
use super::itinerary::{Itinerary, Leg};
use crate::core::bvp::{Birth, Residual, Trajectory};
use crate::core::condition::Failure;
use crate::core::flow::{Extrema, Flow};
use crate::core::hybrid::{GuardNumber, MeasureNumber, Moment, guard_scale, time_scale};
use crate::core::watch::{WatchIn, Watchable};
use std::ops::ControlFlow;

/// Where an orbit comes nearest to a guard.
pub(super) struct Touch {
    pub leg: usize,
    pub guard: usize,
    /// The time since the leg's beginning.
    pub since: f64,
    value: f64,
    pub x: Vec<f64>,
}

/// An event where an orbit had none.
struct Passed {
    leg: usize,
    guard: usize,
    /// The time since the leg's beginning.
    since: f64,
    /// How far the orbit is from the guard.
    distance: f64,
    following: Following,
}

impl Passed {
    /// The time since the leg's beginning at which the leg goes on.
    fn resumed(&self) -> f64 {
        self.since + self.following.legs.iter().map(|(.., duration)| duration).sum::<f64>()
    }
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

/// How much sooner than a touch an event comes that shows in which direction a branch leaves, in units of the scale of time.
const SOONER: f64 = 1e-3;
/// By how much sooner another one comes, of which the error is smaller by the square of this.
const NEARER: f64 = 4.0;
/// Resets at a touch that move the state no farther, in units of its scales, leave it where it was.
const UNMOVED: f64 = 1e-6;
/// Of more touches only the first ones are passed by some branches and not by others.
const MOST_TOUCHES: usize = 8;
/// Errors of states, in units of their scales, that are rounding.
const ROUNDING: f64 = 1e-11;

/// The touches that the branch numbered `which` passes, of `count`: branch 0 passes all, the next ones pass one each, then two each,
/// and so on.
fn selection(count: usize, which: usize) -> Result<Vec<bool>, Failure> {
    if which == 0 {
        return Ok(vec![true; count]);
    }
    let all = 1_usize << count.min(MOST_TOUCHES);
    let mut some: Vec<usize> = (1..all - 1).collect();
    some.sort_by_key(|bits| bits.count_ones());
    let bits = some.get(which - 1).ok_or_else(|| Failure::no_branch(which, all - 1))?;
    Ok((0..count).map(|touch| touch < MOST_TOUCHES && bits >> touch & 1 == 1).collect())
}

impl HybridOrbit {
    /// The orbits that are born where this one touches guards: first those that pass all of them, then those that pass some, in the
    /// order of [`selection`]. They begin after the nearest touch.
    pub(in crate::core) fn born(
        &self,
        known: &[Trajectory],
        q: &[f64],
        which: usize,
    ) -> Result<Birth<Self>, Failure> {
        let (mut touches, mut passed) = self.touched(known, q)?;
        let mut selected = selection(touches.len(), which)?.into_iter();
        (touches, passed) =
            touches.into_iter().zip(passed).filter(|_| selected.next() == Some(true)).unzip();
        let pairs = touches.iter().zip(&passed);
        let sooner = pairs.map(|(touch, passed)| self.passed_sooner(touch, passed, known, q));
        let sooner: Option<Vec<Passed>> = sooner.collect();
        let birth = self.with_passed(passed, known, q);
        let beside = sooner.map(|passed| self.with_passed(passed, known, q));
        let beside = beside.map(|beside| (beside.trajectories, beside.extras));
        Ok(Birth { beside, ..birth })
    }

    /// The same without a neighbour.
    pub(super) fn with_touches(
        &self,
        known: &[Trajectory],
        q: &[f64],
    ) -> Result<Birth<Self>, Failure> {
        let (_, passed) = self.touched(known, q)?;
        Ok(self.with_passed(passed, known, q))
    }

    /// Where the orbit touches guards, and these touches as events.
    fn touched(
        &self,
        known: &[Trajectory],
        q: &[f64],
    ) -> Result<(Vec<Touch>, Vec<Passed>), Failure> {
        let touches = self.touches(known, q)?;
        let passed = touches.iter().map(|touch| self.passed(touch, q)).collect::<Result<_, _>>()?;
        Ok((touches, passed))
    }

    /// This orbit with the legs of what it passes, of which there is one at least.
    fn with_passed(&self, passed: Vec<Passed>, known: &[Trajectory], q: &[f64]) -> Birth<Self> {
        let legs = self.legs();
        let nearest = passed.iter().map(|it| it.distance).fold(f64::INFINITY, f64::min);
        let (mut all, mut first, mut begins) = (Vec::<Lasting>::new(), None, 0.0);
        for leg in 0..legs.len() {
            let (mut begin, mut since, motion) = (known[leg].start().to_vec(), 0.0, &known[leg]);
            for it in passed.iter().filter(|it| it.leg == leg) {
                let part = motion.part(begin, since..it.since);
                all.push((Leg { exit: Some(it.guard), ..legs[leg] }, part, it.since - since));
                if first.is_none() && it.distance <= nearest {
                    (first, begins) = (Some(all.len()), self.time(leg, q) + it.since);
                }
                all.extend(it.following.legs.iter().cloned());
                (begin, since) = (it.following.state.clone(), it.resumed());
            }
            let end = self.duration_of(leg, q);
            all.push((legs[leg], motion.part(begin, since..end), end - since));
        }
        let first = first.unwrap_or_default();
        all.rotate_left(first);
        if self.smooth() {
            // The start is no event: what goes on there is one leg.
            let joint = all.len() - first;
            let (ended, motion, after) = all.remove(joint);
            joined_to(&mut all[joint - 1], (ended, &motion, after));
        }
        self.with_legs(all, begins)
    }

    /// Orbits with these legs, the first of which begins at a time.
    pub(super) fn with_legs(&self, all: Vec<Lasting>, begins: f64) -> Birth<Self> {
        // The time of the start comes first where it is an unknown.
        let mut extras: Vec<f64> = self.forced.then_some(begins).into_iter().collect();
        let (mut legs, mut trajectories) = (Vec::new(), Vec::new());
        for (leg, motion, duration) in all {
            legs.push(leg);
            trajectories.push(motion);
            extras.push(duration);
        }
        let problem = self.like(Itinerary { legs, periods: self.itinerary.periods });
        Birth { problem, trajectories, extras, beside: None }
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
    pub(super) fn touches(&self, known: &[Trajectory], q: &[f64]) -> Result<Vec<Touch>, Failure> {
        let mut found: Vec<(Touch, f64)> = Vec::new();
        for leg in (0..self.legs().len()).filter(|leg| !self.legs()[*leg].accumulates) {
            let (mode, p) = (self.legs()[leg].mode, self.split(q).0);
            for guard in self.guards_in(mode) {
                let place = (self.time(leg, q), known[leg].start());
                let scale = guard_scale(self.system(), (guard, mode), place, p);
                let watch = OnLeg { orbit: self, leg, guard, scale };
                let dips = self.dips(&watch, &known[leg], &self.numbers_of(leg, q))?;
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
    fn dips(&self, watch: &OnLeg, motion: &Trajectory, q: &[f64]) -> Result<Vec<Touch>, Failure> {
        let leg = watch.leg;
        let field = Residual::<f64>::on_segment(self, leg, q);
        let (duration, unit) =
            (self.duration_in(leg, q), time_scale(self.system(), self.split(q).0));
        let mut found = self.extrema_on(watch, motion, duration, q)?;
        if !self.smooth() {
            // What is as near to an event as that is one with it.
            let apart = |since: f64| since.min(duration - since) > VANISHES * unit;
            found.retain(|(since, _)| apart(*since));
        }
        let touch = |(since, value): (f64, f64)| {
            let x = motion.states_at(&field, since, q)?;
            Ok(Touch { leg, guard: watch.guard, since, value, x })
        };
        found.into_iter().map(touch).collect()
    }

    /// The extrema of a guard on a leg: times since its beginning, and values.
    fn extrema_on(
        &self,
        watch: &OnLeg,
        motion: &Trajectory,
        duration: f64,
        q: &[f64],
    ) -> Result<Vec<(f64, f64)>, Failure> {
        let field = Residual::<f64>::on_segment(self, watch.leg, q);
        let (mut flow, mut extrema) = (Flow::<f64>::default(), Extrema::default());
        let mut search = |begin: f64, length: f64, states: &[f64], steps: usize| {
            let (mut found, mut left, mut x) = (Vec::new(), steps, states.to_vec());
            let outcome = flow.observe(&field, begin, length, &mut x, q, |step| {
                extrema.search(watch, step, |extremum| {
                    found.push((begin + extremum.place * length, extremum.value));
                });
                left -= 1;
                if left == 0 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
            });
            outcome.map(|_| found)
        };
        let ends = || motion.nodes().skip(1).map(|(time, _)| time).chain([duration]);
        let mut all = Vec::<(f64, f64)>::new();
        for ((begin, states), end) in motion.nodes().zip(ends()) {
            all.extend(search(begin, end - begin, states, usize::MAX)?);
        }
        if let (true, Some(end)) = (self.smooth(), ends().next()) {
            // The end is the beginning, where there may be an extremum, too.
            let again = search(0.0, end, motion.start(), 1)?;
            let near = VANISHES * duration;
            let known = |since: f64| {
                let same = |(other, _): &(f64, f64)| {
                    let apart = (since - other).abs();
                    apart.min(duration - apart) <= near
                };
                all.iter().any(same)
            };
            let new: Vec<_> = again.into_iter().filter(|(since, _)| !known(*since)).collect();
            all.splice(0..0, new);
        }
        Ok(all)
    }

    /// A touch as an event: what follows is decided at a small approach speed.
    fn passed(&self, touch: &Touch, q: &[f64]) -> Result<Passed, Failure> {
        let (system, mode, guard) = (self.system(), self.legs()[touch.leg].mode, touch.guard);
        let p = self.split(q).0;
        let t = self.time(touch.leg, q) + touch.since;
        let at = Moment { system, mode, t, x: &touch.x, p };
        let scale = guard_scale(system, (guard, mode), (t, &touch.x), p);
        let speed = NUDGE * scale / time_scale(system, p);
        let near = self.nudged(guard, at, |at| at.rate(guard), -speed);
        let onset = Onset { guard, mode, next: None, at: (t, touch.x.clone()), near };
        let [following, _] = self.following(onset, mode, p)?;
        self.unmoved((mode, guard), [&touch.x, &following.state], p)?;
        let Touch { leg, since, value, .. } = *touch;
        Ok(Passed { leg, guard, since, distance: value.abs(), following })
    }

    /// Refuses an event without a speed that moves motion elsewhere: orbits with the event lie apart from those without.
    pub(in crate::core) fn unmoved(
        &self,
        (mode, guard): (usize, usize),
        [before, after]: [&[f64]; 2],
        p: &[f64],
    ) -> Result<(), Failure> {
        let Some(i) = self.moved_state(mode, [before, after], p) else { return Ok(()) };
        Err(Failure::Undetermined(format!(
            "at the touch the event {} takes {} from {:.6e} to {:.6e}: orbits with the event and orbits without it do not \
             meet where its reset jumps; start a branch of them from a simulated cycle (`orbit::from_cycle`)",
            self.guards[guard].name, self.modes[mode].states[i], before[i], after[i]
        )))
    }

    /// A state of a mode by which a touch moves motion, if there is one.
    fn moved_state(&self, mode: usize, [before, after]: [&[f64]; 2], p: &[f64]) -> Option<usize> {
        let mut sizes = self.system().scales_of(mode, p);
        sizes.resize(after.len(), 1.0);
        let moved = |i: &usize| {
            let (before, after) = (before[*i], after[*i]);
            (after - before).abs() > UNMOVED * sizes[*i].max(before.abs())
        };
        (0..after.len()).find(moved)
    }

    /// An event a little sooner than a touch, on the same motion, if motion goes on behind what follows as if nothing had
    /// happened: the branch leaves in this direction then, in which the equations are singular. So it is where motion
    /// touches what only stops it, and where it slides to the end of what holds it. `None` where an event changes motion, as
    /// impacts do.
    fn passed_sooner(
        &self,
        touch: &Touch,
        passed: &Passed,
        known: &[Trajectory],
        q: &[f64],
    ) -> Option<Passed> {
        if passed.following.legs.is_empty() {
            return None;
        }
        let unit = time_scale(self.system(), self.split(q).0);
        let [(near, error), (_, less)] = [SOONER, SOONER / NEARER]
            .map(|sooner| self.sooner(touch, sooner * unit, &known[touch.leg], q))
            .into_iter()
            .collect::<Option<Vec<_>>>()?
            .try_into()
            .ok()?;
        let same = near.following.itinerary().eq(passed.following.itinerary());
        // What an event changes grows like the time, what is left out of it like its square.
        let second_order = less <= error * 2.0 / (NEARER * NEARER) + ROUNDING;
        (same && second_order).then_some(near)
    }

    /// The event that comes so long before a touch, and how far from the motion that touches it ends, in units of the scales.
    fn sooner(
        &self,
        touch: &Touch,
        sooner: f64,
        motion: &Trajectory,
        q: &[f64],
    ) -> Option<(Passed, f64)> {
        let (system, p) = (self.system(), self.split(q).0);
        let (mode, guard) = (self.legs()[touch.leg].mode, touch.guard);
        let (numbers, begins) = (self.numbers_of(touch.leg, q), self.time(touch.leg, q));
        let field = Residual::<f64>::on_segment(self, touch.leg, &numbers);
        let at = |since: f64| motion.states_at(&field, since, &numbers).ok();
        let since = Some(touch.since - sooner).filter(|since| *since > 0.0)?;
        let (t, x) = (begins + since, at(since)?);
        let place = (t, self.onto(guard, Moment { system, mode, t, x: &x, p }));
        let onset = Onset { guard, mode, next: None, at: place.clone(), near: place };
        let [_, following] = self.following(onset, mode, p).ok()?;
        let distance = touch.value.abs();
        let passed = Passed { leg: touch.leg, guard, since, distance, following };
        let meant =
            at(passed.resumed()).filter(|_| passed.resumed() < self.duration_of(touch.leg, q))?;
        let mut sizes = system.scales_of(mode, p);
        sizes.resize(meant.len(), 1.0);
        let state = &passed.following.state;
        let differences =
            state.iter().zip(&meant).zip(&sizes).map(|((a, b), size)| (a - b).abs() / size);
        let error = differences.fold(0.0, f64::max);
        Some((passed, error))
    }
}
