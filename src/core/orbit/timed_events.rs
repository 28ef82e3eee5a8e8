//! Timed events, which occur at given times, on orbits: a leg (a part of an orbit between two
//! events) must not pass a timed event of its mode without ending, but other events may be
//! simultaneous with timed events.

use super::itinerary::Leg;
use super::known_orbit::{KnownOrbit, VANISHES};
use super::legs::OrbitLegs;
use crate::core::bvp::Ends;
use crate::core::failure::Failure;
use crate::core::hybrid::{EventNumber, Moment, time_scale};

/// Returns the shortest of these times, over all legs (parts of the orbit): from a timed event
/// before a leg to the start of the leg, and from the end of a leg to the next timed event. The
/// result is negative if the leg passes a timed event, and infinite if all legs last from one timed
/// event to the next.
pub(super) fn spacing<T: EventNumber>(legs: &OrbitLegs, ends: Ends<T>, q: &[T]) -> T {
    let least = |a: T, b: T| if b.real() < a.real() { b } else { a };
    let (count, layout) = (legs.all().len(), &legs.layout);
    let of_leg = |(s, leg): (usize, &Leg)| {
        let entry = legs.all()[(s + count - 1) % count].exit;
        let (x, p) = (&ends.start[layout.states(s)], layout.p(q));
        let (begin, duration) = (layout.time(s, q), layout.durations(q)[s]);
        let (mode, exit) = (leg.mode, leg.exit);
        legs.timed_in(mode).flat_map(move |guard| {
            let interval = legs.interval(guard, p);
            let middle = begin + duration * 0.5;
            let left = Moment { system: legs.system(), mode, t: middle, x, p }.guard(guard);
            let next = if left.real() > 0.0 { left } else { left + interval };
            // The last event before the middle of the leg, and the next event.
            let spaces = [interval - next - duration * 0.5, next - duration * 0.5];
            let own = [entry == Some(guard), exit == Some(guard)];
            let others = spaces
                .into_iter()
                .zip(own)
                .filter(move |(space, own)| !own || space.real().abs() > 0.5 * interval.real());
            others.map(|(space, _)| space)
        })
    };
    let legs = legs.all().iter().enumerate().filter(|(_, leg)| !leg.accumulates);
    legs.flat_map(of_leg).fold(T::from(f64::INFINITY), least)
}

/// Returns an error for orbits without events in a mode with timed events, and for legs that pass a
/// timed event.
///
/// # Errors
/// [`Failure::Mismatch`] with the names of the mode and the event.
pub(super) fn check_timed(legs: &OrbitLegs, ends: Ends<f64>, q: &[f64]) -> Result<(), Failure> {
    for leg in legs.all().iter().filter(|leg| leg.exit.is_none()) {
        if let Some(guard) = legs.timed_in(leg.mode).next() {
            let (mode, event) = (&legs.modes[leg.mode].name, &legs.guards[guard].name);
            return Err(Failure::Mismatch(format!(
                "the itinerary `{mode}` has no event, but the event `{event}` occurs at given \
                 times in this mode: write the itinerary with its events, as in `{mode}:{event}`, \
                 or start from a simulation"
            )));
        }
    }
    let least = if legs.layout.smooth { f64::INFINITY } else { spacing(legs, ends, q) };
    if least >= -VANISHES * time_scale(legs.system(), legs.layout.p(q)) {
        return Ok(());
    }
    Err(Failure::Mismatch(format!(
        "a leg continues for {:.3e} after an event at a given time: write an itinerary with all events, or let a \
         simulation find it",
        -least
    )))
}

/// Whether the mode of a leg has a timed event that does not end the leg.
pub(super) fn has_spaces(legs: &OrbitLegs) -> bool {
    let count = legs.all().len();
    !legs.layout.smooth
        && (0..count).any(|s| {
            let (entry, Leg { mode, exit, .. }) =
                (legs.all()[(s + count - 1) % count].exit, legs.all()[s]);
            legs.timed_in(mode).any(|guard| entry != Some(guard) || exit != Some(guard))
        })
}

impl OrbitLegs {
    /// Returns the time between two successive events of a guard with timed events.
    pub fn interval<T: EventNumber>(&self, guard: usize, p: &[T]) -> T {
        self.system.period(p) / self.guards[guard].per_period as f64
    }
}

impl KnownOrbit<'_> {
    /// Whether a leg (part of an orbit) is ended by one event, but another event, a timed event of
    /// the mode of the leg or of the next mode, occurs simultaneously.
    pub(super) fn collides(&self, leg: usize) -> bool {
        let (legs, end) = (self.legs, self.begins(leg) + self.length(leg));
        let (exit, unit) = (legs.all()[leg].exit, time_scale(self.system(), self.p()));
        let comes = |leg: usize| {
            let at = self.moment(leg, end, self.known[leg].start());
            let mut timed = legs.timed_in(at.mode).filter(|guard| exit != Some(*guard));
            timed.any(|guard| at.guard(guard).abs() <= VANISHES * unit)
        };
        comes(leg) || comes((leg + 1) % legs.all().len())
    }
}
