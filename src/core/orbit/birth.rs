//! Impacting orbits born at grazings.
//!
//! Where an orbit touches a guard it passes no event yet; a moment later there is one, which begins
//! and ends a leg, with legs between that last no time: an impact of no speed, a slip of no length.
//! With those legs inserted the grazing orbit is a regular point of a branch of orbits that have
//! the event.

use super::departed::{VANISHES, join};
use super::following::{Following, Lasting, NUDGE, Onset};
use super::hybrid::HybridOrbit;
use super::itinerary::{Itinerary, Leg};
use super::known::KnownOrbit;
use crate::core::bvp::{Guess, Residual, Watched, Watching};
use crate::core::condition::Failure;
use crate::core::flow::{Extrema, Flow};
use crate::core::hybrid::{Moment, time_scale};
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

/// How much sooner than a touch an event comes that shows in which direction a branch leaves, in
/// units of the scale of time.
const SOONER: f64 = 1e-3;
/// By how much sooner another one comes, of which the error is smaller by the square of this.
const NEARER: f64 = 4.0;
/// Resets at a touch that move the state no farther, in units of its scales, leave it where it was.
const UNMOVED: f64 = 1e-6;
/// Of more touches only the first ones are passed by some branches and not by others.
const MOST_TOUCHES: usize = 8;
/// Errors of states, in units of their scales, that are rounding.
const ROUNDING: f64 = 1e-11;

/// The touches that the branch numbered `which` passes, of `count`: branch 0 passes all, the next
/// ones pass one each, then two each, and so on.
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

