//! Orbits without the legs that last no time where a branch ends, and without the event that is only a touch there: the
//! continuation beyond a grazing at which these vanish.

use super::following::Lasting;
use super::hybrid::HybridOrbit;
use super::itinerary::{Itinerary, Leg};
use crate::core::bvp::{Birth, Residual, Trajectory};
use crate::core::condition::Failure;
use crate::core::hybrid::{Moment, guard_scale, time_scale};

/// An event that is approached more slowly is a touch, and a leg that is shorter lasts no time: in units of the scales.
pub(in crate::core) const VANISHES: f64 = 1e-6;

impl HybridOrbit {
    /// The orbits without the legs, or the events, that vanish here.
    pub(super) fn without(
        &self,
        known: &[Trajectory],
        q: &[f64],
    ) -> Result<Option<Birth<Self>>, Failure> {
        match self.without_vanished(known, q)? {
            None if !self.smooth() => self.without_touches(known, q),
            found => Ok(found),
        }
    }

    /// The orbits without the events that are only touches here, after which motion goes on in the same mode and as before:
    /// each joins the legs before and behind it. `None` where there are none.
    fn without_touches(
        &self,
        known: &[Trajectory],
        q: &[f64],
    ) -> Result<Option<Birth<Self>>, Failure> {
        let (legs, durations) = (self.legs(), self.durations(self.split(q).1));
        let mut behind = Vec::with_capacity(legs.len());
        for leg in 0..legs.len() {
            behind.push(self.behind_touch(leg, known, q)?);
        }
        let Some(first) = behind.iter().copied().find_map(|next| next) else { return Ok(None) };
        // From the leg behind a touch on, to the one that leads to it.
        let (mut all, mut follows, mut leg) = (Vec::<Lasting>::new(), false, first);
        loop {
            match all.last_mut().filter(|_| follows) {
                Some(last) => joined_to(last, (legs[leg], &known[leg], durations[leg])),
                None => all.push((legs[leg], known[leg].clone(), durations[leg])),
            }
            follows = behind[leg].is_some();
            leg = behind[leg].unwrap_or((leg + 1) % legs.len());
            if leg == first {
                break;
            }
        }
        let begins = self.time(first, q);
        if all.len() == 1 {
            return self.without_events(first, all.swap_remove(0), q).map(Some);
        }
        // The last leg goes on as the first.
        let (end, motion, duration) = all.remove(0);
        if let Some(last) = all.last_mut() {
            joined_to(last, (end, &motion, duration));
        }
        Ok(Some(self.with_legs(all, begins + duration)))
    }

    /// Orbits without events, from a motion of one period that begins as a leg does.
    fn without_events(
        &self,
        first: usize,
        (leg, motion, duration): Lasting,
        q: &[f64],
    ) -> Result<Birth<Self>, Failure> {
        let problem = self.like(Itinerary::smooth(leg.mode, self.itinerary.periods));
        if !self.forced {
            let (trajectories, extras) = (vec![motion], vec![duration]);
            return Ok(Birth { problem, trajectories, extras, beside: None });
        }
        // They begin at time 0, or a whole number of periods later.
        let p = self.split(q).0;
        let wait = (-self.time(first, q)).rem_euclid(self.system.period(p));
        let numbers = self.numbers_of(first, q);
        let field = Residual::<f64>::on_segment(self, first, &numbers);
        let start = motion.states_at(&field, wait, &numbers)?;
        let mut trajectory = motion.part(start, wait..duration);
        trajectory.join(duration - wait, &motion.part(motion.start().to_vec(), 0.0..wait));
        Ok(Birth { problem, trajectories: vec![trajectory], extras: Vec::new(), beside: None })
    }

