//! Narrowing the bracket of an event on the corrected branch, by bisection and the ITP method.

use super::bracket::{Bracket, POINT, halvings};
use super::branch::SpecialPoint;
use super::event::Event;
use super::located::Located;
use super::locator::Locator;

/// Heuristic: the maximal number of evaluations beyond the number that plain bisection needs; it is
/// the slack `n₀` of the ITP method, which the authors of the method set to 1.
const BEYOND_BISECTION: i32 = 1;

impl Locator<'_, '_> {
    /// Divides the bracket at a corrected point of the branch, at the distance `along` from the
    /// first point of the step, and keeps the part that contains the event. Returns false if the
    /// point that divides the bracket cannot be corrected.
    pub fn narrow(&mut self, event: &Event, bracket: &mut Bracket, along: f64) -> bool {
        let guess = bracket.between((along - bracket.low) / (bracket.high - bracket.low));
        let Ok(corrected) = self.corrected(guess, along) else { return false };
        let wanted = event.condition.is_none() && self.curve.recorder.wants_stability();
        let readings = [0, 1].map(|end| self.curve.reading(bracket.index, &bracket.ends[end]));
        let counts = event.test.counts([&readings[0], &readings[1]]);
        let Ok(place) = self.arrive(corrected, counts || wanted) else { return false };
        let [low, middle, high] = [&bracket.ends[0], &place, &bracket.ends[1]]
            .map(|place| self.curve.reading(bracket.index, place));
        if if counts { middle.stability.is_none() } else { middle.value.is_none() } {
            return false;
        }
        let side = usize::from(event.test.passes([&low, &middle]).is_some());
        if side == 0 && event.test.passes([&middle, &high]).is_none() {
            bracket.is_empty = true;
            return false;
        }
        bracket.ends[side] = place;
        bracket.tests[side] = middle.value.unwrap_or_default();
        bracket.slope = bracket.slope.filter(|_| side == 0);
        *(if side == 0 { &mut bracket.low } else { &mut bracket.high }) = along;
        bracket.high - bracket.low > POINT * bracket.high
    }

    /// Locates the zero of a test function without a defining system by the ITP method (I. F. D.
    /// Oliveira and R. H. C. Takahashi, ACM Trans. Math. Softw. 47:5, 2020). The ITP method
    /// converges as fast as the secant method, and needs at most one evaluation more than
    /// bisection.
    pub fn bisect(&mut self, event: &Event, bracket: &mut Bracket) -> Located {
        let whole = bracket.high - bracket.low;
        let halvings = halvings() + BEYOND_BISECTION;
        for done in 0..halvings {
            let (low, high, [a, b]) = (bracket.low, bracket.high, bracket.tests);
            if b == 0.0 {
                break;
            }
            let (width, middle) = (high - low, 0.5 * (low + high));
            let secant = (b * low - a * high) / (b - a);
            let towards = (middle - secant).signum();
            let shift = 0.2 * width * width / whole;
            let moved =
                if shift <= (middle - secant).abs() { secant + towards * shift } else { middle };
            let reach = POINT * whole * 2.0_f64.powi(halvings - done - 1) - 0.5 * width;
            let near = (moved - middle).abs() <= reach;
            let along = if near { moved } else { middle - towards * reach.max(0.0) };
            if !self.narrow(event, bracket, along) {
                break;
            }
        }
        let [a, b] = bracket.tests.map(f64::abs);
        let side = usize::from(b <= a);
        // Decisions at an orbit's events have no value that vanishes, so such points do not
        // converge.
        let short = b == 0.0 || bracket.high - bracket.low <= 1e3 * POINT * whole;
        let converged = short && !event.test.is_decision();
        let along = if side == 0 { bracket.low } else { bracket.high };
        let (unknowns, error) =
            (bracket.ends[side].unknowns.clone(), bracket.reach(&self.curve.corrector));
        Located::new((event.kind, &event.name), along, unknowns, error).converged(converged)
    }

    /// Finds by bisection the last point before an event at which all monitors can be recorded, if
    /// they cannot be recorded at the event itself. For example, a monitor `1/p` cannot be recorded
    /// at the bound `p = 0` of a branch.
    pub fn last_recorded(&mut self, index: usize) -> Located {
        let event = self.curve.detector.events[index].clone();
        let mut bracket = Bracket::new(&mut self.curve.corrector, self.interval, (index, &event));
        for _ in 0..halvings() {
            let middle = 0.5 * (bracket.low + bracket.high);
            if !self.narrow(&event, &mut bracket, middle) {
                break;
            }
        }
        let corrector = &mut self.curve.corrector;
        let error = bracket.reach(corrector);
        let ends = bracket.at_ends(corrector.equations.parameters_at());
        let [place, _] = bracket.ends;
        let (kind, name) = (event.kind, &event.name[..]);
        let special = self.curve.recorder.saved_point(corrector, &place, (kind, name), 0);
        let special = SpecialPoint { error, bracket: ends, converged: false, ..special };
        let (along, unknowns) = (bracket.low, place.unknowns);
        Located { event: Some(index), along, unknowns, special, shortfall: None }
    }
}
