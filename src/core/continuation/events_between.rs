//! The events between two points of a branch.

use super::admissible::{AT_LIMIT, stays_at_limit};
use super::bounds::{AT_START, Bounds};
use super::curve::Curve;
use super::curve_point::{CurvePoint, Interval};
use super::event::Event;
use super::located::Located;
use super::locator::Locator;
use super::log::Log;
use crate::core::bifurcation::{At, Critical};
use crate::core::problem::Dynamics;
use crate::core::system::Kind;

/// The properties of a curve's start that determine which events are found in the first step.
#[derive(Clone, Copy)]
pub(super) struct AtStart<'s> {
    /// Whether the curve starts at a branch point.
    pub from_branch_point: bool,
    /// The kinds of events that are reported at the start; events of other kinds at the start are
    /// not reported.
    pub reported: &'s [Kind],
}

/// Returns all events in an interval in their order along the branch. `at_start` is `None` if the
/// interval does not begin at the start of the curve.
pub(super) fn events_between(
    (curve, log, bounds): (&mut Curve, &mut Log, &Bounds),
    interval: Interval,
    backward: bool,
    at_start: Option<AtStart>,
) -> Vec<Located> {
    let Interval { from, to, length } = interval;
    let mut found: Vec<Located> = Vec::new();
    let mut locator = Locator::new(curve, interval);
    let parameter = locator.curve.corrector.equations.parameters_at();
    for index in 0..locator.curve.detector.events.len() {
        let event = &locator.curve.detector.events[index];
        let terminal = event.terminal;
        let reported = at_start.is_some_and(|it| it.reported.contains(&event.kind));
        let mut ends = [from, to].map(|place| locator.curve.reading(index, place));
        if reported && !backward && ends[0].value == Some(0.0) {
            // The first half of the branch passes the event at the start.
            ends[0].value = ends[1].value.map(|after| -f64::EPSILON * after);
        }
        let ends = [&ends[0], &ends[1]];
        if !event.passed(ends, backward) {
            continue;
        }
        let values = ends.map(|end| end.value);
        let equations = &mut locator.curve.corrector.equations;
        if stays_at_limit(equations.system(), &from.point.parameters, event, values) {
            log.stays_at_limit(&event.name);
            continue;
        }
        // At a limit, the mode after an event changes, too.
        let at_limit = |it: &Located| it.special.kind == AT_LIMIT && it.special.converged;
        if event.test.is_decision() && found.iter().any(at_limit) {
            continue;
        }
        // At a pitchfork the parameter has an extremum, too.
        let from_branch_point = at_start.is_some_and(|it| it.from_branch_point);
        // The parameter is constant along a family of cycles.
        let turns = (from_branch_point || locator.curve.recorder.family) && event.kind == Kind::LP;
        // A flat fold changes stability; rounding on a vertical branch does not. At a start on a
        // fold, rounding determines in which of the two directions stability changes.
        let (doubtful, counted) = (event.test.is_doubtful(ends), event.test.counts(ends));
        if turns || doubtful && !reported && from.point.unstable == to.point.unstable {
            continue;
        }
        if is_rounding(locator.curve, index, interval)
            || is_turn_of_another((&mut locator, index), &found)
        {
            continue;
        }
        let dynamics = locator.curve.corrector.equations.system().dynamics();
        let is_pair = locator.curve.detector.events[index].critical == Critical::Pair;
        if is_pair && passes_double_multiplier(dynamics, interval) {
            continue;
        }
        let located = match locator.locate(index) {
            Ok(Some(located)) => located,
            Ok(None) => continue,
            Err(_) if terminal => locator.last_recorded(index),
            Err(cause) => {
                let name = &locator.curve.detector.events[index].name;
                log.not_located(name, interval.ends(parameter), &cause);
                continue;
            }
        };
        let unsure = doubtful && !counted && !located.special.converged;
        let flat = ends.iter().all(|end| end.slope.abs() <= end.vertical);
        let noise = is_noise(interval, &located, flat);
        let stays = stays_at_one(dynamics, interval, &located);
        let at_end = is_double_value(locator.curve, interval, &located)
            || is_other_end(locator.curve, from, &located);
        if at_end || unsure || noise || flat && stays || is_regular(dynamics, interval, &located) {
            continue;
        }
        let of_the_start = at_start.is_some()
            && !bounds.holds(index)
            && !(reported && located.special.converged)
            && located.along <= AT_START;
        if !(of_the_start || is_double(&located, &found, length)) {
            found.push(located);
        }
    }
    drop_at_mirror(locator.curve, from, &mut found);
    found.sort_by(|a, b| a.along.total_cmp(&b.along));
    found
}

/// Heuristic: a bifurcation counts as the point where a curve is its own mirror image if the test function
/// of this point is smaller than this fraction of its value at the beginning of the step. A pair of
/// bifurcations, one on each side of the point, does not change the signs at the ends of the step.
const AT_MIRROR: f64 = 0.3;