    /// The leg behind a touch that ends this one, the legs of no length that follow it left out; `None` if its end is none, or
    /// leads to another mode.
    ///
    /// # Errors
    /// [`Failure::Undetermined`] if its reset jumps.
    fn behind_touch(
        &self,
        leg: usize,
        known: &[Trajectory],
        q: &[f64],
    ) -> Result<Option<usize>, Failure> {
        let (legs, durations) = (self.legs(), self.durations(self.split(q).1));
        let least = VANISHES * time_scale(self.system(), self.split(q).0);
        let lasts = |leg: &usize| durations[*leg].abs() > least;
        let Leg { mode, exit: Some(guard), accumulates: false } = legs[leg] else {
            return Ok(None);
        };
        if !lasts(&leg) {
            return Ok(None);
        }
        let ((t, x), p) = (self.end_of(leg, known, q)?, self.split(q).0);
        if self.has_speed((leg, guard), (t, &x), p) {
            return Ok(None);
        }
        let mut later = (1..=legs.len()).map(|k| (leg + k) % legs.len());
        let next = later.find(lasts).filter(|next| legs[*next].mode == mode);
        if let Some(next) = next {
            self.unmoved((mode, guard), [&x, known[next].start()], p)?;
        }
        Ok(next)
    }

    /// Whether a guard is passed with a speed.
    fn has_speed(&self, (leg, guard): (usize, usize), (t, x): (f64, &[f64]), p: &[f64]) -> bool {
        let (system, mode) = (self.system(), self.legs()[leg].mode);
        let slow = VANISHES * guard_scale(system, (guard, mode), (t, x), p) / time_scale(system, p);
        Moment { system, mode, t, x, p }.rate(guard).abs() > slow
    }

    /// The orbits without the legs that last no time here: the events before them lead to the legs behind them.
    /// `None` where there are no such legs, where they belong to an event without a speed, which vanishes with them, and
    /// where no event leads past them.
    fn without_vanished(
        &self,
        known: &[Trajectory],
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
            if next != (leg + 1) % legs.len() && !self.leads_past(leg, next, known, q)? {
                return Ok(None);
            }
        }
        let itinerary = Itinerary {
            legs: kept.iter().map(|&leg| legs[leg]).collect(),
            periods: self.itinerary.periods,
        };
        let begins = self.forced.then(|| self.time(kept[0], q));
        let trajectories = kept.iter().map(|&leg| known[leg].clone()).collect();
        let extras = begins.into_iter().chain(kept.iter().map(|&leg| durations[leg])).collect();
        Ok(Some(Birth { problem: self.like(itinerary), trajectories, extras, beside: None }))
    }

    /// Time and state where a leg ends.
    pub(super) fn end_of(
        &self,
        leg: usize,
        known: &[Trajectory],
        q: &[f64],
    ) -> Result<(f64, Vec<f64>), Failure> {
        let duration = self.durations(self.split(q).1)[leg];
        Ok((self.time(leg, q) + duration, self.state_on(leg, duration, known, q)?))
    }

    /// The state at a time since the beginning of a leg.
    pub(in crate::core) fn state_on(
        &self,
        leg: usize,
        since: f64,
        known: &[Trajectory],
        q: &[f64],
    ) -> Result<Vec<f64>, Failure> {
        let numbers = self.numbers_of(leg, q);
        let field = Residual::<f64>::on_segment(self, leg, &numbers);
        Ok(known[leg].states_at(&field, since, &numbers)?)
    }

    /// Whether the event that ends a leg has a speed, and a reset to the mode of a later one.
    fn leads_past(
        &self,
        leg: usize,
        next: usize,
        known: &[Trajectory],
        q: &[f64],
    ) -> Result<bool, Failure> {
        let (p, system) = (self.split(q).0, self.system());
        let Leg { mode, exit: Some(guard), accumulates: false } = self.legs()[leg] else {
            return Ok(false);
        };
        let (t, x) = self.end_of(leg, known, q)?;
        let mode_after = self.legs()[next].mode;
        let mut after = vec![0.0; self.modes[mode_after].states.len()];
        system.reset(guard, (mode, mode_after), t, &x, p, &mut after);
        Ok(self.has_speed((leg, guard), (t, &x), p) && after.iter().all(|x| x.is_finite()))
    }
}

/// Lets a leg go on as another one does, to the end of that.
pub(super) fn joined_to(last: &mut Lasting, (leg, motion, duration): (Leg, &Trajectory, f64)) {
    last.1.join(last.2, motion);
    (last.0, last.2) = (leg, last.2 + duration);
}
