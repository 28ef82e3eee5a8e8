//! Robustness map of Newton's iteration near a fold: at fixed load, without and with damping, and
//! with the load as an additional unknown.

use super::grid::{Found, Panel, from_to, map};
use crate::{Class, RobustnessMap};
use num_dual::Dual64;
use tangency::core::continuation::{
    Closing, Continuation, Extended, Newton, NewtonError, SpecialPoint, Tolerances,
};
use tangency::core::failure::Failure;
use tangency::core::problem::ZeroProblem;
use tangency::core::system::{Dense, Kind};
use tangency::problems::classic::ParallelPlate;

/// The load at the fold.
const PULL_IN: f64 = 4.0 / 27.0;

/// Returns the residual of the equilibrium equation, and its derivative with respect to the
/// deflection or the load.
fn residual(u: Dual64, load: Dual64) -> Dual64 {
    let mut r = [Dual64::from(0.0)];
    ParallelPlate.residual(&[u], &[load], &mut r);
    r[0]
}

/// Returns the residual of the equilibrium equation and its derivative with respect to the
/// deflection.
fn by_deflection(u: f64, load: f64) -> Dual64 {
    residual(Dual64::from(u).derivative(), load.into())
}

/// Classifies the deflection to which Newton's iteration converged.
fn judged(u: f64, load: f64) -> Found {
    let r = by_deflection(u, load);
    // Near the fold, the deflection is determined only up to the square root of the error of the
    // residual.
    let solved = r.re.abs() < 1e-9 * load.max(u.abs());
    match u {
        _ if !solved => Found::silent("no solution"),
        1.0.. => Found::silent("a deflection beyond the electrode"),
        _ if u <= 1.0 / 3.0 => Found::right("the stable deflection"),
        _ => Found::right("the unstable deflection"),
    }
}

/// Applies Newton's formula repeatedly until the deflection no longer changes.
fn plain(share: f64, guess: f64) -> Found {
    let (load, mut u) = (share * PULL_IN, guess);
    for _ in 0..LIMITS.max_iterations {
        let r = by_deflection(u, load);
        let step = r.re / r.eps;
        u -= step;
        if step.abs() <= LIMITS.tolerance * u.abs() {
            return judged(u, load);
        }
    }
    Found::reported("iteration limit", format!("no convergence in {} steps", LIMITS.max_iterations))
}

const LIMITS: Tolerances = Tolerances::new(1e-12, 30);

fn failed(cause: &NewtonError) -> Found {
    let name = match cause {
        NewtonError::Stagnation { .. } => "stagnation",
        NewtonError::Evaluation { cause: Failure::Singular { .. }, .. } => "singular matrix",
        NewtonError::Evaluation { .. } => "left the domain",
        NewtonError::IterationLimit { .. } => "iteration limit",
        _ => "not applicable",
    };
    Found::reported(name, cause)
}

/// Runs Tangency's Newton iteration at a fixed load.
fn damped(share: f64, guess: f64) -> Found {
    let (load, mut system) = (share * PULL_IN, Dense::new(ParallelPlate));
    let mut equations = Extended::new(&mut system, &[guess, load], vec![]);
    let mut u = [guess];
    match Newton::default().solve(&mut equations, &mut u, None, &[1.0], LIMITS) {
        Ok(_) => judged(u[0], load),
        Err(cause) => failed(&cause),
    }
}

/// Runs Tangency's Newton iteration with the load as an unknown; the iterates stay on the straight
/// line through the guess that is perpendicular to the curve of constant residual.
fn extended(share: f64, guess: f64) -> Found {
    let (load, mut system) = (share * PULL_IN, Dense::new(ParallelPlate));
    let start = [guess, load];
    // The derivatives ∂F/∂u and ∂F/∂λ, with the deflection in units of 1 and the load in units of
    // its value at the fold.
    let by_u = by_deflection(guess, load).eps;
    let by_load = PULL_IN * residual(guess.into(), Dual64::from(load).derivative()).eps;
    let along = [by_load, -by_u / PULL_IN];
    let mut equations = Extended::new(&mut system, &start, vec![0]);
    let closing = Closing { row: &along, base: &start, length: 0.0 };
    let weights = [1.0, PULL_IN.powi(-2)];
    let mut x = start;
    match Newton::default().solve(&mut equations, &mut x, Some(closing), &weights, LIMITS) {
        Err(cause) => failed(&cause),
        Ok(_) => match judged(x[0], x[1]) {
            found if found.class == Class::Silent => found,
            _ => Found::right("a point of the branch"),
        },
    }
}

/// Returns the two deflections that arclength continuation from rest finds at a given load, or
/// reports that the fold lies below this load.
fn from_rest(share: f64) -> Found {
    let (load, mut system) = (share * PULL_IN, Dense::new(ParallelPlate));
    let traced = Continuation::new(&mut system).along("load", 0.0..=1.0).mark("load", load).trace();
    let branch = match traced {
        Ok(branch) => branch,
        Err(cause) => return Found::reported("no start", cause),
    };
    let right = |point: &SpecialPoint| judged(point.state[0], load).class != Class::Silent;
    let marks = branch.of_kind(Kind::UZ).filter(|point| right(point)).count();
    match (marks, branch.of_kind(Kind::LP).next()) {
        (1.., _) => Found::handed_over("continuation from rest finds both solutions"),
        (0, Some(fold)) if fold.parameters[0] < load => {
            let why = format!("the branch from rest folds at load = {:.9}", fold.parameters[0]);
            Found::reported("the fold comes before this load", why)
        }
        _ => Found::silent("no solution"),
    }
}

/// Computes four panels.
pub(super) fn draw() -> RobustnessMap {
    let (loads, guesses) = (from_to(0.51, 1.31, 41), from_to(-0.95, 1.55, 26));
    let panel = |title: &str, naive, method: fn(f64, f64) -> Found| {
        let labels = ["load / load at the fold", "initial guess of the deflection"];
        Panel::of((title, naive), labels, [&loads, &guesses], method)
    };
    map(
        "newton",
        vec![
            panel("Newton's formula at a fixed load", true, plain),
            panel("Tangency's Newton iteration at a fixed load", false, damped),
            panel(
                "Tangency's Newton iteration with the load as an unknown \
                   (pseudo-arclength)",
                false,
                extended,
            ),
            panel(
                "Tangency's Newton iteration at a fixed load, then continuation from rest",
                false,
                |share, guess| {
                    let found = damped(share, guess);
                    if found.class == Class::Right { found } else { from_rest(share) }
                },
            ),
        ],
    )
}
