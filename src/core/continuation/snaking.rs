//! Detection of snaking: branches of cycles with many folds at the same two values of the parameter
//! while the period grows.

use super::corrector::Corrector;
use super::curve_point::Interval;
use super::end::End;
use crate::core::bifurcation::At;

/// Heuristic: a branch is considered to snake after this number of folds at the same two values of
/// the parameter. The parameter values at the first folds still differ; the values at later folds
/// converge geometrically.
const TURNS: usize = 12;

/// Heuristic: two folds count as lying at the same parameter value if their parameters differ by
/// less than this fraction of the distance between the two parameter values between which the
/// branch snakes. The oscillations of a branch near a homoclinic orbit to an equilibrium shrink
/// faster.
const SAME: f64 = 0.02;

/// The name of the column with the period of cycles.
pub(super) const PERIOD: &str = "period";

/// The parameter and the period at a fold of the branch.
#[derive(Clone, Copy)]
struct Turn {
    parameter: f64,
    period: f64,
}

/// The folds along one half of a branch of cycles.
#[derive(Default)]
pub(super) struct Snaking {
    turns: Vec<Turn>,
}

impl Snaking {
    /// Returns the end of a branch of cycles that has many folds at the same two values of the
    /// parameter. The function is called after each accepted step.
    ///
    /// Near a homoclinic orbit to another cycle, each further revolution about that cycle adds two
    /// folds to the branch and the same time to the period (P. Hirschberg and C. Laing, *Physica D*
    /// 89:1, 1995). Along a snaking branch, the parameter values at the folds converge to two
    /// limits.
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
