//! Branch switching at a decision: if a decision function, which selects the mode after an event,
//! vanishes on an orbit, branches of orbits emanate that continue in another mode.

use super::event_cascade::{Following, NUDGE, Onset, moved_state, nudged};
use super::itinerary::Leg;
use super::known_orbit::{KnownOrbit, Lasting, VANISHES};
use super::legs::OrbitLegs;
use crate::core::bvp::Guess;
use crate::core::failure::Failure;
use crate::core::hybrid::{HybridEquations, MeasureNumber, Moment, decision_scale};

/// Heuristic: a branch emanates at a decision if motion through the other mode leads to a state
/// within this distance of the start of the next leg (the part of the orbit after the event), as a
/// fraction of the scales.
const CONTINUOUS: f64 = 1e-4;

/// A decision at the end of a leg: the functions that select the mode after the event.
pub(super) struct Decision {
    guard: usize,
    mode: usize,
    /// The modes that can follow the event.
    modes: Vec<usize>,
    /// The mode that follows the event in the itinerary of the orbit.
    next: usize,
}

/// Returns the decision at the event that ends a leg (a part of an orbit between two events), or
/// `None` if only one mode can follow this event.
pub(super) fn decision_after(legs: &OrbitLegs, leg: usize) -> Option<Decision> {
    let Leg { mode, exit: Some(guard), accumulates: false } = legs.all()[leg] else {
        return None;
    };
    let (modes, next) = (legs.system.may_follow(guard, mode), legs.mode_after(leg));
    let first = *modes.first()?;
    let several = modes.iter().any(|mode| *mode != first);
    several.then_some(Decision { guard, mode, modes, next })
}

/// Returns the decisions on an orbit, that is, the events after which decision functions select one
/// of several modes.
pub(super) fn decisions(legs: &OrbitLegs) -> impl Iterator<Item = Decision> + '_ {
    (0..legs.all().len()).filter_map(|leg| decision_after(legs, leg))
}

impl Decision {
    /// Returns the margin of the decision: a number that is positive if the event leads to the mode
    /// of the itinerary, and zero where the event starts to lead to another mode. Returns `None` if
    /// the event can never lead to the mode of the itinerary.
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

    /// Evaluates decision function number `k`, counted from 0.
    fn value<T: MeasureNumber>(&self, k: usize, at: Moment<T>) -> T {
        at.system.decision(k, self.guard, self.mode, at.t, at.x, at.p)
    }

    /// Returns the first vanishing function whose sign change selects another mode, together with
    /// this mode and the sign that the function must have to select it; `None` if no such function
    /// vanishes.
    fn otherwise(&self, at: Moment<f64>) -> Option<(usize, usize, f64)> {
        let Decision { modes, next: chosen, .. } = self;
        let vanishing =
            |k: usize| self.value(k, at).abs() < VANISHES * self.scale(k, at.system, at.p);
        // On the other side, a vanishing function is negative if a later mode follows, and positive
        // if its own mode follows.
        let functions = modes.len() - 1;
        let own = modes.iter().position(|mode| mode == chosen).unwrap_or(functions);
        let k = (0..functions.min(own + 1)).find(|k| vanishing(*k))?;
        let positive = |j: usize| if vanishing(j) { j != own } else { self.value(j, at) > 0.0 };
        let next = modes[(0..functions).find(|j| positive(*j)).unwrap_or(functions)];
        (next != *chosen).then_some((k, next, if k == own { -1.0 } else { 1.0 }))
    }

    /// Returns the scale of the `k`-th decision function.
    fn scale(&self, k: usize, system: &dyn HybridEquations, p: &[f64]) -> f64 {
        decision_scale(system, (k, self.guard, self.mode), p)
    }

    /// Returns the smallest scale of the decision functions.
    pub(super) fn least_scale(&self, system: &dyn HybridEquations, p: &[f64]) -> f64 {
        let scales = (0..self.modes.len() - 1).map(|k| self.scale(k, system, p));
        scales.fold(f64::INFINITY, f64::min)
    }
}

/// Returns the orbits on which all vanishing decision functions have the opposite sign, with the
/// zero-length legs to which the affected events then lead. Returns `None` if no decision function
/// vanishes.
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
    // A leg that begins at a zero-speed event may have zero length on every orbit: `beside` gives
    // the direction.
    let beside = singular.then(|| orbit.with_legs(near, orbit.begins(0)));
    let beside = beside.map(|near| (near.trajectories, near.extras));
    Ok(Some(Guess { beside, ..guess }))
}

/// Whether the guard whose event ends a given zero-length leg (part of the orbit) has zero rate of
/// change at time `t`.
fn slow(orbit: &KnownOrbit, (leg, motion, _): &Lasting, t: f64) -> bool {
    let (system, x, p) = (orbit.system(), motion.start(), orbit.p());
    let at = Moment { system, mode: leg.mode, t, x, p };
    leg.exit.is_some_and(|guard| !at.has_speed(guard))
}

/// Returns the zero-length legs to insert after a leg whose decision function vanishes, computed at
/// the event and at a nearby event; `None` if the decision function does not vanish.
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

/// Returns an error if motion through another mode after a leg leads to a state that differs from
/// the start of the next leg.
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
        "on the other side of the decision, leg {leg} leads through `{}` to `{}` with {} = {:.6e} \
         instead of {:.6e}: no branch of nearby orbits exists; start the branch from a simulated cycle \
         (`start: Simulated()`, in Rust `orbit::from_cycle`)",
        modes[other].name, modes[mode].name, names[k], state[k], known[k]
    )))
}