impl KnownOrbit<'_> {
    /// The orbits that are born where this one touches guards: first those that pass all of them,
    /// then those that pass some, in the order of [`selection`]. They begin after the nearest
    /// touch.
    pub fn born(&self, which: usize) -> Result<Guess<HybridOrbit>, Failure> {
        let (mut touches, mut passed) = self.touched()?;
        let mut selected = selection(touches.len(), which)?.into_iter();
        (touches, passed) =
            touches.into_iter().zip(passed).filter(|_| selected.next() == Some(true)).unzip();
        let pairs = touches.iter().zip(&passed);
        let sooner = pairs.map(|(touch, passed)| self.passed_sooner(touch, passed));
        let sooner: Option<Vec<Passed>> = sooner.collect();
        let birth = self.with_passed(passed);
        let beside = sooner.map(|passed| self.with_passed(passed));
        let beside = beside.map(|beside| (beside.trajectories, beside.extras));
        Ok(Guess { beside, ..birth })
    }

    /// The orbits that pass all touches, without a neighbour.
    pub(super) fn with_touches(&self) -> Result<Guess<HybridOrbit>, Failure> {
        Ok(self.with_passed(self.touched()?.1))
    }

    /// Where the orbit touches guards, and these touches as events.
    fn touched(&self) -> Result<(Vec<Touch>, Vec<Passed>), Failure> {
        let touches = self.touches()?;
        let passed = touches.iter().map(|touch| self.passed(touch)).collect::<Result<_, _>>()?;
        Ok((touches, passed))
    }

    /// This orbit with the legs of what it passes, of which there is one at least.
    fn with_passed(&self, passed: Vec<Passed>) -> Guess<HybridOrbit> {
        let legs = self.legs();
        let nearest = passed.iter().map(|it| it.distance).fold(f64::INFINITY, f64::min);
        let (mut all, mut first, mut begins) = (Vec::<Lasting>::new(), None, 0.0);
        for (leg, motion) in self.known.iter().enumerate() {
            let (mut begin, mut since) = (motion.start().to_vec(), 0.0);
            for it in passed.iter().filter(|it| it.leg == leg) {
                let part = motion.part(begin, since..it.since);
                all.push((Leg { exit: Some(it.guard), ..legs[leg] }, part, it.since - since));
                if first.is_none() && it.distance <= nearest {
                    (first, begins) = (Some(all.len()), self.begins(leg) + it.since);
                }
                all.extend(it.following.legs.iter().cloned());
                (begin, since) = (it.following.state.clone(), it.resumed());
            }
            let end = self.duration_of(leg);
            all.push((legs[leg], motion.part(begin, since..end), end - since));
        }
        let first = first.unwrap_or_default();
        all.rotate_left(first);
        if self.smooth() {
            // The start is no event: what goes on there is one leg.
            let joint = all.len() - first;
            let next = all.remove(joint);
            join(&mut all[joint - 1], next);
        }
        self.with_legs(all, begins)
    }

    /// How long a leg lasts.
    fn duration_of(&self, leg: usize) -> f64 {
        match self.smooth() {
            true => self.duration_in(leg, self.q),
            false => self.lengths()[leg],
        }
    }

    /// Where the orbit touches guards that it does not pass, in order; where it touches none, the
    /// place where it comes nearest to one.
    pub(super) fn touches(&self) -> Result<Vec<Touch>, Failure> {
        let mut found: Vec<(Touch, f64)> = Vec::new();
        for leg in (0..self.legs().len()).filter(|leg| !self.legs()[*leg].accumulates) {
            let mode = self.legs()[leg].mode;
            let (system, t, x) = (self.system(), self.begins(leg), self.known[leg].start());
            let begin = Moment { system, mode, t, x, p: self.p() };
            for guard in self.guards_in(mode) {
                let scale = begin.scale(guard);
                let dips = self.dips(leg, guard, scale)?;
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

    /// The local minima of a guard of some scale on a leg, with the states there.
    fn dips(&self, leg: usize, guard: usize, scale: f64) -> Result<Vec<Touch>, Failure> {
        let duration = self.duration_of(leg);
        let watched = Watched::function(leg, guard);
        let watch = Watching { problem: self.problem, watched, scale };
        let mut found = self.extrema_on(leg, &watch, duration)?;
        if !self.smooth() {
            // What is as near to an event as that is one with it.
            let unit = time_scale(self.system(), self.p());
            found.retain(|(since, _)| since.min(duration - since) > VANISHES * unit);
        }
        let touch = |(since, value): (f64, f64)| {
            Ok(Touch { leg, guard, since, value, x: self.state_on(leg, since)? })
        };
        found.into_iter().map(touch).collect()
    }

    /// The extrema of a guard on a leg: times since its beginning, and values.
    fn extrema_on(
        &self,
        leg: usize,
        watch: &Watching,
        duration: f64,
    ) -> Result<Vec<(f64, f64)>, Failure> {
        let (motion, q) = (&self.known[leg], &self.numbers_of(leg, self.q)[..]);
        let field = Residual::<f64>::on_segment(self.problem, leg, q);
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
    fn passed(&self, touch: &Touch) -> Result<Passed, Failure> {
        let Touch { leg, guard, since, value, ref x } = *touch;
        let (system, mode, p) = (self.system(), self.legs()[leg].mode, self.p());
        let at = Moment { system, mode, t: self.begins(leg) + since, x, p };
        let speed = NUDGE * at.usual_rate(guard);
        let near = self.nudged(guard, at, |at| at.rate(guard), -speed);
        let onset = Onset { guard, mode, next: None, at: (at.t, x.clone()), near };
        let [following, _] = self.following(onset, mode, p)?;
        self.unmoved((mode, guard), [x, &following.state], p)?;
        Ok(Passed { leg, guard, since, distance: value.abs(), following })
    }

    /// An event a little sooner than a touch, on the same motion, if motion goes on behind what
    /// follows as if nothing had happened: the branch leaves in this direction then, in which the
    /// equations are singular. So it is where motion touches what only stops it, and where it
    /// slides to the end of what holds it. `None` where an event changes motion, as impacts do.
    fn passed_sooner(&self, touch: &Touch, passed: &Passed) -> Option<Passed> {
        if passed.following.legs.is_empty() {
            return None;
        }
        let unit = time_scale(self.system(), self.p());
        let (near, error) = self.sooner(touch, SOONER * unit)?;
        let (_, less) = self.sooner(touch, SOONER / NEARER * unit)?;
        let same = near.following.itinerary().eq(passed.following.itinerary());
        // What an event changes grows like the time, what is left out of it like its square.
        let second_order = less <= error * 2.0 / (NEARER * NEARER) + ROUNDING;
        (same && second_order).then_some(near)
    }

    /// The event that comes so long before a touch, and how far from the motion that touches it
    /// ends, in units of the scales.
    fn sooner(&self, touch: &Touch, sooner: f64) -> Option<(Passed, f64)> {
        let Touch { leg, guard, .. } = *touch;
        let (system, p, mode) = (self.system(), self.p(), self.legs()[leg].mode);
        let since = Some(touch.since - sooner).filter(|since| *since > 0.0)?;
        let (t, x) = (self.begins(leg) + since, self.state_on(leg, since).ok()?);
        let place = (t, self.onto(guard, Moment { system, mode, t, x: &x, p }));
        let onset = Onset { guard, mode, next: None, at: place.clone(), near: place };
        let [_, following] = self.following(onset, mode, p).ok()?;
        let passed = Passed { leg, guard, since, distance: touch.value.abs(), following };
        let resumed = Some(passed.resumed()).filter(|since| *since < self.duration_of(leg))?;
        let meant = self.state_on(leg, resumed).ok()?;
        let differences = passed.following.state.iter().zip(&meant).zip(system.sizes_of(mode, p));
        let error = differences.map(|((a, b), size)| (a - b).abs() / size).fold(0.0, f64::max);
        Some((passed, error))
    }
}

impl HybridOrbit {
    /// Orbits with these legs, the first of which begins at a time.
    pub(super) fn with_legs(&self, all: Vec<Lasting>, begins: f64) -> Guess<Self> {
        // The time of the start comes first where it is an unknown.
        let mut extras: Vec<f64> = self.forced.then_some(begins).into_iter().collect();
        let (mut legs, mut trajectories) = (Vec::new(), Vec::new());
        for (leg, motion, duration) in all {
            legs.push(leg);
            trajectories.push(motion);
            extras.push(duration);
        }
        let problem = self.like(Itinerary { legs, periods: self.itinerary.periods });
        Guess { problem, trajectories, extras, beside: None }
    }

    /// Refuses an event without a speed that moves motion elsewhere: orbits with the event lie
    /// apart from those without.
    pub(in crate::core) fn unmoved(
        &self,
        (mode, guard): (usize, usize),
        [before, after]: [&[f64]; 2],
        p: &[f64],
    ) -> Result<(), Failure> {
        let Some(i) = self.moved_state(mode, [before, after], UNMOVED, p) else { return Ok(()) };
        Err(Failure::Undetermined(format!(
            "at the touch the event {} takes {} from {:.6e} to {:.6e}: orbits with the event and orbits without it do not \
             meet where its reset jumps; start a branch of them from a simulated cycle (`orbit::from_cycle`)",
            self.guards[guard].name, self.modes[mode].states[i], before[i], after[i]
        )))
    }

    /// A state of a mode that moves by more than a part of its size, if there is one.
    pub(super) fn moved_state(
        &self,
        mode: usize,
        [before, after]: [&[f64]; 2],
        part: f64,
        p: &[f64],
    ) -> Option<usize> {
        let states = before.iter().zip(after).zip(self.system().sizes_of(mode, p));
        let moves = |(before, after): (&f64, &f64), size: f64| {
            (after - before).abs() > part * size.max(before.abs())
        };
        states.into_iter().position(|(pair, size)| moves(pair, size))
    }
}
