//! Branches of cycles that turn again and again at the same two parameters while the period grows.

use super::corrector::Corrector;
use super::curve_point::Interval;
use super::end::End;
use crate::core::bifurcation::At;

/// (H) A branch snakes after this number of turns at the same two values of the parameter. The
/// values of the first turns still change; later turns converge geometrically.
const TURNS: usize = 12;

/// (H) Turns are at the same value if they differ by less than this fraction of the distance of the
/// two values: the wiggles of a branch near a homoclinic orbit to an equilibrium shrink faster.
const SAME: f64 = 0.02;

/// The column of the period of cycles.
pub(super) const PERIOD: &str = "period";

/// The parameter and the period at a turn of the branch.
#[derive(Clone, Copy)]
struct Turn {
    parameter: f64,
    period: f64,
}

/// The turns along a half of a branch of cycles.
#[derive(Default)]
pub(super) struct Snaking {
    turns: Vec<Turn>,
}

impl Snaking {
    /// Returns the end of a branch of cycles that has turned many times at the same two values, at
    /// an accepted step.
    ///
    /// Near a homoclinic orbit to another cycle, each further revolution about that cycle adds two
    /// folds and the same time (P. Hirschberg and C. Laing, *Physica D* 89:1, 1995). The folds
    /// converge to two values of the parameter.
    pub fn reached(&mut self, corrector: &mut Corrector, step: Interval) -> Option<End> {
        let Interval { from, to, .. } = step;
        let [a, b] = [from, to].map(|place| corrector.slope(&place.tangent));
        if a * b >= 0.0 {
            return None;
        }
        corrector.equations.load(&to.unknowns);
        let At { system, x, .. } = corrector.equations.at();
        let period = system.traits(x).free_period?;
        let row = corrector.norm.covector(&from.tangent);
        let turn = step.cubic(&row, step.length * a / (a - b));
        let parameter = turn[corrector.equations.parameters_at()];
        if self.turns.last().is_some_and(|last| last.period >= period) {
            self.turns.clear();
        }
        self.turns.push(Turn { parameter, period });
        let Turn { period: from, .. } = *self.turns.iter().rev().nth(TURNS - 1)?;
        let last = &self.turns[self.turns.len() - TURNS..];
        let all = || last.iter().map(|turn| turn.parameter);
        let [low, high] =
            [all().fold(f64::INFINITY, f64::min), all().fold(-f64::INFINITY, f64::max)];
        let reach = SAME * (high - low);
        let repeats = all().all(|value| value - low <= reach || high - value <= reach);
        repeats.then_some(End::Snaking { turns: TURNS, values: [low, high], from, to: period })
    }
}
