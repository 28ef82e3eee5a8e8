//! Points at which a curve is its own mirror image: a test function changes sign there, and
//! everything else is even in it. The curve goes back over itself beyond, and its equations are
//! singular there, so that the values are limits.

use super::cluster::interpolated;
use super::event::Event;
use super::located::Located;
use super::locator::Locator;
use crate::core::bifurcation::{PointValues, TestFunction};

/// Values of the test function, as shares of that at the beginning of the step, at which the curve
/// is sampled: as near to the end as its equations, which are singular there, allow.
const SHARES: [f64; 11] = [0.8, 0.65, 0.5, 0.4, 0.3, 0.2, 0.15, 0.12, 0.09, 0.06, 0.04];

/// (H) How many samples make a polynomial, at least and at most: beyond five in the square of the
/// test function rounding dominates.
const SAMPLES: [usize; 2] = [3, 5];

/// The point of an interval where an event vanishes: the limit of polynomials in the square of its
/// test function.
pub(super) fn limit(locator: &mut Locator, event: &Event) -> Option<Located> {
    let (interval, test) = (locator.interval, &*event.test);
    let [start, end] = [interval.from, interval.to].map(|end| &end.unknowns[..]);
    let before = value(locator, test, start)?;
    let after = value(locator, test, end)?;
    let root = interval.length * before / (before - after);
    let (mut tests, mut places) = (vec![before], vec![start.to_vec()]);
    for share in SHARES {
        let along = root * (1.0 - share);
        let guess = interval.cubic(&locator.row, along);
        let Ok((unknowns, _)) = locator.corrected(guess, along) else { break };
        tests.push(value(locator, test, &unknowns)?);
        places.push(unknowns);
    }
    let [least, most] = SAMPLES;
    if tests.len() < least {
        return None;
    }
    let farther = tests.len().saturating_sub(most);
    tests.drain(..farther);
    places.drain(..farther);
    let squares: Vec<f64> = tests.iter().map(|test| test * test).collect();
    let at = |i: usize, first: usize| {
        let values: Vec<f64> = places[first..].iter().map(|x| x[i]).collect();
        interpolated(&squares[first..], &values, 0.0)
    };
    let unknowns: Vec<f64> = (0..start.len()).map(|i| at(i, 0)).collect();
    let corrector = &locator.curve.corrector;
    let parameter = corrector.equations.parameters_at();
    // The rougher limit leaves out the sample that is farthest.
    let rougher = (unknowns[parameter] - at(parameter, 1)).abs();
    let error = 4.0 * rougher + corrector.parameter_error();
    Some(Located::new((event.kind, &event.name), root, unknowns, error))
}

/// The value of the test function in which the curve is its own mirror image.
fn value(locator: &mut Locator, test: &dyn TestFunction, unknowns: &[f64]) -> Option<f64> {
    let equations = &mut locator.curve.corrector.equations;
    equations.load(unknowns);
    test.value(&mut equations.at(), &PointValues::default()).ok()?
}
