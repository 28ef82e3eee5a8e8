//! Branch switching at a grazing point, to the branches of orbits that have the event of the grazed
//! guard.
//!
//! An orbit that touches a guard's surface has no event at the grazing point. Orbits that cross the
//! surface have an event, which ends a leg, and possibly further legs that have zero length at the
//! grazing point: for example, an impact with zero speed or a slip phase of zero length. With these
//! zero-length legs inserted, the grazing orbit is a regular point of the branch of orbits that
//! have the event.

use super::event_cascade::{Following, NUDGE, Onset, check_unmoved, nudged, onto};
use super::itinerary::Leg;
use super::known_orbit::{KnownOrbit, Lasting, VANISHES};
use super::legs::OrbitLegs;
use super::touch::{Touch, touches};
use super::vanished_legs::join;
use crate::core::bvp::{Guess, Trajectory};
use crate::core::failure::Failure;
use crate::core::hybrid::{Moment, time_scale};

/// A new event that is inserted in an orbit at a grazing point.
struct Passed {
    leg: usize,
    guard: usize,
    /// The time of the new event since the beginning of the leg.
    since: f64,
    /// The distance of the orbit from the guard's surface.
    distance: f64,
    following: Following,
}

impl Passed {
    /// Returns the time since the beginning of the interrupted leg at which the leg resumes after
    /// the new event.
    fn resumed(&self) -> f64 {
        self.since + self.following.legs.iter().map(|(.., duration)| duration).sum::<f64>()
    }
}

/// Heuristic: the time between the new event and the grazing point, in units of the time scale, if
/// the event is moved away from the grazing point to determine the direction of a branch.
const SOONER: f64 = 1e-3;
/// Heuristic: the error is computed for two events before the grazing point, and this is the ratio
/// of their distances in time from the grazing point; the error must decrease as the square of the
/// distance.
const NEARER: f64 = 4.0;
/// Heuristic: the largest number of simultaneous grazing points whose 2⁸ subsets define branches;
/// at further grazing points, only the orbits of branch 0 cross the surface.
const MOST_TOUCHES: usize = 8;
/// Rounding: the errors of states after an integrated motion, in units of the states' scales.
const ROUNDING: f64 = 1e-11;

/// Returns, for each of `count` grazing points, whether the orbits of the branch numbered `which`
/// cross the grazed surface at the point: on branch 0 at all points, on each of the next branches
/// at one point, then at two points, and so on.
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

/// Returns the orbits of a branch that emanates at grazing points: on branch 0, the orbits cross
/// the surfaces of all grazed guards, and on the further branches the surfaces of some of these
/// guards, in the order of [`selection`]. The orbits start after the grazing point that is closest
/// to its guard.
pub(in crate::core) fn emanating_at_touch(
    orbit: &KnownOrbit,
    which: usize,
) -> Result<Guess<OrbitLegs>, Failure> {
    let (mut touches, mut passed) = touched(orbit)?;
    let mut selected = selection(touches.len(), which)?.into_iter();
    (touches, passed) =
        touches.into_iter().zip(passed).filter(|_| selected.next() == Some(true)).unzip();
    let pairs = touches.iter().zip(&passed);
    let sooner: Option<Vec<Passed>> =
        pairs.map(|(touch, passed)| passed_sooner(orbit, touch, passed)).collect();
    let guess = with_passed(orbit, passed);
    let beside = sooner.map(|passed| with_passed(orbit, passed));
    let beside = beside.map(|beside| (beside.trajectories, beside.extras));
    Ok(Guess { beside, ..guess })
}

/// Returns the orbits that cross the surfaces of all grazed guards.
pub(super) fn with_touches(orbit: &KnownOrbit) -> Result<Guess<OrbitLegs>, Failure> {
    Ok(with_passed(orbit, touched(orbit)?.1))
}

/// Returns the grazing points of the orbit, and the new events at these points.
fn touched(orbit: &KnownOrbit) -> Result<(Vec<Touch>, Vec<Passed>), Failure> {
    let touches = touches(orbit)?;
    let passed = touches.iter().map(|touch| passed(orbit, touch)).collect::<Result<_, _>>()?;
    Ok((touches, passed))
}

