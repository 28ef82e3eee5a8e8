//! Steps beyond the bound at which a branch ends: a special point between the last point and the bound
//! may be hidden by another special point beyond the bound, which restores the signs of test functions
//! and the number of unstable eigenvalues.

use super::bounds::AT_START;
use super::curve_point::CurvePoint;
use super::located::Located;
use super::separation::Parts;
use super::step_control::Step;
use super::unexplained::explain;
use crate::core::bifurcation::neutral;

impl Parts<'_, '_> {
    /// Returns the events of a step up to the bound at which the branch ends. If stability is unknown, or
    /// if the events found in the step do not explain the change of stability up to the bound, the part of
    /// the step up to the bound is searched again.
    pub fn up_to_bound(
        &mut self,
        from: &CurvePoint,
        step: &Step,
        mut found: Vec<Located>,
        at_start: bool,
    ) -> Vec<Located> {
        let is_bound = |it: &Located| it.event.is_some_and(|event| self.bounds.holds(event));
        let Some(last) = found.iter().position(is_bound) else { return found };
        let (before, end) = (&found[..last], &found[last]);
        let origin = self.origin(at_start);
        let counts = from.point.unstable.zip(end.special.unstable);
        if counts.is_some_and(|(first, last)| explain(before, [first, last], origin)) {
            return found;
        }
        let Some([first, _]) = self.halves(from, step, end.along) else { return found };
        let dynamics = self.curve.corrector.equations.system().dynamics();
        let neutral =
            |it: &CurvePoint| it.spectrum.as_ref().map_or(0, |all| neutral(dynamics, all));
        // The branch may end at a special point, where rounding determines the signs.
        if neutral(&first.place) > neutral(from) {
            return found;
        }
        let further = match self.events(from, &first, at_start) {
            (further, None) => further,
            (further, Some(change)) => self.separated(from, &first, (further, change), at_start),
        };
        let is_same = |it: &Located, other: &Located| {
            let near = (other.along - it.along).abs() <= AT_START;
            // The place of an unconverged point depends on the interval.
            other.event == it.event && (near || !other.special.converged)
        };
        let is_new = |it: &Located| {
            it.along < end.along - AT_START && !before.iter().any(|other| is_same(it, other))
        };
        let new: Vec<Located> = further.into_iter().filter(is_new).collect();
        found.extend(new);
        found.sort_by(|a, b| a.along.total_cmp(&b.along));
        found
    }
}