/// Removes the bifurcations at a point where a curve of special points is its own mirror image: the
/// defining systems of all bifurcations are singular at the point, where the test function of the point
/// itself vanishes.
fn drop_at_mirror(curve: &mut Curve, from: &CurvePoint, found: &mut Vec<Located>) {
    let Curve { corrector, detector, .. } = curve;
    if corrector.equations.conditions.is_empty() {
        return;
    }
    let events = &detector.events;
    let mirror = |it: &Located| it.event.map(|index| &events[index]).filter(|event| event.mirror);
    let Some(end) = found.iter().find_map(mirror) else { return };
    let is_level = |it: &Located| it.event.is_none_or(|index| events[index].test.level().is_some());
    let whole = end.value_at(&mut corrector.equations, &from.unknowns);
    let mut is_at_mirror = |it: &Located| {
        let here = end.value_at(&mut corrector.equations, &it.unknowns);
        here.zip(whole).is_none_or(|(here, whole)| here.abs() < AT_MIRROR * whole.abs())
    };
    found.retain(|it| {
        mirror(it).is_some() || is_level(it) || it.special.converged && !is_at_mirror(it)
    });
}

/// Whether the values of a test function at both ends of an interval consist of rounding errors.
fn is_rounding(curve: &mut Curve, index: usize, Interval { from, to, .. }: Interval) -> bool {
    let Curve { corrector, detector, .. } = curve;
    let test = &detector.events[index].test;
    [from, to].into_iter().all(|place| {
        corrector.equations.load(&place.unknowns);
        test.is_noise(&mut corrector.equations.at())
    })
}

/// Whether an apparent fold is caused only by a numerical error in the sign of the slope of the
/// continued parameter. At a true fold, a multiplier passes 1. If the number of unstable
/// multipliers does not change in an interval, a fold in it is rejected if Newton's method did not
/// converge to it, or if the slopes of the continued parameter are as small as discretisation
/// errors.
fn is_noise(Interval { from, to, .. }: Interval, it: &Located, flat: bool) -> bool {
    let converged = it.special.converged;
    let noise = match (from.point.unstable, to.point.unstable) {
        (Some(before), Some(after)) => before == after && (flat || !converged),
        _ => flat && !converged,
    };
    it.special.kind == Kind::LP && noise
}

/// Rounding: if a multiplier is closer to 1 than this threshold, rounding determines whether it is
/// larger than 1. This threshold is ten times the threshold for neutral multipliers.
const AT_ONE: f64 = 1e-8;

/// Whether a fold did not converge, and its critical multiplier equals 1 up to rounding at both
/// ends of the interval, as it does along a family of cycles of a conservative system.
fn stays_at_one(dynamics: Dynamics, Interval { from, to, .. }: Interval, it: &Located) -> bool {
    let is_at_one = |place| nearest_to_one(dynamics, place).is_some_and(|near| near <= AT_ONE);
    it.special.kind == Kind::LP && !it.special.converged && [from, to].into_iter().all(is_at_one)
}

/// Heuristic: no multiplier passes 1 in a step if all multipliers at its ends are farther from 1
/// than this threshold.
const FAR_FROM_ONE: f64 = 0.1;

/// Rounding: two real multipliers are equal if they differ by less than this threshold, and a multiplier
/// is outside the unit circle if its distance from the circle is larger than this threshold.
const EQUAL: f64 = 1e-7;

/// Whether a double real multiplier, as in symmetric systems, passes the unit circle in an interval.
/// Rounding errors turn the double multiplier into a complex pair, and the defining system of torus
/// points is singular at the passage.
fn passes_double_multiplier(dynamics: Dynamics, Interval { from, to, .. }: Interval) -> bool {
    let (Some(first), Some(last)) = (from.point.unstable, to.point.unstable) else { return false };
    let [fewer, more] = if first < last { [from, to] } else { [to, from] };
    dynamics == Dynamics::Periodic
        && first.abs_diff(last) == 2
        && has_double_outside(more)
        && !has_double_outside(fewer)
}

/// Whether the two multipliers outside the unit circle that are nearest to it are real and equal.
fn has_double_outside(place: &CurvePoint) -> bool {
    let all = place.spectrum.as_deref().unwrap_or_default();
    let distance = |mu: &(f64, f64)| mu.0.hypot(mu.1) - 1.0;
    let mut outside: Vec<_> = all.iter().filter(|mu| distance(mu) > EQUAL).collect();
    outside.sort_by(|a, b| distance(a).total_cmp(&distance(b)));
    let Some([a, b]) = outside.first_chunk() else { return false };
    (a.0 - b.0).hypot(a.1 - b.1) <= EQUAL && a.1.abs() <= EQUAL
}

/// Whether an unconverged branch point of cycles is an artefact of a coarse mesh, which is assumed
/// if no multiplier comes near 1.
fn is_regular(dynamics: Dynamics, Interval { from, to, .. }: Interval, it: &Located) -> bool {
    let counts = [from.point.unstable, to.point.unstable];
    let is_far = |place| nearest_to_one(dynamics, place).is_some_and(|near| near > FAR_FROM_ONE);
    let regular = counts[0].is_some() && counts[0] == counts[1] && is_far(from) && is_far(to);
    let candidate = it.special.kind == Kind::BP && !it.special.converged;
    candidate && dynamics == Dynamics::Periodic && regular
}

