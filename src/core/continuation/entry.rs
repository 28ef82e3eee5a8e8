//! The place at which a closed curve closes.

use super::closing::Reference;
use super::run::Tracer;
use super::stepper::Place;

/// A branch point is singular: the curve is looked for so far behind it, in scaled arclength.
const BEHIND: [f64; 4] = [2e-2, 5e-3, 1e-3, 2e-4];

impl Tracer<'_> {
    /// The place that a half of the branch passes again if the curve is closed: its start, or where
    /// that is a branch point, a place behind it, with no event between them. `None` where a branch
    /// begins.
    pub fn reference(&mut self, start: &Place, backward: bool) -> Option<Reference> {
        if !self.from_branch_point {
            return Some(self.stepper.reference(start.clone()));
        }
        if !self.directions[0] {
            return None;
        }
        let mut turned = start.clone();
        self.stepper.turn(&mut turned);
        let row = self.stepper.covector(&turned.tangent);
        let step = BEHIND.iter().find_map(|&length| {
            let step = self.stepper.try_step(&[], &turned, &row, length).ok()?;
            self.events_between(&turned, &step, !backward, true).is_empty().then_some(step)
        });
        let mut place = step?.place;
        self.stepper.turn(&mut place);
        Some(self.stepper.reference(place))
    }
}
