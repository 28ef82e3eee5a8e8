//! Points at which a curve is its own mirror image: a test function changes sign at the point, and
//! the parameters are even functions of the test function. Beyond a point at which a curve is its
//! own mirror image, the curve repeats itself. At a point where a curve is its own mirror image,
//! the equations of the curve are singular, so the values at the point are computed as limits.

use super::cluster::interpolated;
use super::event::Event;
use super::located::Located;
use super::locator::Locator;

/// The values of the test function at which the curve is sampled, as fractions of the test
/// function's value at the beginning of the step. The samples approach the end of the curve as
/// closely as possible, because the equations are singular at the end itself.
const SHARES: [f64; 14] =
    [0.8, 0.65, 0.5, 0.4, 0.3, 0.2, 0.15, 0.12, 0.09, 0.06, 0.04, 0.03, 0.02, 0.01];

/// The same fractions for samples before the beginning of the step, on curves of special cycles,
/// whose defining systems become singular as the cycles shrink.
const EARLIER: [f64; 4] = [3.0, 2.2, 1.7, 1.3];

/// Heuristic: the largest error of a parameter, in units of its scale, with which the point counts
/// as converged.
const ACCURATE: f64 = 1e-4;

/// Heuristic: the minimal and the maximal number of samples for an interpolating polynomial. If a
/// polynomial in the square of the test function interpolates more than five samples, rounding
/// errors dominate.
const SAMPLES: [usize; 2] = [3, 5];

/// A sampled point of the curve: the value of the test function and the unknowns at the point.
type Sample = (f64, Vec<f64>);

/// Computes the point of an interval where a test function vanishes, by extrapolating the unknowns
/// with polynomials in the test function. Unknowns that are even functions of the test function are
/// extrapolated with polynomials in its square. Samples close to the end of the curve have large
/// rounding errors, and samples far from the end have a large interpolation error. The sequence of
/// successive samples that gives the smallest error of the released parameters is used.
pub(super) fn limit(locator: &mut Locator, event: &Event) -> Option<Located> {
    let (root, samples) = sampled(locator, event)?;
    let corrector = &locator.curve.corrector;
    let (parameter, end) = (corrector.equations.parameters_at(), corrector.equations.length());
    let scaled_error = |run: &[Sample]| {
        let errors = (parameter..end).map(|i| corrector.norm.scaled(i, at_zero(run, i).1));
        errors.fold(0.0, f64::max)
    };
    let [least, most] = SAMPLES;
    let runs = (least..=samples.len()).map(|end| &samples[end.saturating_sub(most)..end]);
    let (run, scaled) = runs
        .map(|run| (run, scaled_error(run)))
        .min_by(|(_, one), (_, other)| one.total_cmp(other))?;
    let unknowns = (0..run[0].1.len()).map(|i| at_zero(run, i).0).collect();
    let error = 4.0 * at_zero(run, parameter).1 + corrector.parameter_error();
    let located = Located::new((event.kind, &event.name), root, unknowns, error);
    Some(located.converged(scaled <= ACCURATE))
}

/// Returns the position at which the linearly interpolated test function vanishes, and points of
/// the curve increasingly close to this position.
fn sampled(locator: &mut Locator, event: &Event) -> Option<(f64, Vec<Sample>)> {
    let interval = locator.interval;
    let [start, end] = [interval.from, interval.to].map(|end| &end.unknowns[..]);
    let holds = !locator.curve.corrector.equations.conditions.is_empty();
    let before = event.value_at(&mut locator.curve.corrector.equations, start)?;
    let after = event.value_at(&mut locator.curve.corrector.equations, end)?;
    let root = interval.length * before / (before - after);
    let mut sample = |share: f64| {
        let along = root * (1.0 - share);
        let guess = interval.cubic(&locator.row, along);
        let (unknowns, _) = locator.corrected(guess, along).ok()?;
        let value = event.value_at(&mut locator.curve.corrector.equations, &unknowns)?;
        Some((value, unknowns))
    };
    let mut samples: Vec<Sample> =
        if holds { EARLIER.into_iter().filter_map(&mut sample).collect() } else { Vec::new() };
    samples.push((before, start.to_vec()));
    samples.extend(SHARES.into_iter().map_while(sample));
    Some((root, samples))
}

/// Returns an unknown at the zero of the test function, and an estimate of its error: the largest
/// change if the nearest or the farthest sample is omitted. Omitting the nearest sample shows
/// rounding errors, omitting the farthest sample shows the interpolation error. A state of a cycle
/// is a smooth function of the size of the cycle, but not an even function.
fn at_zero(samples: &[Sample], i: usize) -> (f64, f64) {
    let limit = |samples: &[Sample], power: i32| {
        let tests: Vec<f64> = samples.iter().map(|(test, _)| test.powi(power)).collect();
        let values: Vec<f64> = samples.iter().map(|(_, unknowns)| unknowns[i]).collect();
        interpolated(&tests, &values, 0.0)
    };
    let of_power = |power: i32| {
        let (all, last) = (limit(samples, power), samples.len() - 1);
        let fewer = [&samples[1..], &samples[..last]];
        let moved = fewer.map(|fewer| (limit(fewer, power) - all).abs());
        (all, moved[0].max(moved[1]))
    };
    let (even, smooth) = (of_power(2), of_power(1));
    if smooth.1 < even.1 { smooth } else { even }
}
