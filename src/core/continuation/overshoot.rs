//! Steps beyond the bound at which a branch ends: a special point between the last point and the bound
//! may be hidden by another special point beyond the bound, which restores the signs of test functions
//! and the number of unstable eigenvalues.

use super::bounds::Bounds;
use super::curve::Curve;
use super::curve_point::CurvePoint;
use super::located::Located;
use super::step_control::Step;
use super::unexplained::explain;
use crate::core::bifurcation::neutral;
use crate::core::system::Kind;

/// Whether the events found in a step do not include all events up to the bound at which the branch
/// ends. The check compares the numbers of unstable eigenvalues at the first point and at the bound, or,
/// if they are unknown, the test functions.
pub(super) fn hides_events(
    (curve, bounds): (&mut Curve, &Bounds),
    (from, step): (&CurvePoint, &Step),
    found: &[Located],
    (origin, backward): (&[Kind], bool),
) -> bool {
    let is_bound = |it: &Located| it.event.is_some_and(|event| bounds.holds(event));
    let Some(last) = found.iter().position(is_bound) else { return false };
    let (before, end) = (&found[..last], &found[last]);
    if let (Some(first), Some(last)) = (from.point.unstable, end.special.unstable) {
        let dynamics = curve.corrector.equations.system().dynamics();
        let count = |all: &[(f64, f64)]| neutral(dynamics, all);
        // The branch may end at a special point, where rounding determines the number.
        let is_regular =
            count(&end.special.eigenvalues) <= from.spectrum.as_deref().map_or(0, count);
        return is_regular && !explain(before, [first, last], origin);
    }
    let row = curve.corrector.norm.covector(&from.tangent);
    let Ok(at) = curve.arrive(end.unknowns.clone(), &row, f64::INFINITY, false) else {
        return false;
    };
    (0..curve.detector.events.len()).any(|index| {
        let event = &curve.detector.events[index];
        let passed = |to: &CurvePoint| {
            let ends = [from, to].map(|place| curve.reading(index, place));
            event.passed([&ends[0], &ends[1]], backward)
        };
        event.condition.is_some() && !event.terminal && passed(&at) && !passed(&step.place)
    })
}
