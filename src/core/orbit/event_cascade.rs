//! Event cascades: the zero-length legs that follow an event until motion resumes in a given mode.

use super::itinerary::Leg;
use super::known_orbit::Lasting;
use super::legs::OrbitLegs;
use crate::core::failure::Failure;
use crate::core::hybrid::{HybridEquations, Moment, time_scale};
use crate::core::linalg::dot;
use crate::core::problem::gradient;
use crate::core::scalar::Chunk;
use num_dual::{Dual, Dual64};

/// Heuristic: the subsequent events are determined at a nearby point, at which a guard's rate or a
/// decision function differs from zero by this amount, in units of its scale.
pub(super) const NUDGE: f64 = 1e-6;
/// Heuristic: in an event cascade, the next event counts as immediate if it occurs within this
/// time, in units of the time scale.
const AT_ONCE: f64 = 1e-2;
/// Heuristic: a guard or its rate counts as zero if its magnitude, in units of its scale, is below
/// this value.
const ZERO: f64 = 1e-9;
/// Heuristic: a function varies along a guard's surface if more than this fraction of the
/// function's gradient is tangent to the surface.
const ACROSS: f64 = 1e-6;
/// Heuristic: a reset at a grazing point counts as continuous if it changes no state by more than
/// this, in units of the scales.
pub(super) const UNMOVED: f64 = 1e-6;
/// Heuristic: the maximal number of events in a cascade.
const MOST_LEGS: usize = 32;

/// An event after which the sequence of further events depends on rounding errors, and a nearby
/// event after which this sequence is well determined.
pub(super) struct Onset {
    pub guard: usize,
    pub mode: usize,
    /// The mode after the event, if known; if it is unknown, the system determines the mode at the
    /// nearby event.
    pub next: Option<usize>,
    /// The time and state at the event.
    pub at: (f64, Vec<f64>),
    /// The time and state at the nearby event.
    pub near: (f64, Vec<f64>),
}

/// The zero-length legs (parts of an orbit between two events) that follow an event, and the state
/// from which motion then resumes in a mode.
pub(super) struct Following {
    pub legs: Vec<Lasting>,
    pub state: Vec<f64>,
}

impl Following {
    /// Returns the modes and events of the zero-length legs.
    pub(super) fn itinerary(&self) -> impl Iterator<Item = Leg> + '_ {
        self.legs.iter().map(|(leg, ..)| *leg)
    }
}

impl Onset {
    /// Computes two event cascades, one after the event and one after the nearby event; each
    /// cascade lasts until motion resumes in the mode `until`. The order of the events is
    /// determined at the nearby event.
    pub(super) fn following(
        self,
        orbits: &OrbitLegs,
        until: usize,
        p: &[f64],
    ) -> Result<[Following; 2], Failure> {
        let name = orbits.guards[self.guard].name.clone();
        self.following_until(orbits, |mode, _| mode == until, p).ok_or_else(|| {
            Failure::Undetermined(format!(
                "after the event `{name}`, the motion does not return to mode `{}` immediately: \
                 start the branch from a simulated cycle (`start: Simulated()`, in Rust `orbit::from_cycle`)",
                orbits.modes[until].name
            ))
        })
    }

    /// Computes two event cascades, one after the event and one after the nearby event; each
    /// cascade lasts until motion reaches a required mode and state. Returns `None` if motion does
    /// not reach this mode and state.
    pub(super) fn following_until(
        self,
        orbits: &OrbitLegs,
        arrives: impl Fn(usize, &[f64]) -> bool,
        p: &[f64],
    ) -> Option<[Following; 2]> {
        let Onset { mut guard, mode: mut last, mut next, at: (t, mut limit), near } = self;
        let ((mut time, mut near), system) = (near, orbits.system());
        let [mut there, mut beside] = [Vec::<Lasting>::new(), Vec::new()];
        // An event at a given time occurs only once.
        let mut come = vec![guard];
        loop {
            let decided = || system.next_mode(guard, last, time, &near, p);
            let mode = next.take().unwrap_or_else(decided);
            let reset = |t: f64, x: &[f64]| {
                let mut after = vec![0.0; orbits.modes[mode].states.len()];
                system.reset(guard, (last, mode), t, x, p, &mut after);
                after
            };
            (limit, near) = (reset(t, &limit), reset(time, &near));
            if arrives(mode, &limit) {
                let [there, beside] = [(there, limit), (beside, near)];
                return Some([there, beside].map(|(legs, state)| Following { legs, state }));
            }
            if there.len() == MOST_LEGS {
                return None;
            }
            let (duration, exit) =
                soonest(orbits, Moment { system, mode, t: time, x: &near, p }, &come)?;
            let leg = Leg::new(mode, Some(exit));
            there.push((leg, limit.clone().into(), 0.0));
            beside.push((leg, near.clone().into(), duration));
            near = moved(Moment { system, mode, t: time, x: &near, p }, duration);
            time += duration;
            (guard, last) = (exit, mode);
            come.push(guard);
        }
    }
}

