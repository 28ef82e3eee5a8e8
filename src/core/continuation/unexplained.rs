//! Detection of changes of stability in a step that no detected event explains, because several
//! eigenvalues pass zero close together, or because the kind of the special point is not detected.

use super::branch::SpecialPoint;
use super::curve::Curve;
use super::curve_point::CurvePoint;
use super::detector::Detector;
use super::located::Located;
use super::step_control::Step;
use crate::core::bifurcation::{Needs, VERTICAL, catalogue, neutral};
use crate::core::problem::Dynamics;
use crate::core::system::Kind;
use std::f64::consts::{PI, TAU};

/// Heuristic: the length, in scaled arclength, down to which steps with an unexplained change of
/// the number of unstable eigenvalues are halved. In shorter steps, two special points are reported
/// as one.
pub(super) const LEAST_UNEXPLAINED: f64 = 1e-3;

/// Returns the change of the number of unstable eigenvalues in a step, if the events found in the
/// step are uncertain or do not explain the change; `None` if the events explain the change. The
/// events may be easier to identify in a shorter step.
///
/// Events are uncertain, for example, if Newton's method does not converge at a point of higher
/// multiplicity, or if the step has crossed to another branch.
pub(super) fn unexplained(
    detector: &Detector,
    from: &CurvePoint,
    step: &Step,
    found: &[Located],
    origin: &[Kind],
) -> Option<isize> {
    // If slopes are errors of the mesh, a shorter step gives no more information about a fold.
    let is_noisy = |it: &Located, place: &CurvePoint| {
        let slope = it.event.and_then(|event| place.tests[event]);
        place.vertical > VERTICAL && slope.is_some_and(|slope| slope.abs() <= place.vertical)
    };
    let unsure = |it: &Located| match it.special.kind {
        Kind::BP => !it.special.converged,
        // Two real eigenvalues that vanish together look like a complex pair.
        Kind::HB | Kind::TR => is_doubtful_pair(detector, it),
        Kind::LP if is_one_with_another(it, found, step.length) => true,
        Kind::LP => {
            !it.special.converged && ![from, &step.place].iter().any(|place| is_noisy(it, place))
        }
        _ => false,
    };
    uncounted(detector, from, step, found, origin).or_else(|| {
        let counts = (from.point.unstable, step.place.point.unstable);
        let change = match counts {
            (Some(before), Some(after)) => after as isize - before as isize,
            _ => step.crossings.count as isize,
        };
        found.iter().any(unsure).then_some(change)
    })
}

/// Rounding: two critical multipliers are real, up to rounding, if their angle differs from 0 or π by
/// less than this threshold.
pub(super) const REAL: f64 = 1e-6;

/// Whether an event at which a complex pair is critical did not converge, or two real eigenvalues
/// vanish instead. An end where cycles shrink to an equilibrium has no defining system and is not
/// doubtful.
pub(super) fn is_doubtful_pair(detector: &Detector, it: &Located) -> bool {
    let is_mirror = it.event.is_some_and(|event| detector.events[event].mirror);
    let angle = it.special.number("torus_angle");
    let is_real = angle.is_some_and(|angle| {
        // Newton's method may converge to the conjugate multiplier.
        let value = angle.value.rem_euclid(TAU);
        let (value, error) = (value.min(TAU - value), angle.error.max(REAL));
        value <= error || PI - value <= error
    });
    (!it.special.converged || is_real) && !is_mirror
}

/// Returns the change of the number of unstable eigenvalues in a step, unless the events found in
/// it, or the special point at its start, explain the change. The check compares the numbers of
/// unstable eigenvalues in order: at the first point of the step, at each event, and at the last
/// point.
pub(super) fn uncounted(
    detector: &Detector,
    from: &CurvePoint,
    step: &Step,
    found: &[Located],
    origin: &[Kind],
) -> Option<isize> {
    let branch_points: usize = found.iter().map(|it| crossings_at(&it.special)).sum();
    let flips = detector.passes_branch_point(step.since(from));
    let crossings = step.crossings.count;
    let odd = !crossings.is_multiple_of(2);
    if crossings > branch_points.max(1) || crossings > 0 && odd != flips {
        return Some(crossings as isize);
    }
    let counts = [from.point.unstable?, step.place.point.unstable?];
    (!explain(found, counts, origin)).then_some(counts[1] as isize - counts[0] as isize)
}

