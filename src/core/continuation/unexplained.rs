//! Changes of stability that no event explains: several eigenvalues that pass at one point, as
//! symmetries make them do, or points of a kind that was not looked for.

use super::arnoldi::{distances, shift_on_finer};
use super::branch::SpecialPoint;
use super::curve::Curve;
use super::curve_point::{CurvePoint, Interval};
use super::detector::Detector;
use super::located::Located;
use super::locator::Locator;
use super::recorder::{Recorded, special_point};
use super::step_control::Step;
use crate::core::bifurcation::{Critical, Needs, Stability, catalogue, neutral, without_critical};
use crate::core::numerics::lagrange;
use crate::core::problem::Dynamics;
use crate::core::system::Kind;
use std::ops::RangeInclusive;

/// (H) Steps in which the number of unstable eigenvalues changes without a reason are halved down
/// to this length, in scaled arclength: a tenth of a per cent of the branch, below which two points
/// are reported as one.
pub(super) const LEAST_UNEXPLAINED: f64 = 1e-3;

/// By how much the number of unstable eigenvalues changes in a step, unless the events found in it,
/// or the special point that it starts from, explain that.
pub(super) fn unexplained(
    detector: &Detector,
    from: &CurvePoint,
    step: &Step,
    found: &[Located],
    origin: &[Kind],
) -> Option<isize> {
    let branch_points = found.iter().filter(|it| it.special.kind == Kind::BP).count();
    let flips = detector.passes_branch_point(step.since(from));
    let crossings = step.crossings.count;
    let odd = !crossings.is_multiple_of(2);
    // At a point of higher multiplicity Newton's iteration does not converge.
    let unsure = found.iter().any(|it| it.special.kind == Kind::BP && !it.special.converged);
    if crossings > branch_points.max(1) || crossings > 0 && (odd != flips || unsure) {
        return Some(crossings as isize);
    }
    let (before, after) = (from.point.unstable?, step.place.point.unstable?);
    let change = after as isize - before as isize;
    let passed = found.iter().map(|located| located.special.kind);
    let passed = passed.chain(origin.iter().copied());
    let mut reachable = vec![0_isize];
    for kind in passed {
        // A multiplier passes through infinity, or the solution is another one beyond.
        if matches!(kind, Kind::G | Kind::MX) {
            return None;
        }
        let changes = catalogue::row(kind).map_or(&[][..], |row| row.critical.changes());
        if changes.is_empty() {
            continue;
        }
        let sums = reachable.iter().flat_map(|sum| changes.iter().map(move |c| sum + c));
        reachable = sums.collect();
    }
    (!reachable.contains(&change)).then_some(change)
}

/// The events without those that are noticed by counts of eigenvalues and did not converge, if the
/// others explain the change of stability: a fold may come with two real eigenvalues that become
/// complex.
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
    match unexplained(detector, from, step, &others, origin) {
        None => others,
        Some(_) => found,
    }
}

/// Whether a step that can be shortened ends on a special point itself, but for rounding, where
/// signs say nothing.
pub(super) fn ends_on_special_point(dynamics: Dynamics, from: &CurvePoint, step: &Step) -> bool {
    let count = |place: &CurvePoint| place.spectrum.as_ref().map(|all| neutral(dynamics, all));
    let more = matches!((count(from), count(&step.place)), (Some(a), Some(b)) if b > a);
    step.length > LEAST_UNEXPLAINED && (step.crossings.singular || more)
}

/// (H) Where in an interval, in units of it, eigenvalues are looked at: not at its ends and middle,
/// where symmetric problems may be singular.
const SAMPLES: [f64; 5] = [0.03, 0.22, 0.517, 0.76, 0.96];

/// (R) Zeros in an interval, in units of it, which may begin or end with one: the ends are
/// corrected to 1e-10 in arclength, 1e-7 of the shortest step in question.
const ENDS: RangeInclusive<f64> = -1e-6..=1.0 + 1e-6;

/// (D) Zeros of eigenvalues this near to each other, in units of the interval, are one: at most
/// 1e-6 in scaled arclength, the error of the mesh.
const TOGETHER: f64 = 1e-3;

/// The point in a small interval at which eigenvalues pass unexplained, by which the number of
/// unstable ones changes.
pub(super) fn unclassified(
    curve: &mut Curve,
    interval: Interval,
    change: isize,
) -> Option<Located> {
    let mut locator = Locator::new(curve, interval);
    passing(&mut locator, change).or_else(|| nameless(&mut locator))
}

