//! Switching at a decision: where a decision function vanishes, which selects the mode after an
//! event, orbits emanate that go on in another mode.

use super::event_cascade::{Following, NUDGE, Onset, moved_state, nudged};
use super::itinerary::Leg;
use super::known_orbit::{KnownOrbit, Lasting, VANISHES};
use super::legs::OrbitLegs;
use crate::core::bvp::Guess;
use crate::core::failure::Failure;
use crate::core::hybrid::{HybridEquations, MeasureNumber, Moment, decision_scale};

/// H: motion through another mode leads to the state in which the next leg begins, up to this part
/// of the scales: otherwise no branch emanates.
const CONTINUOUS: f64 = 1e-4;

/// What selects the mode after an event, seen from an itinerary.
pub(super) struct Decision {
    guard: usize,
    mode: usize,
    /// The modes that may follow.
    modes: Vec<usize>,
    /// The one that does.
    next: usize,
}

/// The decision at the end of a leg, if there is one.
pub(super) fn decision_after(legs: &OrbitLegs, leg: usize) -> Option<Decision> {
    let Leg { mode, exit: Some(guard), accumulates: false } = legs.all()[leg] else {
        return None;
    };
    let (modes, next) = (legs.system.may_follow(guard, mode), legs.mode_after(leg));
    let first = *modes.first()?;
    let several = modes.iter().any(|mode| *mode != first);
    several.then_some(Decision { guard, mode, modes, next })
}

/// The decisions at the ends of all legs: where events may be followed by one of several modes, as
/// decision functions select them.
pub(super) fn decisions(legs: &OrbitLegs) -> impl Iterator<Item = Decision> + '_ {
    (0..legs.all().len()).filter_map(|leg| decision_after(legs, leg))
}

impl Decision {
    /// How clearly the event leads to the mode that the itinerary says: positive if it does. `None`
    /// if it never does.
    pub(super) fn margin<T: MeasureNumber>(&self, at: Moment<T>) -> Option<T> {
        let Decision { modes, next, .. } = self;
        let least = |a: T, b: T| if b.real() < a.real() { b } else { a };
        let (mut before, mut margin) = (T::from(f64::INFINITY), None::<T>);
        for (k, follows) in modes.iter().enumerate() {
            let last = k + 1 == modes.len();
            let value = if last { T::from(f64::INFINITY) } else { self.value(k, at) };
            if follows == next {
                let this = least(before, value);
                margin = Some(margin.map_or(this, |other| -least(-other, -this)));
            }
            before = least(before, -value);
        }
        margin
    }

    /// The function at a position.
    fn value<T: MeasureNumber>(&self, k: usize, at: Moment<T>) -> T {
        at.system.decision(k, self.guard, self.mode, at.t, at.x, at.p)
    }

    /// Where functions vanish and select another mode on the other side: the first function, that
    /// mode, and on which side of zero the function is there. `None` where they do not.
    fn otherwise(&self, at: Moment<f64>) -> Option<(usize, usize, f64)> {
        let Decision { modes, next: chosen, .. } = self;
        let vanishing =
            |k: usize| self.value(k, at).abs() < VANISHES * self.scale(k, at.system, at.p);
        // A function that vanishes is negative there if a later mode follows, positive if its own
        // one does.
        let functions = modes.len() - 1;
        let own = modes.iter().position(|mode| mode == chosen).unwrap_or(functions);
        let k = (0..functions.min(own + 1)).find(|k| vanishing(*k))?;
        let positive = |j: usize| if vanishing(j) { j != own } else { self.value(j, at) > 0.0 };
        let next = modes[(0..functions).find(|j| positive(*j)).unwrap_or(functions)];
        (next != *chosen).then_some((k, next, if k == own { -1.0 } else { 1.0 }))
    }

    /// The scale of the function at a position.
    fn scale(&self, k: usize, system: &dyn HybridEquations, p: &[f64]) -> f64 {
        decision_scale(system, (k, self.guard, self.mode), p)
    }

