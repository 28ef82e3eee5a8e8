//! Robustness map of continuation steps along a sharp bend near another branch: steps without
//! control, steps of equal length, and adaptive steps.

use super::grid::{Found, Panel, from_to, map};
use crate::{Class, RobustnessMap};
use num_dual::Dual64;
use tangency::core::continuation::{Branch, Continuation, End, Settings, TraceError};
use tangency::core::problem::ZeroProblem;
use tangency::core::system::{Dense, Kind};
use tangency::problems::classic::Hyperbola;

/// Returns the function `F` and its derivatives with respect to `x` and `μ`.
fn linearised([x, mu]: [f64; 2], epsilon: f64) -> [f64; 3] {
    let derivative = |x: Dual64, mu: Dual64| {
        let mut r = [Dual64::from(0.0)];
        Hyperbola.residual(&[x], &[mu, epsilon.into()], &mut r);
        r[0]
    };
    let by_x = derivative(Dual64::from(x).derivative(), mu.into());
    let by_mu = derivative(x.into(), Dual64::from(mu).derivative());
    [by_x.re, by_x.eps, by_mu.eps]
}

/// Traces a branch by steps along the tangent, each corrected by Newton's iteration on the line
/// perpendicular to the tangent; every converged point is accepted as the next point.
fn uncontrolled(epsilon: f64, step: f64) -> Found {
    let mut at = [(1.0 + epsilon * epsilon).sqrt(), -1.0];
    let mut before = [-1.0, 1.0];
    while at[1] < 1.0 {
        let [_, by_x, by_mu] = linearised(at, epsilon);
        let forward = (by_x * before[1] - by_mu * before[0]).signum() / by_x.hypot(by_mu);
        let tangent = [-by_mu * forward, by_x * forward];
        let mut next = [at[0] + step * tangent[0], at[1] + step * tangent[1]];
        let mut left = f64::INFINITY;
        for _ in 0..20 {
            let [r, by_x, by_mu] = linearised(next, epsilon);
            let across = tangent[0] * (next[0] - at[0]) + tangent[1] * (next[1] - at[1]) - step;
            let determinant = by_x * tangent[1] - by_mu * tangent[0];
            let change = [
                (r * tangent[1] - by_mu * across) / determinant,
                (by_x * across - r * tangent[0]) / determinant,
            ];
            next = [next[0] - change[0], next[1] - change[1]];
            left = change[0].hypot(change[1]);
            if left < 1e-10 {
                break;
            }
        }
        if left.is_nan() || left >= 1e-10 {
            return Found::reported("no convergence", "no convergence in 20 iterations");
        }
        if next[1] < -1.0 {
            return Found::silent("turned back");
        }
        (at, before) = (next, tangent);
    }
    arrived(at[0])
}

/// Returns the outcome of a continuation, given the position of its last point after the bend: the
/// continuation has followed its branch if `x` is positive, and has jumped to the other branch
/// otherwise.
fn arrived(x: f64) -> Found {
    if x > 0.0 { Found::right("followed") } else { Found::silent("jumped to the other branch") }
}

/// Traces the branch with the library's adaptive steps, between a minimum and a maximum step
/// length.
fn traced(epsilon: f64, [min_step, max_step]: [f64; 2]) -> Result<Branch, TraceError> {
    let settings = Settings { initial_step: max_step, max_step, min_step, ..Settings::default() };
    let mut system = Dense::new(Hyperbola);
    Continuation::new(&mut system)
        .from(&[(1.0 + epsilon * epsilon).sqrt()])
        .at("mu", -1.0)
        .at("epsilon", epsilon)
        .along("mu", -1.0..=1.0)
        .settings(Settings { max_points: 100_000, refinement: 0.0, ..settings })
        .trace()
}

/// The approximate distance below which two neighbouring branches count as crossing each other.
const CROSSING: f64 = 5e-4;

/// Classifies the branch that the library's continuation traced.
fn judged(epsilon: f64, traced: Result<Branch, TraceError>) -> Found {
    let branch = match traced {
        Ok(branch) => branch,
        Err(cause) => return Found::reported("no start", cause),
    };
    match (&branch.ends[1], branch.special.last()) {
        (End::ParameterBound { value: 1.0, .. }, Some(last)) => {
            let crossing = branch.of_kind(Kind::BP).next();
            match (arrived(last.state[0]), crossing) {
                // The core is documented to treat closer branches as crossing.
                (found, Some(point)) if found.class == Class::Silent && epsilon < CROSSING => {
                    let why = format!("{}, {}", point.kind, point.event);
                    Found::reported("reported as a branch point", why)
                }
                (found, _) => found,
            }
        }
        (end @ End::StepTooSmall { .. }, _) => Found::reported("no step small enough", end),
        (end, _) => Found::reported("another end", end),
    }
}

/// Computes three panels.
pub(super) fn draw() -> RobustnessMap {
    let (bends, lengths) = (from_to(-9.0, 0.0, 28), from_to(-2.5, -0.25, 19));
    let panel = |name: &str, naive, method: fn(f64, f64) -> Found| {
        let labels =
            ["log₁₀ of ε, the radius of the bend", "log₁₀ of the step (the largest, if adapted)"];
        let method = |x: f64, y: f64| method(10_f64.powf(x), 10_f64.powf(y));
        Panel::of((name, naive), labels, [&bends, &lengths], method)
    };
    let adapted =
        |epsilon, step| judged(epsilon, traced(epsilon, [Settings::default().min_step, step]));
    let fixed = |epsilon, step| judged(epsilon, traced(epsilon, [step; 2]));
    map(
        "steps",
        vec![
            panel("Steps of fixed length, without step control", true, uncontrolled),
            panel("Tangency's steps of fixed length", false, fixed),
            panel("Tangency's adaptive steps", false, adapted),
        ],
    )
}