/// Inserts the legs of one or more new events into an orbit.
fn with_passed(orbit: &KnownOrbit, passed: Vec<Passed>) -> Guess<OrbitLegs> {
    let nearest = passed.iter().map(|it| it.distance).fold(f64::INFINITY, f64::min);
    let (mut all, mut first, mut begins) = (Vec::<Lasting>::new(), None, 0.0);
    for (leg, motion) in orbit.known.iter().enumerate() {
        let (whole, mut begin, mut since) = (orbit.legs.all()[leg], motion.start().to_vec(), 0.0);
        for it in passed.iter().filter(|it| it.leg == leg) {
            let part = motion.part(begin, since..it.since);
            all.push((Leg { exit: Some(it.guard), ..whole }, part, it.since - since));
            if first.is_none() && it.distance <= nearest {
                (first, begins) = (Some(all.len()), orbit.begins(leg) + it.since);
            }
            all.extend(it.following.legs.iter().cloned());
            (begin, since) = (it.following.state.clone(), it.resumed());
        }
        let end = orbit.length(leg);
        all.push((whole, motion.part(begin, since..end), end - since));
    }
    let first = first.unwrap_or_default();
    all.rotate_left(first);
    if orbit.legs.layout.smooth {
        // The start is not an event: the two parts of the leg are joined.
        let joint = all.len() - first;
        let next = all.remove(joint);
        join(&mut all[joint - 1], next);
    }
    orbit.with_legs(all, begins)
}

/// Converts a grazing point to a new event on the orbit. The cascade of events that follows is
/// determined at a small approach speed.
fn passed(orbit: &KnownOrbit, touch: &Touch) -> Result<Passed, Failure> {
    let Touch { leg, guard, since, value, ref x } = *touch;
    let at = orbit.moment(leg, orbit.begins(leg) + since, x);
    let speed = NUDGE * at.usual_rate(guard);
    let near = nudged(guard, at, |at| at.rate(guard), -speed);
    let onset = Onset { guard, mode: at.mode, next: None, at: (at.t, x.clone()), near };
    let [following, _] = onset.following(orbit.legs, at.mode, at.p)?;
    check_unmoved(orbit.legs, (at.mode, guard), [x, &following.state], at.p)?;
    Ok(Passed { leg, guard, since, distance: value.abs(), following })
}

/// Returns the event that precedes a grazing point closely in the same motion, if this event, with
/// its cascade, leaves the motion unchanged. The branch then emanates in the direction that the
/// earlier event determines, since the equations are singular in this direction. The event leaves
/// the motion unchanged, for example, if motion grazes a surface that only stops it, or slides up
/// to the end of the sliding region. Returns `None` if the event changes the motion, as an impact
/// does.
fn passed_sooner(orbit: &KnownOrbit, touch: &Touch, passed: &Passed) -> Option<Passed> {
    if passed.following.legs.is_empty() {
        return None;
    }
    let unit = time_scale(orbit.system(), orbit.p());
    let (near, error) = sooner(orbit, touch, SOONER * unit)?;
    let (_, less) = sooner(orbit, touch, SOONER / NEARER * unit)?;
    let same = near.following.itinerary().eq(passed.following.itinerary());
    let at = orbit.moment(touch.leg, orbit.begins(touch.leg) + touch.since, &touch.x);
    let miss = apart(at, &onto(touch.guard, at), &touch.x);
    // A change by the event grows linearly with the time before the grazing point, the neglected
    // terms quadratically. The distance from the guard is a further error.
    let second_order =
        less <= error * 2.0 / (NEARER * NEARER) + ROUNDING + (2.0 * miss).min(VANISHES);
    (same && second_order).then_some(near)
}

/// Returns the event that precedes a grazing point by the time `sooner`, and the distance, in units
/// of the scales, between the end of the event's cascade and the grazing motion.
fn sooner(orbit: &KnownOrbit, touch: &Touch, sooner: f64) -> Option<(Passed, f64)> {
    let Touch { leg, guard, .. } = *touch;
    let since = Some(touch.since - sooner).filter(|since| *since > 0.0)?;
    let x = orbit.state_on(leg, since).ok()?;
    let at = orbit.moment(leg, orbit.begins(leg) + since, &x);
    let place = (at.t, onto(guard, at));
    let onset = Onset { guard, mode: at.mode, next: None, at: place.clone(), near: place };
    let [_, following] = onset.following(orbit.legs, at.mode, at.p).ok()?;
    let passed = Passed { leg, guard, since, distance: touch.value.abs(), following };
    let resumed = Some(passed.resumed()).filter(|since| *since < orbit.length(leg))?;
    // Later nodes may be displaced by the error of the mesh.
    let mut onward = Trajectory::from(orbit.known[leg].start().to_vec());
    onward.push(since, &x);
    let meant = orbit.on_motion(leg, &onward, resumed).ok()?;
    let error = apart(at, &passed.following.state, &meant);
    Some((passed, error))
}

/// Returns the distance between two states in the mode of a moment, in units of the scales.
fn apart(at: Moment<f64>, a: &[f64], b: &[f64]) -> f64 {
    let sizes = at.system.sizes_of(at.mode, at.p);
    let differences = a.iter().zip(b).zip(sizes);
    differences.map(|((a, b), size)| (a - b).abs() / size).fold(0.0, f64::max)
}