/// Returns the smallest distance between a multiplier and 1, or between an eigenvalue and 0.
fn nearest_to_one(dynamics: Dynamics, place: &CurvePoint) -> Option<f64> {
    let all = place.spectrum.iter().flat_map(|all| all.iter());
    all.map(|mu| Critical::One.distance(dynamics, mu)).reduce(f64::min)
}

/// Heuristic: an auxiliary unknown counts as zero if it is smaller than this fraction of the larger
/// of its values at the ends of a step.
const VANISHED: f64 = 1e-4;

/// Whether an apparent codimension-two point, at which a critical pair and another eigenvalue or
/// multiplier are critical together, is in fact the end of the curve. At the end of a curve with a
/// critical pair, the pair becomes a double critical eigenvalue or multiplier, and rounding
/// determines the signs of determinants.
fn is_double_value(curve: &mut Curve, Interval { from, to, .. }: Interval, it: &Located) -> bool {
    let Curve { corrector, detector, .. } = curve;
    corrector.equations.load(&it.unknowns);
    let is_mirror = it.event.is_some_and(|index| detector.events[index].mirror);
    let is_end = |event: &Event| match (it.special.kind, is_mirror) {
        (Kind::ZH | Kind::LPNS | Kind::PDNS, false) => event.terminal,
        // The angle of the critical pair vanishes with the amplitude, as at a fold–Hopf point.
        (Kind::HH | Kind::PDNS, true) => event.mirror,
        _ => false,
    };
    let held = corrector.equations.at().held;
    detector.events.iter().enumerate().filter(|(_, event)| is_end(event)).any(|(index, event)| {
        let Some((unknown, level)) = event.test.auxiliary() else { return false };
        let ends = [from, to].map(|place| place.tests[index].map_or(0.0, f64::abs));
        let here = held.get(unknown).map(|value| (value - level).abs());
        here.is_some_and(|here| here <= VANISHED * ends[0].max(ends[1]))
    })
}

/// Whether an apparent end of a curve, at which its cycles shrink, is another point: at a resonance 1:1,
/// the angle of torus points vanishes, but not the amplitude; at a Hopf point, the difference between the
/// halves of a cycle vanishes with the amplitude.
fn is_other_end(curve: &mut Curve, from: &CurvePoint, it: &Located) -> bool {
    let Curve { corrector, detector, .. } = curve;
    let Some(event) = it.event.map(|index| &detector.events[index]).filter(|event| event.mirror)
    else {
        return false;
    };
    corrector.equations.load(&it.unknowns);
    let At { system, x, .. } = corrector.equations.at();
    let amplitude = system.traits(x).amplitude;
    let shrinks = amplitude.is_some_and(|amplitude| amplitude.abs() <= AT_MIRROR);
    match it.special.kind {
        Kind::ZH => !shrinks,
        Kind::GPD | Kind::PDNS => {
            let places = [&it.unknowns, &from.unknowns];
            let [here, whole] =
                places.map(|unknowns| event.value_at(&mut corrector.equations, unknowns));
            shrinks
                || here.zip(whole).is_none_or(|(here, whole)| here.abs() > AT_MIRROR * whole.abs())
        }
        _ => false,
    }
}

/// Heuristic: two events count as the same point if their distance is smaller than this fraction of
/// the step.
const ONE_POINT: f64 = 1e-3;

/// The kinds of points, besides folds, at which the parameter may have an extremum: a pitchfork on
/// its curved branch, and the end of a curve that is its own mirror image. At a pitchfork, and at
/// the end of a curve that is its own mirror image, an extremum of the parameter is not reported as
/// a fold, because the defining system of folds is singular at the point.
const TURNS: [Kind; 2] = [Kind::BP, Kind::HB];

/// Whether an event is only the extremum that the parameter has at another special point found in
/// the step. The test for an extremum of the parameter takes less time than an attempt to solve
/// a singular defining system.
fn is_turn_of_another((locator, index): (&mut Locator, usize), found: &[Located]) -> bool {
    if locator.curve.detector.events[index].kind != Kind::LP {
        return false;
    }
    let reach = ONE_POINT * locator.interval.length;
    let turns = |other: &&Located| TURNS.contains(&other.special.kind) && other.special.converged;
    found.iter().filter(turns).any(|other| {
        let values = locator.values_beside(index, other.along, reach);
        values.is_some_and(|[before, after]| before * after < 0.0)
    })
}

/// Whether an event is a duplicate of another event found in the step.
fn is_double(it: &Located, found: &[Located], length: f64) -> bool {
    let near = |other: &Located| (other.along - it.along).abs() < ONE_POINT * length;
    let mut others = found.iter();
    match it.special.kind {
        Kind::LP => {
            let same = |other: &Located| !it.special.converged || near(other);
            others.any(|other| TURNS.contains(&other.special.kind) && same(other))
        }
        // Where impacting orbits emanate vertically, every multiplier solves the equations; the
        // point is the degenerate point.
        Kind::GF => others.any(|other| other.special.kind == Kind::GD && near(other)),
        _ => false,
    }
}