/// The middle of an interval in which something passes of which no more is known.
fn nameless(locator: &mut Locator) -> Option<Located> {
    let event = (Kind::ND, "eigenvalues pass, and no event explains it");
    let Located { along, unknowns, special, .. } = locator.middle(event);
    let error = special.error + locator.curve.corrector.mesh_share(&unknowns);
    let special = record(locator.curve, event, &unknowns, locator.interval, 0)?;
    let special = SpecialPoint { error, converged: false, ..special };
    Some(Located { event: None, along, unknowns, special })
}

/// The point at which several eigenvalues vanish together: where their mean vanishes on the
/// polynomial through several points of the branch.
///
/// The equations of the branch are singular there; beside it they are not.
fn passing(locator: &mut Locator, change: isize) -> Option<Located> {
    let places = samples(locator)?;
    let (interval, curve) = (locator.interval, &mut *locator.curve);
    let length = interval.length;
    let abscissae: Vec<f64> = SAMPLES.iter().map(|s| s * length).collect();
    let (count, growth) = vanishing(curve, &places, length, change.unsigned_abs())?;
    let mean: Vec<f64> = growth.iter().map(|all| all.iter().sum::<f64>() / count as f64).collect();
    let along = root(&abscissae, &mean, length)?;
    // Without the first sample, to know how well it is known.
    let rougher = root(&abscissae[1..], &mean[1..], length)?;
    let each = (0..count).filter_map(|k| {
        let values: Vec<f64> = growth.iter().map(|all| all[k]).collect();
        root(&abscissae, &values, length)
    });
    let spread = each.fold(0.0, |most: f64, zero| most.max((zero - along).abs()));
    let Curve { corrector, refiner, .. } = &mut *curve;
    let dynamics = corrector.equations.system().dynamics();
    let mut spectra = places.iter().filter_map(|place| place.spectrum.as_deref());
    let real = spectra.all(|spectrum| is_real(spectrum, count, dynamics));
    let multiple = count > 1 && real && spread <= TOGETHER * length;
    let unknowns: Vec<f64> = (0..interval.from.unknowns.len())
        .map(|i| {
            let values: Vec<f64> = places.iter().map(|place| place.unknowns[i]).collect();
            interpolated(&abscissae, &values, along)
        })
        .collect();
    let [start, end] = interval.ends(corrector.equations.parameters_at());
    let slope = (end - start).abs() / length;
    let place = slope * (4.0 * (along - rougher).abs() + spread) + corrector.parameter_error();
    let share = match places[0].spectrum {
        Some(_) => corrector.mesh_share(&unknowns),
        None => slope * shift_on_finer(corrector, refiner.accuracy > 0.0, &places[0], count)?,
    };
    let error = place + share;
    let (kind, multiplicity, event) = match multiple {
        true => (Kind::BP, count, format!("branch point: {count} eigenvalues vanish")),
        false => (Kind::ND, 1, format!("{count} eigenvalues pass, and no event explains it")),
    };
    let special = record(curve, (kind, &event), &unknowns, interval, count)?;
    let special = SpecialPoint { error, multiplicity, converged: multiple, ..special };
    Some(Located { event: None, along, unknowns, special })
}

/// Numbers that vanish with the eigenvalues that pass in an interval, at points in it, in order,
/// and how many: growth rates, or where no eigenvalues are known the distances to singular
/// matrices, those that lie in the interval.
fn vanishing(
    curve: &mut Curve,
    places: &[CurvePoint],
    length: f64,
    change: usize,
) -> Option<(usize, Vec<Vec<f64>>)> {
    let dynamics = curve.corrector.equations.system().dynamics();
    if places[0].spectrum.is_some() {
        let rates = places
            .iter()
            .map(|place| nearest(place.spectrum.as_deref().unwrap_or_default(), change, dynamics));
        return Some((change, rates.collect()));
    }
    let all = places.iter().map(|place| distances(&mut curve.corrector, place));
    let mut distances = all.collect::<Option<Vec<Vec<f64>>>>()?;
    let inside = |d: &&f64| ENDS.contains(&(SAMPLES[0] + *d / length));
    let count = distances[0].iter().filter(inside).count();
    for at in &mut distances {
        if at.len() < count {
            return None;
        }
        at.truncate(count);
        at.sort_by(f64::total_cmp);
    }
    (count > 0).then_some((count, distances))
}