/// Returns the state after a short time, computed by the midpoint rule.
fn moved(Moment { system, mode, t, x, p }: Moment<f64>, duration: f64) -> Vec<f64> {
    let mut f = vec![0.0; x.len()];
    let step = |f: &[f64], h: f64| x.iter().zip(f).map(|(x, f)| x + h * f).collect::<Vec<_>>();
    system.field(mode, t, x, p, &mut f);
    let middle = step(&f, 0.5 * duration);
    system.field(mode, t + 0.5 * duration, &middle, p, &mut f);
    step(&f, duration)
}

/// Returns the guard of a mode that falls to zero first, if it does so almost immediately, and the
/// time until then. Timed events (events at given times) of the guards in the list `come` have
/// already occurred and are excluded.
fn soonest(orbits: &OrbitLegs, at: Moment<f64>, come: &[usize]) -> Option<(f64, usize)> {
    let unit = time_scale(at.system, at.p);
    let falling = orbits.vanishing_in(at.mode).filter_map(|guard| {
        let zero = ZERO * at.scale(guard);
        Some((falls(course(at, guard), [zero, zero / unit])?, guard))
    });
    let timed = orbits.timed_in(at.mode).filter(|guard| !come.contains(guard));
    let timed = timed.map(|guard| (at.guard(guard), guard));
    let timed = timed.filter(|(left, _)| *left >= -ZERO * unit).map(|(t, g)| (t.max(0.0), g));
    let soon = falling.chain(timed).filter(|(time, _)| *time <= AT_ONCE * unit);
    soon.min_by(|a, b| a.0.total_cmp(&b.0))
}

/// Projects a state onto a guard's surface, to first order. The state is displaced, in units of the
/// scales, along the directions that the event's reset preserves (for example at the end of
/// sliding), or along the gradient of the guard if the reset does not preserve any direction.
pub(super) fn onto(guard: usize, at: Moment<f64>) -> Vec<f64> {
    let Moment { system, mode, t, x, p } = at;
    let sizes = system.sizes_of(mode, p);
    let (mut normal, _) = gradient((t, x), p, |t, x, p| system.guard(guard, mode, t, x, p));
    normal.iter_mut().zip(&sizes).for_each(|(slope, size)| *slope *= size);
    let next = system.next_mode(guard, mode, t, x, p);
    let kept = match system.states_of(next) == system.states_of(mode) {
        true => {
            let steps = normal.iter().zip(&sizes).map(|(slope, size)| slope * size);
            let x: Vec<_> = x.iter().zip(steps).map(|(x, step)| Dual64::new(*x, step)).collect();
            let p: Vec<_> = p.iter().map(|p| Dual64::from(*p)).collect();
            let mut after = vec![Dual64::from(0.0); x.len()];
            system.reset(guard, (mode, next), t.into(), &x, &p, &mut after);
            after.iter().zip(&sizes).map(|(after, size)| after.eps / size).collect()
        }
        false => Vec::new(),
    };
    let whole = dot(&normal, &normal);
    let way = if dot(&normal, &kept) > ACROSS * whole { &kept } else { &normal };
    let part = at.guard(guard) / dot(&normal, way).max(f64::MIN_POSITIVE);
    x.iter().zip(way.iter().zip(&sizes)).map(|(x, (n, size))| x - part * n * size).collect()
}

