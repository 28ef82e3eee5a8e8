//! Detection of two events of the same kind within one step, where the test function has the same
//! sign at both ends of the step.

use super::curve::Curve;
use super::curve_point::CurvePoint;
use super::locator::Locator;
use super::predictor::Earlier;
use super::step_control::{LARGEST_ANGLE, MOST_DISTANT, Step};
use crate::core::linalg::dot;
use crate::core::numerics::extremum;

/// Heuristic: a predicted extremum of a test function is examined if it is closer to zero than this
/// threshold, relative to the values at the ends. The parabola that interpolates the test function
/// may be wrong by a third of the smaller of the values at the ends of the step.
const NEAR: f64 = 0.3;

/// Heuristic: the number of trial points for one extremum; for a smooth function, the last two or
/// three trial points agree with the extremum up to rounding.
const TRIALS: usize = 4;

/// Rounding: the sign of a test function is random if its value is smaller than this fraction of the
/// values at the ends. At a pitchfork on its curved branch, the critical eigenvalue has the same sign on
/// both sides.
const ROUNDING: f64 = 1e-7;

/// Returns a shorter step, which ends between `from` and the end of `step` at a point where some
/// test function has the opposite sign to its values at both ends. Candidates for this point are
/// extrema, close to or beyond zero, of the parabola through the last three values of the test
/// function.
pub(super) fn double_crossing(
    curve: &mut Curve,
    before: &Earlier,
    from: &CurvePoint,
    step: &Step,
) -> Option<Step> {
    // At a point where the curve is its own mirror image, every other function has an extremum.
    let opposite = |index: usize| {
        let tests = [from, &step.place].map(|place| place.tests[index]);
        matches!(tests, [Some(a), Some(b)] if a * b <= 0.0)
    };
    let events = &curve.detector.events;
    if (0..events.len()).any(|index| events[index].mirror && opposite(index)) {
        return None;
    }
    let dynamics = curve.corrector.equations.system().dynamics();
    (0..curve.detector.events.len()).find_map(|index| {
        let test = curve.detector.events[index].test.clone();
        let value = |curve: &Curve, place: &CurvePoint| {
            let spectrum = place.spectrum.as_deref().unwrap_or_default();
            test.smooth(&curve.reading(index, place), spectrum, dynamics)
        };
        let [a, b, c] = [&before.place, from, &step.place].map(|place| value(curve, place));
        let (a, b, c) = (a?, b?, c?);
        if b * c <= 0.0 {
            return None;
        }
        let decides = test.is_spectral() && curve.recorder.wants_stability();
        let mut locator = Locator::new(curve, step.since(from));
        let samples = [-before.length, 0.0, step.length].into_iter().zip([a, b, c]);
        search(&mut locator, samples.collect(), decides, value)
    })
}

/// Searches for a point at which a function has the opposite sign to the last two of three samples
/// `(length, value)`. Stability is computed at the end of the new step, and, if `decides` is set,
/// also at each trial point.
fn search(
    locator: &mut Locator,
    mut samples: Vec<(f64, f64)>,
    decides: bool,
    value: impl Fn(&Curve, &CurvePoint) -> Option<f64>,
) -> Option<Step> {
    let (sign, end) = (samples[1].1.signum(), samples[2].0);
    let rounding = ROUNDING * samples[1].1.abs().min(samples[2].1.abs());
    for _ in 0..TRIALS {
        let (length, least) = extremum(&samples)?;
        let smallest = samples[1].1.abs().min(samples[2].1.abs());
        let inside = length > 1e-3 * end && length < (1.0 - 1e-3) * end;
        if !inside || sign * least > NEAR * smallest {
            return None;
        }
        let predicted = locator.interval.cubic(&locator.row, length);
        let corrected = locator.corrected(predicted.clone(), length).ok()?;
        let distance = locator.curve.corrector.norm.distance(&corrected.0, &predicted);
        if distance > MOST_DISTANT * length {
            return None;
        }
        let mut place = locator.arrive(corrected, decides).ok()?;
        if dot(&locator.row, &place.tangent) < LARGEST_ANGLE.cos() {
            return None;
        }
        let test = value(locator.curve, &place)?;
        if test.abs() <= rounding {
            return None;
        }
        if sign * test < 0.0 {
            if !decides && locator.curve.recorder.wants_stability() {
                place = locator.arrive((place.unknowns, f64::INFINITY), true).ok()?;
            }
            let (from, row) = (locator.interval.from, &locator.row);
            let crossings = locator.curve.crossings(from, row, length, &mut place);
            return Some(Step { place, length, next: end - length, crossings, miss: distance });
        }
        // The three samples around the smallest value.
        if length > samples[1].0 {
            samples[0] = samples[1];
        } else {
            samples[2] = samples[1];
        }
        samples[1] = (length, test);
    }
    None
}
