//! Orbits without the legs that last no time where a branch ends, and without the event that is
//! only a touch there: the continuation beyond a grazing at which these vanish.

use super::following::Lasting;
use super::hybrid::HybridOrbit;
use super::itinerary::{Itinerary, Leg};
use super::known::KnownOrbit;
use crate::core::bvp::{Guess, Trajectory};
use crate::core::condition::Failure;
use crate::core::hybrid::{Moment, time_scale};

/// An event that is approached more slowly is a touch, and a leg that is shorter lasts no time: in
/// units of the scales.
pub(super) const VANISHES: f64 = 1e-6;

impl KnownOrbit<'_> {
    /// The orbits without the legs, or the events, that vanish here.
    pub(super) fn without(&self) -> Result<Option<Guess<HybridOrbit>>, Failure> {
        match self.without_vanished()? {
            None if !self.smooth() => self.without_touches(),
            found => Ok(found),
        }
    }

    /// The orbits without the events that are only touches here, after which motion goes on in the
    /// same mode and as before: each joins the legs before and behind it. `None` where there are
    /// none.
    fn without_touches(&self) -> Result<Option<Guess<HybridOrbit>>, Failure> {
        let legs = self.legs();
        let behind = (0..legs.len()).map(|leg| self.behind_touch(leg));
        let behind = behind.collect::<Result<Vec<Option<usize>>, _>>()?;
        let Some(first) = behind.iter().copied().find_map(|next| next) else { return Ok(None) };
        // From the leg behind a touch on, to the one that leads to it.
        let (mut all, mut follows, mut leg) = (Vec::<Lasting>::new(), false, first);
        loop {
            let own = (legs[leg], self.known[leg].clone(), self.lengths()[leg]);
            match all.last_mut().filter(|_| follows) {
                Some(last) => join(last, own),
                None => all.push(own),
            }
            follows = behind[leg].is_some();
            leg = behind[leg].unwrap_or((leg + 1) % legs.len());
            if leg == first {
                break;
            }
        }
        if all.len() == 1 {
            return self.without_events(first, all.swap_remove(0)).map(Some);
        }
        // The last leg goes on as the first.
        let ended = all.remove(0);
        let begins = self.begins(first) + ended.2;
        if let Some(last) = all.last_mut() {
            join(last, ended);
        }
        Ok(Some(self.with_legs(all, begins)))
    }

    /// Orbits without events, from a motion of one period that begins as a leg does.
    fn without_events(
        &self,
        first: usize,
        (leg, motion, duration): Lasting,
    ) -> Result<Guess<HybridOrbit>, Failure> {
        let problem = self.like(Itinerary::smooth(leg.mode, self.itinerary.periods));
        if !self.forced {
            let (trajectories, extras) = (vec![motion], vec![duration]);
            return Ok(Guess { problem, trajectories, extras, beside: None });
        }
        // They begin at time 0, or a whole number of periods later.
        let wait = (-self.begins(first)).rem_euclid(self.system.period(self.p()));
        let start = self.on_motion(first, &motion, wait)?;
        let mut trajectory = motion.part(start, wait..duration);
        trajectory.join(duration - wait, &motion.part(motion.start().to_vec(), 0.0..wait));
        Ok(Guess { problem, trajectories: vec![trajectory], extras: Vec::new(), beside: None })
    }

    /// The leg behind a touch that ends this one, the legs of no length that follow it left out;
    /// `None` if its end is none, or leads to another mode.
    ///
    /// # Errors
    /// [`Failure::Undetermined`] if its reset jumps.
    fn behind_touch(&self, leg: usize) -> Result<Option<usize>, Failure> {
        let Leg { mode, exit: Some(guard), accumulates: false } = self.legs()[leg] else {
            return Ok(None);
        };
        if !self.lasts(leg) {
            return Ok(None);
        }
        let (t, x) = self.end_of(leg)?;
        if (Moment { system: self.system(), mode, t, x: &x, p: self.p() }).has_speed(guard) {
            return Ok(None);
        }
        let count = self.legs().len();
        let next = (1..=count).map(|k| (leg + k) % count).find(|leg| self.lasts(*leg));
        let next = next.filter(|next| self.legs()[*next].mode == mode);
        if let Some(next) = next {
            self.unmoved((mode, guard), [&x, self.known[next].start()], self.p())?;
        }
        Ok(next)
    }

    /// Whether a leg lasts longer than no time.
    pub(in crate::core) fn lasts(&self, leg: usize) -> bool {
        self.lengths()[leg].abs() > VANISHES * time_scale(self.system(), self.p())
    }

    /// The orbits without the legs that last no time here: the events before them lead to the legs
    /// behind them. `None` where there are no such legs, where they belong to an event without a
    /// speed, which vanishes with them, and where no event leads past them.
    fn without_vanished(&self) -> Result<Option<Guess<HybridOrbit>>, Failure> {
        let legs = self.legs();
        if self.smooth() {
            return Ok(None);
        }
        let kept: Vec<usize> = (0..legs.len()).filter(|leg| self.lasts(*leg)).collect();
        if kept.is_empty() || kept.len() == legs.len() {
            return Ok(None);
        }
        for (k, &leg) in kept.iter().enumerate() {
            let next = kept[(k + 1) % kept.len()];
            if next != (leg + 1) % legs.len() && !self.leads_past(leg, next)? {
                return Ok(None);
            }
        }
        let own = |&leg: &usize| (legs[leg], self.known[leg].clone(), self.lengths()[leg]);
        Ok(Some(self.with_legs(kept.iter().map(own).collect(), self.begins(kept[0]))))
    }

    /// Whether the event that ends a leg has a speed, and a reset to the mode of a later one.
    fn leads_past(&self, leg: usize, next: usize) -> Result<bool, Failure> {
        let (p, system) = (self.p(), self.system());
        let Leg { mode, exit: Some(guard), accumulates: false } = self.legs()[leg] else {
            return Ok(false);
        };
        let (t, x) = self.end_of(leg)?;
        let mode_after = self.legs()[next].mode;
        let mut after = vec![0.0; self.modes[mode_after].states.len()];
        system.reset(guard, (mode, mode_after), t, &x, p, &mut after);
        let fast = Moment { system, mode, t, x: &x, p }.has_speed(guard);
        Ok(fast && after.iter().all(|x| x.is_finite()))
    }
}

impl Moment<'_, f64> {
    /// Whether a guard is passed with a speed.
    pub(in crate::core) fn has_speed(self, guard: usize) -> bool {
        self.rate(guard).abs() > VANISHES * self.usual_rate(guard)
    }
}

/// Lets a leg go on as another one does, to the end of that.
pub(super) fn join(last: &mut Lasting, (leg, motion, duration): (Leg, Trajectory, f64)) {
    last.1.join(last.2, &motion);
    (last.0, last.2) = (leg, last.2 + duration);
}
