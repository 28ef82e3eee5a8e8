//! Decisions: what selects the mode after an event, and the orbits on the other side of where that
//! vanishes.

use super::departed::VANISHES;
use super::following::{Following, Lasting, NUDGE, Onset};
use super::hybrid::HybridOrbit;
use super::itinerary::Leg;
use super::known::KnownOrbit;
use crate::core::bvp::Guess;
use crate::core::condition::Failure;
use crate::core::hybrid::{MeasureNumber, Moment, decision_scale};

/// Orbits with a leg in another mode begin where the one without it goes on, but for this part of
/// the scales.
const CONTINUOUS: f64 = 1e-4;

/// What selects the mode after an event, seen from an itinerary.
struct Decision {
    guard: usize,
    mode: usize,
    /// The modes that may follow.
    modes: Vec<usize>,
}

impl HybridOrbit {
    /// The decision at the end of a leg, if there is one.
    fn decision_after(&self, leg: usize) -> Option<Decision> {
        let Leg { mode, exit: Some(guard), accumulates: false } = self.legs()[leg] else {
            return None;
        };
        let modes = self.system().may_follow(guard, mode);
        let first = *modes.first()?;
        modes.iter().any(|mode| *mode != first).then_some(Decision { guard, mode, modes })
    }

    /// Whether any event may be followed by one of several modes, as decision functions select
    /// them.
    pub(super) fn decides(&self) -> bool {
        (0..self.legs().len()).any(|leg| self.decision_after(leg).is_some())
    }

    /// The mode that follows a leg.
    pub(super) fn mode_after(&self, leg: usize) -> usize {
        self.legs()[(leg + 1) % self.legs().len()].mode
    }

    /// How clearly the event that ends a leg leads to the mode that the itinerary says: positive if
    /// it does. `None` where nothing is to decide.
    pub(super) fn margin<T: MeasureNumber>(&self, leg: usize, at: Moment<T>) -> Option<T> {
        let Decision { guard, mode, modes } = self.decision_after(leg)?;
        let (least, next) =
            (|a: T, b: T| if b.real() < a.real() { b } else { a }, self.mode_after(leg));
        let (mut before, mut margin) = (T::from(f64::INFINITY), None::<T>);
        for (k, follows) in modes.iter().enumerate() {
            let last = k + 1 == modes.len();
            let value = || at.system.decision(k, guard, mode, at.t, at.x, at.p);
            let value = if last { T::from(f64::INFINITY) } else { value() };
            if *follows == next {
                let this = least(before, value);
                margin = Some(margin.map_or(this, |other| -least(-other, -this)));
            }
            before = least(before, -value);
        }
        margin
    }

    /// The scale of the decisions at the ends of the legs: the least one.
    pub(super) fn scale_of_decisions(&self, p: &[f64]) -> f64 {
        let legs = (0..self.legs().len()).filter_map(|leg| self.decision_after(leg));
        let scales = legs.flat_map(|Decision { guard, mode, modes }| {
            let of = move |k| decision_scale(self.system(), (k, guard, mode), p);
            (0..modes.len() - 1).map(of)
        });
        scales.reduce(f64::min).unwrap_or(1.0)
    }
}

