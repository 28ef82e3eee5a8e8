//! The events between two points of a branch.

use super::Kind;
use super::located::Located;
use super::run::Tracer;
use super::stepper::{AT_START, Place, Step};
use crate::core::condition::Failure;
use crate::core::test_function::Test;

impl Tracer<'_> {
    /// All events in a step, in the order in which the branch meets them, but for those of the
    /// start.
    pub fn events_between(
        &mut self,
        from: &Place,
        step: &Step,
        backward: bool,
        at_start: bool,
    ) -> Vec<Located> {
        let (to, length) = (&step.place, step.length);
        let mut found: Vec<Located> = Vec::new();
        for index in 0..self.stepper.events.len() {
            let event = &self.stepper.events[index];
            let terminal = event.terminal;
            if !event.passed(from.tests[index], to.tests[index], backward) {
                continue;
            }
            // What an event leads to changes where an orbit grazes, too.
            let grazes = |it: &Located| it.special.kind == Kind::G && it.special.converged;
            if event.test == Test::Itinerary && found.iter().any(grazes) {
                continue;
            }
            // At a pitchfork the parameter turns as well.
            let turns = at_start && self.from_branch_point && event.kind == Kind::LP;
            let noise = self.is_noise(index, from, to);
            // A flat fold changes stability and converges, what rounding does on a vertical branch
            // does not.
            let flat = event.test == Test::Fold && from.point.unstable != to.point.unstable;
            if turns || noise && !flat {
                continue;
            }
            let located = match self.stepper.locate(index, from, to, length) {
                Ok(Some(located)) => located,
                Ok(None) => continue,
                Err(_) if terminal => self.stepper.last_recorded(index, from, to, length),
                Err(cause) => {
                    self.warn(index, [from, to], &cause);
                    continue;
                }
            };
            if noise && !located.special.converged {
                continue;
            }
            let bound = index < self.bounds.len();
            let of_the_start = at_start && !bound && located.along <= AT_START;
            if !(of_the_start || self.is_double(&located, &found, length)) {
                found.push(located);
            }
        }
        found.sort_by(|a, b| a.along.total_cmp(&b.along));
        found
    }

    /// Saves that an event was passed between two places, but could not be evaluated.
    fn warn(&mut self, index: usize, ends: [&Place; 2], cause: &Failure) {
        let parameter = self.stepper.equations.parameters_at();
        let [low, high] = ends.map(|place| place.unknowns[parameter]);
        let (name, continued) = (&self.stepper.events[index].name, &self.branch.released[0]);
        self.branch.warnings.push(format!(
            "the event `{name}` between {continued} = {low:.6} and {high:.6} was not located: {cause}"
        ));
    }

    /// The events without Hopf and torus points that did not converge, if the others explain the
    /// change of stability: at a neutral saddle two real eigenvalues make their test function
    /// vanish.
    pub fn without_neutral_saddles(
        &self,
        from: &Place,
        step: &Step,
        found: Vec<Located>,
        origin: &[Kind],
    ) -> Vec<Located> {
        let doubtful =
            |it: &Located| !it.special.converged && [Kind::HB, Kind::TR].contains(&it.special.kind);
        if !found.iter().any(doubtful) {
            return found;
        }
        let others: Vec<Located> = found.iter().filter(|it| !doubtful(it)).cloned().collect();
        match self.stepper.unexplained(from, step, &others, origin) {
            None => others,
            Some(_) => found,
        }
    }

    /// Whether a change of sign means nothing.
    fn is_noise(&self, index: usize, from: &Place, to: &Place) -> bool {
        let parameter = self.stepper.equations.parameters_at();
        let scale = self.stepper.weights[parameter].sqrt();
        let slopes = [from, to].map(|place| place.tangent[parameter] * scale);
        let same = from.point.unstable == to.point.unstable;
        let spectra = [from, to].map(|place| place.spectrum.as_ref());
        self.stepper.events[index].test.is_noise(slopes, same, spectra)
    }

    /// Whether an event is another one of those found in the step, seen once more.
    fn is_double(&self, it: &Located, found: &[Located], length: f64) -> bool {
        let near = |other: &Located| (other.along - it.along).abs() < 1e-3 * length;
        let mut others = found.iter();
        match it.special.kind {
            // Where a pitchfork is crossed on its curved branch the parameter turns, too: that is
            // one branch point, and no fold, whose defining system is singular there.
            Kind::LP | Kind::CP => {
                let same = |other: &Located| !it.special.converged || near(other);
                // So it is where the curve ends as its own mirror image.
                let turns = [Kind::BP, Kind::HB, Kind::GH, Kind::R1, Kind::R2];
                others.any(|other| turns.contains(&other.special.kind) && same(other))
            }
            // Where impacting orbits are born vertically every multiplier solves the equations:
            // that is one point, the degenerate grazing.
            Kind::GF => others.any(|other| other.special.kind == Kind::GD && near(other)),
            _ => false,
        }
    }
}