/// Corrected points of the branch in an interval.
fn samples(locator: &mut Locator) -> Option<Vec<CurvePoint>> {
    let stability = locator.curve.recorder.wants_stability();
    let point = |share: f64| {
        let guess = locator.interval.chord(share);
        let (unknowns, _) = locator.corrected(guess, share * locator.interval.length).ok()?;
        locator.arrive((unknowns, f64::INFINITY), stability).ok()
    };
    SAMPLES.into_iter().map(point).collect()
}

/// The special point where `count` eigenvalues pass, which do not count for its stability; without
/// stability if their number is unknown.
fn record(
    Curve { corrector, recorder, .. }: &mut Curve,
    event: (Kind, &str),
    unknowns: &[f64],
    interval: Interval,
    count: usize,
) -> Option<SpecialPoint> {
    let equations = &mut corrector.equations;
    equations.assemble(unknowns).ok()?;
    let stability = count > 0 && recorder.wants_stability();
    let Recorded { mut point, spectrum, .. } = recorder.record(equations, stability).ok()?;
    let dynamics = equations.system().dynamics();
    if let Some(spectrum) = &spectrum {
        let others = without_critical(spectrum, count, |l| rate(l, dynamics).abs());
        point.unstable = Some(Stability::of(dynamics, &others).unstable);
    }
    let spectrum = spectrum.unwrap_or_default();
    let tangents = interval.from.tangent.iter().zip(&interval.to.tangent);
    let tangent: Vec<f64> = tangents.map(|(a, b)| 0.5 * (a + b)).collect();
    let bracket = interval.ends(equations.parameters_at());
    let special = special_point(corrector, event, point, &spectrum, [unknowns, &tangent]);
    Some(SpecialPoint { bracket, ..special })
}

/// The rate of growth: the real part of an eigenvalue, the logarithm of a multiplier's modulus.
fn rate(&(re, im): &(f64, f64), dynamics: Dynamics) -> f64 {
    if dynamics == Dynamics::Periodic { re.hypot(im).ln() } else { re }
}

/// The `count` rates of growth nearest to zero, in order.
fn nearest(spectrum: &[(f64, f64)], count: usize, dynamics: Dynamics) -> Vec<f64> {
    let mut rates: Vec<f64> = spectrum.iter().map(|l| rate(l, dynamics)).collect();
    rates.sort_by(|a, b| a.abs().total_cmp(&b.abs()));
    rates.resize(count, 0.0);
    rates.sort_by(f64::total_cmp);
    rates
}

/// Whether the eigenvalues nearest to the stability boundary are real, and multipliers positive.
fn is_real(spectrum: &[(f64, f64)], count: usize, dynamics: Dynamics) -> bool {
    let distance = |l: &&(f64, f64)| Critical::One.distance(dynamics, l);
    let mut order: Vec<&(f64, f64)> = spectrum.iter().collect();
    order.sort_by(|a, b| rate(a, dynamics).abs().total_cmp(&rate(b, dynamics).abs()));
    let largest = order.iter().take(count).fold(0.0, |most: f64, l| most.max(distance(l)));
    order.iter().take(count).all(|l| l.1.abs() <= 1e-3 * largest.max(1e-6))
}

/// The polynomial through these values (Lagrange), at a place.
pub(super) fn interpolated(abscissae: &[f64], values: &[f64], at: f64) -> f64 {
    values.iter().enumerate().map(|(k, value)| lagrange(abscissae, k, at) * value).sum()
}

/// The zero, in a step of this length, of the polynomial through values of which the first and the
/// last one differ in sign, by the secant method.
fn root(abscissae: &[f64], values: &[f64], length: f64) -> Option<f64> {
    let line = |a: f64, fa: f64, b: f64, fb: f64| a - fa * (b - a) / (fb - fa);
    let last = values.len() - 1;
    let (mut a, mut fa) = (abscissae[0], values[0]);
    let mut b = line(a, fa, abscissae[last], values[last]);
    for _ in 0..30 {
        let fb = interpolated(abscissae, values, b);
        if fb == 0.0 || (b - a).abs() <= 1e-15 * length {
            break;
        }
        (a, fa, b) = (b, fb, line(a, fa, b, fb));
    }
    ENDS.contains(&(b / length)).then_some(b)
}