impl KnownOrbit<'_> {
    /// The orbits on the other side of the decisions that vanish here, all at a time: with the legs
    /// of no length to which their events lead there. `None` where no decision vanishes.
    pub(super) fn decided_otherwise(&self) -> Result<Option<Guess<HybridOrbit>>, Failure> {
        if !self.decides() {
            return Ok(None);
        }
        let (mut all, mut near) = (Vec::<Lasting>::new(), Vec::<Lasting>::new());
        let (mut changed, mut singular) = (false, false);
        for (leg, motion) in self.known.iter().enumerate() {
            let own = (self.legs()[leg], motion.clone(), self.lengths()[leg]);
            let end = self.begins(leg) + own.2;
            all.push(own.clone());
            near.push(own);
            if let Some([there, beside]) = self.inserted_after(leg)? {
                changed = true;
                singular |= self.any_slow(&there, end);
                all.extend(there);
                near.extend(beside);
            }
        }
        if !changed {
            return Ok(None);
        }
        let birth = self.with_legs(all, self.begins(0));
        // A leg that begins where its event has no speed may last no time in any orbit: its
        // direction is known.
        let beside = singular.then(|| self.with_legs(near, self.begins(0)));
        let beside = beside.map(|near| (near.trajectories, near.extras));
        Ok(Some(Guess { beside, ..birth }))
    }

    /// Whether the event of one of some legs of no length has no speed at a time.
    fn any_slow(&self, legs: &[Lasting], t: f64) -> bool {
        let (system, p) = (self.system(), self.p());
        legs.iter().any(|(Leg { mode, exit, .. }, motion, _)| {
            let at = Moment { system, mode: *mode, t, x: motion.start(), p };
            exit.is_some_and(|guard| !at.has_speed(guard))
        })
    }

    /// The legs of no length after a leg where its decision vanishes and is made otherwise, and
    /// those beside; `None` where it does not vanish.
    fn inserted_after(&self, leg: usize) -> Result<Option<[Vec<Lasting>; 2]>, Failure> {
        let Some(Decision { guard, mode, modes }) = self.decision_after(leg) else {
            return Ok(None);
        };
        let ((t, x), system, p) = (self.end_of(leg)?, self.system(), self.p());
        let at = Moment { system, mode, t, x: &x, p };
        let chosen = self.mode_after(leg);
        let vanishing = |k: usize| {
            let scale = decision_scale(system, (k, guard, mode), p);
            system.decision(k, guard, mode, t, &x, p).abs() < VANISHES * scale
        };
        // A function that vanishes is negative here if a later mode follows, positive if its own
        // one does.
        let functions = modes.len() - 1;
        let own = modes.iter().position(|mode| *mode == chosen).unwrap_or(functions);
        let Some(k) = (0..functions.min(own + 1)).find(|k| vanishing(*k)) else { return Ok(None) };
        let positive = |j: usize| match vanishing(j) {
            true => j != own,
            false => system.decision(j, guard, mode, t, &x, p) > 0.0,
        };
        let next = modes[(0..functions).find(|j| positive(*j)).unwrap_or(functions)];
        if next == chosen {
            return Ok(None);
        }
        let way = if k == own { -NUDGE } else { NUDGE };
        let change = way * decision_scale(system, (k, guard, mode), p);
        let function = |at: Moment<_>| at.system.decision(k, guard, mode, at.t, at.x, at.p);
        let near = self.nudged(guard, at, function, change);
        let onset = Onset { guard, mode, next: Some(next), at: (t, x.clone()), near };
        let [Following { legs, state }, beside] = self.following(onset, chosen, p)?;
        self.check_continuous((leg, next), &state)?;
        Ok(Some([legs, beside.legs]))
    }

    /// Refuses another mode after a leg from which motion comes to another state than the next
    /// leg's.
    fn check_continuous(&self, (leg, other): (usize, usize), state: &[f64]) -> Result<(), Failure> {
        let (mode, known) =
            (self.mode_after(leg), self.known[(leg + 1) % self.known.len()].start());
        let moved = self.moved_state(mode, [known, state], CONTINUOUS, self.p());
        let Some(k) = moved else { return Ok(()) };
        let (modes, names) = (&self.modes, &self.modes[mode].states);
        Err(Failure::Undetermined(format!(
            "decided otherwise, leg {leg} leads by way of `{}` to `{}` with {} = {:.6e} in place of {:.6e}: no branch is \
             near; start it from a simulated cycle (`orbit::from_cycle`)",
            modes[other].name, modes[mode].name, names[k], state[k], known[k]
        )))
    }
}