/// Returns a time and state near an event, still on the guard's surface, at which a function is
/// larger by `change`. The displacement follows the gradient of the function with respect to the
/// states, without the component of the gradient that is normal to the guard's surface. If the
/// function does not vary with the states along the surface, the gradient with respect to states
/// and time is used. Returns the event itself if the function varies neither with the states nor
/// with time along the surface.
pub(super) fn nudged(
    guard: usize,
    at: Moment<f64>,
    function: impl Fn(Moment<Dual64>) -> Dual64,
    change: f64,
) -> (f64, Vec<f64>) {
    let Moment { system, mode, t, x, p } = at;
    let n = x.len();
    let mut sizes = system.sizes_of(mode, p);
    sizes.push(time_scale(system, p));
    let by = |value: &dyn Fn(Moment<Dual64>) -> Dual64| -> Vec<f64> {
        let at = |t, x: &[_], p: &[_]| value(Moment { system, mode, t, x, p });
        let (by_states, by_time) = gradient((t, x), p, at);
        let slopes = by_states.into_iter().chain([by_time]).zip(&sizes);
        slopes.map(|(slope, size)| slope * size).collect()
    };
    let (normal, slope) = (by(&|at| at.guard(guard)), by(&function));
    let across = |m: usize| {
        let (normal, mut slope) = (&normal[..m], slope[..m].to_vec());
        let share = dot(&slope, normal) / dot(normal, normal).max(f64::MIN_POSITIVE);
        slope.iter_mut().zip(normal).for_each(|(s, n)| *s -= share * n);
        slope
    };
    let whole = dot(&slope, &slope);
    let changes = |slope: &Vec<f64>| dot(slope, slope) > ACROSS * ACROSS * whole;
    let Some(slope) = [n, n + 1].map(across).into_iter().find(changes) else {
        return (t, x.to_vec());
    };
    let size = dot(&slope, &slope);
    let steps = slope.iter().zip(&sizes).map(|(slope, unit)| change * slope * unit / size);
    let mut moved: Vec<f64> = x.iter().chain([&t]).zip(steps).map(|(x, step)| x + step).collect();
    let time = moved.split_off(n);
    (time.first().copied().unwrap_or(t), moved)
}

/// Returns an error if the reset of an event with zero approach speed changes the state: orbits
/// with the event are then not close to orbits without it.
pub(in crate::core) fn check_unmoved(
    orbits: &OrbitLegs,
    (mode, guard): (usize, usize),
    [before, after]: [&[f64]; 2],
    p: &[f64],
) -> Result<(), Failure> {
    let moved = moved_state(orbits.system(), mode, [before, after], UNMOVED, p);
    let Some(i) = moved else { return Ok(()) };
    Err(Failure::Undetermined(format!(
        "at the grazing point, the reset of the event {} changes {} from {:.6e} to {:.6e}, so \
         orbits with the event are not close to orbits without the event; start a branch of orbits \
         with the event from a simulated cycle (`start: Simulated()`, in Rust `orbit::from_cycle`)",
        orbits.guards[guard].name, orbits.modes[mode].states[i], before[i], after[i]
    )))
}

/// Returns the index of the first state of a mode that changes by more than a fraction of its size,
/// or `None`.
pub(super) fn moved_state(
    system: &dyn HybridEquations,
    mode: usize,
    [before, after]: [&[f64]; 2],
    part: f64,
    p: &[f64],
) -> Option<usize> {
    let states = before.iter().zip(after).zip(system.sizes_of(mode, p));
    let moves = |(before, after): (&f64, &f64), size: f64| {
        (after - before).abs() > part * size.max(before.abs())
    };
    states.into_iter().position(|(pair, size)| moves(pair, size))
}

/// Returns the value of a guard along the motion, with its first three time derivatives.
fn course(at: Moment<f64>, guard: usize) -> [f64; 4] {
    let Moment { system, mode, t, x, p } = at;
    let moving = |value: f64, rate: f64| {
        let mut number = Chunk::from(value);
        number.eps[0] = rate;
        number
    };
    let mut f = vec![0.0; x.len()];
    system.field(mode, t, x, p, &mut f);
    let x: Vec<Chunk> = x.iter().zip(&f).map(|(x, f)| moving(*x, *f)).collect();
    let p: Vec<Chunk> = p.iter().map(|p| Chunk::from(*p)).collect();
    let later = Moment { system, mode, t: moving(t, 1.0), x: &x, p: &p };
    let rate: Dual<Chunk> = later.along(|later| later.rate(guard));
    [at.guard(guard), rate.re.re, rate.eps.re, rate.eps.eps[0]]
}

/// Returns the first time at which a non-negative function crosses zero downwards, given its value
/// and derivatives; the time is 0 if the function is already zero, within the tolerance `zero`, and
/// decreases.
fn falls([value, rate, second, third]: [f64; 4], zero: [f64; 2]) -> Option<f64> {
    // A zero at the current time is divided out.
    match value.abs() <= zero[0] {
        true if rate < -zero[1] => Some(0.0),
        true => falling_root([rate.max(0.0), second / 2.0, third / 6.0]),
        false => falling_root([value.max(0.0), rate, second / 2.0]),
    }
}

/// Returns the first positive root of a quadratic polynomial at which the polynomial decreases; its
/// constant coefficient must not be negative.
fn falling_root([c, b, a]: [f64; 3]) -> Option<f64> {
    let root = (b * b - 4.0 * a * c).sqrt();
    let time = if b < 0.0 { 2.0 * c / (root - b) } else { (b + root) / (-2.0 * a) };
    Some(time).filter(|time| time.is_finite() && *time >= 0.0)
}
