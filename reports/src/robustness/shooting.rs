//! Robustness map of periodic orbits with large multipliers, computed by multiple shooting and by
//! collocation.

use super::grid::{Found, Panel, from_to, map};
use crate::RobustnessMap;
use std::f64::consts::{LN_10, TAU};
use tangency::core::bvp::{BoundaryError, BoundarySystem, Collocation, Shooting};
use tangency::core::continuation::{Branch, Continuation, End, NewtonError, Settings, TraceError};
use tangency::core::failure::Failure;
use tangency::core::orbit::periodic_orbits;
use tangency::core::system::Kind;
use tangency::vector_field;

vector_field! {
    /// The equations `x' = λ(x − A cos t) − A sin t`, `y' = −λ(y − A sin t) + A cos t`: for every
    /// rate λ, the periodic solution is `(A cos t, A sin t)`, and its multipliers are `exp(±2πλ)`.
    struct Saddle [x, y; amplitude, rate; t] {
        let (sine, cosine) = t.sin_cos();
        d/dt x = rate * (x - amplitude * cosine) - amplitude * sine;
        d/dt y = -rate * (y - amplitude * sine) + amplitude * cosine;
        period = T::constant(TAU);
    }
}

/// A point of the branch is marked where the largest `x` of the orbit has this value, which is also
/// the exact amplitude of the orbit.
const MARKED: f64 = 1.5;
/// The largest relative error with which a result counts as right.
const DIGITS: f64 = 1e-9;
/// The largest ratio of an error to its estimate with which the estimate counts as honest.
const HONEST: f64 = 10.0;

/// Traces the branch of orbits over the amplitude from an inexact guess, which is wrong by a few
/// hundredths, and classifies the result.
fn judged(system: Result<BoundarySystem, BoundaryError>, multiplier: f64) -> Found {
    let mut system = match system {
        Ok(system) => system,
        Err(cause) => return Found::reported("no such mesh", cause),
    };
    let z = system.sampled(&[], |_, tau, x| {
        let (sine, cosine) = (TAU * tau).sin_cos();
        (x[0], x[1]) = (1.05 * cosine + 0.02, 0.95 * sine - 0.01);
    });
    let traced = Continuation::new(&mut system)
        .from(&z)
        .at("amplitude", 1.0)
        .at("rate", multiplier * LN_10 / TAU)
        .along("amplitude", 1.0..=2.0)
        .mark("max_x", MARKED)
        // Segments are not divided.
        .settings(Settings { refinement: 0.0, target_mesh_error: f64::MAX, ..Settings::default() })
        .trace();
    match traced {
        Ok(branch) => compared(&branch),
        Err(TraceError::Start { cause, .. }) => match *cause {
            NewtonError::Evaluation { cause: Failure::Singular { .. }, .. } => {
                Found::reported("singular matrix", cause)
            }
            NewtonError::Stagnation { .. } => Found::reported("stagnation", cause),
            NewtonError::Evaluation { cause: Failure::Growth(_), .. } => {
                Found::reported("deviations grow too far", cause)
            }
            NewtonError::Evaluation { .. } => Found::reported("no evaluation", cause),
            _ => Found::reported("iteration limit", cause),
        },
        Err(cause) => Found::reported("no start", cause),
    }
}

/// Compares the computed amplitude of the marked point with the exact amplitude, and the actual
/// error with the estimated error.
fn compared(branch: &Branch) -> Found {
    let Some(point) = branch.of_kind(Kind::UZ).next() else {
        return match &branch.ends[1] {
            end @ End::StepTooSmall { .. } => Found::reported("no step small enough", end),
            _ => Found::silent("the mark is missed"),
        };
    };
    if !point.converged {
        return Found::reported(
            "the mark has not converged",
            "every file format marks the point as not converged",
        );
    }
    let error = (point.parameters[0] - MARKED).abs();
    let estimate = point.error;
    match error {
        _ if error > DIGITS.max(HONEST * estimate) => Found::silent("digits lost"),
        _ if error > DIGITS => Found::reported(
            "digits lost, by its own estimate",
            format!("the error is estimated as {estimate:.1e}"),
        ),
        _ => Found::right("nine digits"),
    }
}

/// Computes one panel.
pub(super) fn draw() -> RobustnessMap {
    let multipliers = from_to(0.5, 20.0, 27);
    let mut panel = Panel::new("An orbit with the multipliers μ and 1/μ", "log₁₀ of μ", "method");
    for segments in [1, 2, 4, 8, 16] {
        let name = match segments {
            1 => "shooting".to_string(),
            _ => format!("{segments} segments"),
        };
        let shooting = || periodic_orbits(Saddle, segments, Shooting::default());
        panel = panel.row((&name, false), &multipliers, |x| judged(shooting(), x));
    }
    panel = panel.row(("collocation", false), &multipliers, |x| match Collocation::new(4) {
        Ok(method) => judged(periodic_orbits(Saddle, 40, method), x),
        Err(cause) => Found::reported("no such method", cause),
    });
    map("shooting", vec![panel])
}