/// Whether events, and the special point at the start of a step, explain that the number of unstable
/// eigenvalues changes from the first to the second count. The order of the events counts.
pub(super) fn explain(found: &[Located], counts: [usize; 2], origin: &[Kind]) -> bool {
    let [before, after] = counts.map(|count| count as isize);
    let mut reachable = vec![before];
    let mut passed: Vec<&Located> = found.iter().collect();
    passed.sort_by(|a, b| a.along.total_cmp(&b.along));
    let passed =
        passed.iter().map(|it| (it.special.kind, it.special.multiplicity, rest(it, found)));
    for (kind, multiplicity, rest) in origin.iter().map(|kind| (*kind, 1, None)).chain(passed) {
        // A multiplier passes through infinity, or the solution beyond is a different one.
        if matches!(kind, Kind::G | Kind::MX) {
            return true;
        }
        let changes = catalogue::row_of(kind).map_or(&[][..], |row| row.critical.changes());
        let Some(most) = changes.iter().max().map(|most| most * multiplicity as isize) else {
            continue;
        };
        let agrees = |count: &isize| rest.is_none_or(|rest| (0..=most).contains(&(count - rest)));
        reachable.retain(agrees);
        for _ in 0..multiplicity {
            let sums = reachable.iter().flat_map(|count| changes.iter().map(move |c| count + c));
            reachable = sums.collect();
        }
        reachable.retain(agrees);
    }
    reachable.contains(&after)
}

/// The largest change of the number of unstable eigenvalues at a special point of a curve: a complex
/// pair passes the imaginary axis.
const MOST_AT_ONCE: usize = 2;

/// Returns the change of the number of noncritical unstable eigenvalues in a step of a curve of special
/// points of equilibria or maps, if the special points found in the step are too few for this change.
/// Two eigenvalues that vanish in turn leave the sign of a determinant unchanged. No kind exists for a
/// second eigenvalue that vanishes on a curve of folds with an eigenvector of its own.
pub(super) fn unseen(
    curve: &mut Curve,
    from: &CurvePoint,
    step: &Step,
    found: &[Located],
) -> Option<isize> {
    // Multipliers of orbits contain discretisation errors.
    let is_on_mesh = curve.corrector.equations.system().representation().is_on_mesh();
    if curve.recorder.solutions || is_on_mesh {
        return None;
    }
    let [before, after] = [from.stability?, step.place.stability?].map(|it| it.unstable);
    let special = found.iter().filter(|it| catalogue::row_of(it.special.kind).is_some()).count();
    let is_unseen = before.abs_diff(after) > MOST_AT_ONCE * special;
    is_unseen.then_some(after as isize - before as isize)
}

/// Returns the number of noncritical unstable eigenvalues at a special point; `None` if the number
/// is uncertain, because the point did not converge or because another special point is close.
fn rest(point: &Located, found: &[Located]) -> Option<isize> {
    let away = |other: &Located| (other.along - point.along).abs();
    let near = found.iter().filter(|other| away(other) < LEAST_UNEXPLAINED).count();
    let certain = point.special.converged && near == 1;
    point.special.unstable.filter(|_| certain).map(|count| count as isize)
}

/// Heuristic: a fold and a branch point may be one point at which two eigenvalues vanish, if their
/// distance is smaller than both of these bounds: the first in units of the step, the second in
/// scaled arclength.
const ONE: [f64; 2] = [0.1, 1e-4];

/// Whether a fold may be the same point as a branch point found in the same step.
fn is_one_with_another(fold: &Located, found: &[Located], length: f64) -> bool {
    let near = (ONE[0] * length).min(ONE[1]);
    let mut others = found.iter().filter(|it| it.special.kind == Kind::BP);
    fold.special.kind == Kind::LP && others.any(|it| (it.along - fold.along).abs() < near)
}

/// Returns the number of other branches that cross the branch at a special point.
fn crossings_at(special: &SpecialPoint) -> usize {
    match special.kind {
        Kind::BP => special.multiplicity,
        Kind::LP => special.multiplicity - 1,
        _ => 0,
    }
}

/// Removes unconverged events that were detected by numbers of unstable eigenvalues, if the
/// remaining events explain the change of stability in the step. An event that is detected by a
/// number of unstable eigenvalues may be an error near a fold at which two real eigenvalues also
/// become complex.
pub(super) fn without_doubtful_counts(
    detector: &Detector,
    from: &CurvePoint,
    step: &Step,
    found: Vec<Located>,
    origin: &[Kind],
) -> Vec<Located> {
    let counted = |event: usize| detector.events[event].test.needs() == Needs::Eigenvalues;
    let doubtful = |it: &Located| !it.special.converged && it.event.is_some_and(counted);
    if !found.iter().any(doubtful) {
        return found;
    }
    let others: Vec<Located> = found.iter().filter(|it| !doubtful(it)).cloned().collect();
    match uncounted(detector, from, step, &others, origin) {
        None => others,
        Some(_) => found,
    }
}

/// Whether a step can still be shortened and ends, up to rounding, at a special point, where the
/// signs of test functions are random.
pub(super) fn ends_on_special_point(dynamics: Dynamics, from: &CurvePoint, step: &Step) -> bool {
    let count = |place: &CurvePoint| place.spectrum.as_ref().map(|all| neutral(dynamics, all));
    let more = matches!((count(from), count(&step.place)), (Some(a), Some(b)) if b > a);
    step.length > LEAST_UNEXPLAINED && (step.crossings.singular || more)
}