    /// The least scale of the functions.
    pub(super) fn least_scale(&self, system: &dyn HybridEquations, p: &[f64]) -> f64 {
        let scales = (0..self.modes.len() - 1).map(|k| self.scale(k, system, p));
        scales.fold(f64::INFINITY, f64::min)
    }
}

/// The orbits on the other side of the decisions that vanish on this one, all at a time: with the
/// legs of no length to which their events lead there. `None` where no decision vanishes.
pub(super) fn decided_otherwise(orbit: &KnownOrbit) -> Result<Option<Guess<OrbitLegs>>, Failure> {
    if decisions(orbit.legs).next().is_none() {
        return Ok(None);
    }
    let (mut all, mut near) = (Vec::<Lasting>::new(), Vec::<Lasting>::new());
    let (mut changed, mut singular) = (false, false);
    for leg in 0..orbit.known.len() {
        let own = orbit.lasting(leg);
        let end = orbit.begins(leg) + own.2;
        all.push(own.clone());
        near.push(own);
        if let Some([there, beside]) = inserted_after(orbit, leg)? {
            changed = true;
            singular |= there.iter().any(|leg| slow(orbit, leg, end));
            all.extend(there);
            near.extend(beside);
        }
    }
    if !changed {
        return Ok(None);
    }
    let guess = orbit.with_legs(all, orbit.begins(0));
    // A leg that begins where its event has no speed may last no time in any orbit: its direction
    // is known.
    let beside = singular.then(|| orbit.with_legs(near, orbit.begins(0)));
    let beside = beside.map(|near| (near.trajectories, near.extras));
    Ok(Some(Guess { beside, ..guess }))
}

/// Whether the event of a leg of no length has no speed at a time.
fn slow(orbit: &KnownOrbit, (leg, motion, _): &Lasting, t: f64) -> bool {
    let (system, x, p) = (orbit.system(), motion.start(), orbit.p());
    let at = Moment { system, mode: leg.mode, t, x, p };
    leg.exit.is_some_and(|guard| !at.has_speed(guard))
}

/// The legs of no length after a leg where its decision vanishes and is made otherwise, and those
/// beside; `None` where it does not vanish.
fn inserted_after(orbit: &KnownOrbit, leg: usize) -> Result<Option<[Vec<Lasting>; 2]>, Failure> {
    let Some(decision) = decision_after(orbit.legs, leg) else { return Ok(None) };
    let (t, x) = orbit.end_of(leg)?;
    let (at, guard) = (orbit.moment(leg, t, &x), decision.guard);
    let Some((k, next, way)) = decision.otherwise(at) else { return Ok(None) };
    let change = way * NUDGE * decision.scale(k, at.system, at.p);
    let near = nudged(guard, at, |at| decision.value(k, at), change);
    let onset = Onset { guard, mode: at.mode, next: Some(next), at: (t, x.clone()), near };
    let [Following { legs, state }, beside] =
        onset.following(orbit.legs, decision.next, orbit.p())?;
    check_continuous(orbit, (leg, next), &state)?;
    Ok(Some([legs, beside.legs]))
}

/// Refuses another mode after a leg from which motion comes to another state than the next leg's.
fn check_continuous(
    orbit: &KnownOrbit,
    (leg, other): (usize, usize),
    state: &[f64],
) -> Result<(), Failure> {
    let mode = orbit.legs.mode_after(leg);
    let known = orbit.known[(leg + 1) % orbit.known.len()].start();
    let moved = moved_state(orbit.system(), mode, [known, state], CONTINUOUS, orbit.p());
    let Some(k) = moved else { return Ok(()) };
    let (modes, names) = (&orbit.legs.modes, &orbit.legs.modes[mode].states);
    Err(Failure::Undetermined(format!(
        "decided otherwise, leg {leg} leads by way of `{}` to `{}` with {} = {:.6e} in place of {:.6e}: no branch is \
         near; start it from a simulated cycle (`orbit::from_cycle`)",
        modes[other].name, modes[mode].name, names[k], state[k], known[k]
    )))
}
