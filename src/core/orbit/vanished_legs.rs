//! Branch switching at vanishing legs (parts of an orbit between two events), to the orbits without
//! the legs that have zero length at a grazing, and without the events that are only tangential at
//! the grazing.

use super::event_cascade::{Following, NUDGE, Onset, UNMOVED, check_unmoved, moved_state, nudged};
use super::itinerary::{Itinerary, Leg};
use super::known_orbit::{KnownOrbit, Lasting, VANISHES};
use super::legs::OrbitLegs;
use crate::core::bvp::{Guess, Trajectory};
use crate::core::failure::Failure;
use crate::core::hybrid::{Moment, time_scale};

/// Returns the orbits that lack the legs (parts between two events) or the events that vanish on
/// the given orbit.
pub(super) fn without(orbit: &KnownOrbit) -> Result<Option<Guess<OrbitLegs>>, Failure> {
    if orbit.legs.layout.smooth {
        return Ok(None);
    }
    match without_vanished(orbit)? {
        None => without_touches(orbit),
        found => Ok(found),
    }
}

/// Returns the orbits without the events at which motion only grazes a guard's surface and
/// continues unchanged in the same mode; the legs before and after each grazing point are joined.
/// Returns `None` if the orbit has no such event.
fn without_touches(orbit: &KnownOrbit) -> Result<Option<Guess<OrbitLegs>>, Failure> {
    let count = orbit.legs.all().len();
    let behind = (0..count).map(|leg| behind_touch(orbit, leg));
    let behind = behind.collect::<Result<Vec<Option<usize>>, _>>()?;
    let Some(first) = behind.iter().copied().find_map(|next| next) else { return Ok(None) };
    // Starts at the leg after a grazing point, and ends at the leg that leads to the grazing point.
    let (mut all, mut follows, mut leg) = (Vec::<Lasting>::new(), false, first);
    loop {
        let own = orbit.lasting(leg);
        match all.last_mut().filter(|_| follows) {
            Some(last) => join(last, own),
            None => all.push(own),
        }
        follows = behind[leg].is_some();
        leg = behind[leg].unwrap_or((leg + 1) % count);
        if leg == first {
            break;
        }
    }
    if all.len() == 1 {
        return without_events(orbit, first, all.swap_remove(0)).map(Some);
    }
    // The last leg continues as the first leg.
    let ended = all.remove(0);
    let begins = orbit.begins(first) + ended.2;
    if let Some(last) = all.last_mut() {
        join(last, ended);
    }
    Ok(Some(orbit.with_legs(all, begins)))
}

/// Heuristic: the time after the grazing point, as a fraction of the period, at which the segment
/// of an autonomous orbit without events starts. With this fraction, the grazing point, the motion
/// just before it, and the motion half a period later are inside the segment.
const BEHIND: f64 = 0.38;

/// Returns orbits without events, given a motion of one period that begins with a specified leg.
fn without_events(
    orbit: &KnownOrbit,
    first: usize,
    (leg, motion, duration): Lasting,
) -> Result<Guess<OrbitLegs>, Failure> {
    let problem = orbit.legs.like(Itinerary::smooth(leg.mode, orbit.legs.itinerary.periods));
    // Under forcing, these orbits start at time 0, or a whole number of periods later.
    let (wait, extras) = match orbit.legs.layout.forced {
        true => ((-orbit.begins(first)).rem_euclid(orbit.system().period(orbit.p())), Vec::new()),
        false => (BEHIND * duration, vec![duration]),
    };
    let start = orbit.on_motion(first, &motion, wait)?;
    let mut trajectory = motion.part(start, wait..duration);
    trajectory.join(duration - wait, &motion.part(motion.start().to_vec(), 0.0..wait));
    Ok(Guess { problem, trajectories: vec![trajectory], extras, beside: None })
}

/// Returns the first leg of positive length after the grazing point at which the given leg ends;
/// `None` if the given leg does not end at a grazing point, or if the returned leg would be in
/// another mode.
///
/// # Errors
/// [`Failure::Undetermined`] if the reset at the grazing point is discontinuous.
fn behind_touch(orbit: &KnownOrbit, leg: usize) -> Result<Option<usize>, Failure> {
    let legs = orbit.legs.all();
    let Leg { mode, exit: Some(guard), accumulates: false } = legs[leg] else {
        return Ok(None);
    };
    if !orbit.lasts(leg) {
        return Ok(None);
    }
    let (t, x) = orbit.end_of(leg)?;
    if orbit.moment(leg, t, &x).has_speed(guard) {
        return Ok(None);
    }
    let mut behind = (1..=legs.len()).map(|k| (leg + k) % legs.len());
    let mut waited = 0.0;
    let next = behind.find(|leg| {
        let lasts = orbit.lasts(*leg);
        waited += if lasts { 0.0 } else { orbit.length(*leg) };
        lasts
    });
    let next = next.filter(|next| legs[*next].mode == mode);
    if let Some(next) = next {
        // Legs that count as having no length may last for a short time.
        let mut rates = vec![0.0; x.len()];
        orbit.system().field(mode, t, &x, orbit.p(), &mut rates);
        let expected: Vec<f64> = x.iter().zip(rates).map(|(x, rate)| x + waited * rate).collect();
        let states = [&expected[..], orbit.known[next].start()];
        check_unmoved(orbit.legs, (mode, guard), states, orbit.p())?;
    }
    Ok(next)
}

/// Returns the orbits without the zero-length legs (parts between two events) of the given orbit.
/// On the returned orbits, the events before the zero-length legs lead directly to the legs after
/// the zero-length legs; at a border collision, these events are replaced by the events that occur
/// first on the other side of the collision. Returns `None` if the orbit has neither zero-length
/// legs nor simultaneous events, or if no event leads past the zero-length legs (which can then
/// vanish with an event of zero approach speed).
fn without_vanished(orbit: &KnownOrbit) -> Result<Option<Guess<OrbitLegs>>, Failure> {
    let kept = kept(orbit);
    let Some(&Kept { leg: first, .. }) = kept.first() else { return Ok(None) };
    if !kept.iter().any(|it| it.changes) {
        return Ok(None);
    }
    let (mut all, mut another) = (Vec::new(), false);
    for Kept { leg, next, changes } in kept {
        let own = orbit.lasting(leg);
        another |= next != (leg + 1) % orbit.legs.all().len();
        if !changes {
            all.push(own);
        } else if let Some((guard, Following { legs, .. })) = exchanged(orbit, leg, next) {
            all.push((Leg { exit: Some(guard), ..own.0 }, own.1, own.2));
            all.extend(legs);
            another = true;
        } else if leads_past(orbit, leg, next) {
            all.push(own);
        } else {
            return Ok(None);
        }
    }
    if another {
        return Ok(Some(orbit.with_legs(all, orbit.begins(first))));
    }
    Err(Failure::Undetermined(
        "an event at a given time is simultaneous with another event, and their order determines \
         the state of the motion after the two events: the orbits on the two sides of this point \
         are not connected; start the branch on the other side from a simulated cycle \
         (`start: Simulated()`, in Rust `orbit::from_cycle`)"
            .into(),
    ))
}

/// Whether the grazing is a border collision, at which two events exchange their order and the leg
/// between these events vanishes.
pub(super) fn is_border_collision(orbit: &KnownOrbit) -> bool {
    let mut changed = kept(orbit).into_iter().filter(|it| it.changes);
    changed.any(|it| exchanged(orbit, it.leg, it.next).is_some())
}

/// A leg of positive length that is kept in the new orbit.
struct Kept {
    leg: usize,
    /// The index of the next leg of positive length.
    next: usize,
    /// Whether zero-length legs lie between this leg and the next leg of positive length, or a
    /// timed event is simultaneous with the event that ends this leg.
    changes: bool,
}

/// Returns the legs of positive length of an orbit.
fn kept(orbit: &KnownOrbit) -> Vec<Kept> {
    let count = orbit.legs.all().len();
    let legs: Vec<usize> = (0..count).filter(|leg| orbit.lasts(*leg)).collect();
    let pairs = legs.iter().zip(legs.iter().cycle().skip(1));
    let pair = |(&leg, &next): (&usize, &usize)| {
        let changes = next != (leg + 1) % count || orbit.collides(leg);
        Kept { leg, next, changes }
    };
    pairs.map(pair).collect()
}

/// Returns the event that is simultaneous with the end of a leg, comes first on the other side of
/// the border collision, and leads to the start of a later leg: its guard, and the zero-length legs
/// from the event to the later leg. Returns `None` if no event exchanges its order with the end of
/// the leg.
fn exchanged(orbit: &KnownOrbit, leg: usize, next: usize) -> Option<(usize, Following)> {
    let all = orbit.legs.all();
    let Leg { mode, exit: Some(own), accumulates: false } = all[leg] else { return None };
    let (t, x) = orbit.end_of(leg).ok()?;
    let (at, p) = (orbit.moment(leg, t, &x), orbit.p());
    let (until, begins) = (orbit.legs.mode(next), orbit.known[next].start());
    let unit = time_scale(orbit.system(), p);
    let comes = |guard: usize| match orbit.legs.guards[guard].is_timed() {
        true => at.guard(guard).abs() <= VANISHES * unit,
        false => at.guard(guard).abs() <= VANISHES * at.scale(guard) && at.has_speed(guard),
    };
    let mut others = orbit.legs.guards_in(mode).filter(|guard| *guard != own && comes(*guard));
    others.find_map(|guard| {
        let before = NUDGE * at.scale(own);
        let near = nudged(guard, at, |at| at.guard(own), before);
        let onset = Onset { guard, mode, next: None, at: (t, x.clone()), near };
        let arrives = |mode: usize, state: &[f64]| {
            mode == until && moved_state(at.system, mode, [begins, state], UNMOVED, p).is_none()
        };
        let [following, _] = onset.following_until(orbit.legs, arrives, p)?;
        Some((guard, following))
    })
}

/// Whether the event that ends a leg has a nonzero approach speed and leads directly to the start
/// of a later leg.
fn leads_past(orbit: &KnownOrbit, leg: usize, next: usize) -> bool {
    let Leg { mode, exit: Some(guard), accumulates: false } = orbit.legs.all()[leg] else {
        return false;
    };
    let Ok((t, x)) = orbit.end_of(leg) else { return false };
    let (system, p, mode_after) = (orbit.system(), orbit.p(), orbit.legs.mode(next));
    if !orbit.moment(leg, t, &x).has_speed(guard) {
        return false;
    }
    let mut after = vec![0.0; orbit.legs.modes[mode_after].states.len()];
    system.reset(guard, (mode, mode_after), t, &x, p, &mut after);
    let states = [orbit.known[next].start(), &after[..]];
    let finite = after.iter().all(|x| x.is_finite());
    finite && moved_state(system, mode_after, states, UNMOVED, p).is_none()
}

impl Moment<'_, f64> {
    /// Whether a guard vanishes with a nonzero rate of change.
    pub(in crate::core) fn has_speed(self, guard: usize) -> bool {
        self.rate(guard).abs() > VANISHES * self.usual_rate(guard)
    }
}

/// Extends a leg by the trajectory and duration of another leg.
pub(super) fn join(last: &mut Lasting, (leg, motion, duration): (Leg, Trajectory, f64)) {
    last.1.join(last.2, &motion);
    (last.0, last.2) = (leg, last.2 + duration);
}
