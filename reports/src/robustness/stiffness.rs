//! Robustness map of stiff fields: explicit integration methods and the implicit method.

use super::grid::{Found, Panel, from_to, map};
use crate::RobustnessMap;
use tangency::core::failure::FlowError;
use tangency::core::ode::{Flow, Scheme, Settings};
use tangency::problems::classic::ProtheroRobinson;

/// The length of the integration interval.
const TIME: f64 = 2.0;
/// The largest allowed error at the end of the integration, in units of the tolerance.
const TOLERANCES: f64 = 100.0;

/// Returns the error at the end of the integration, and the number of evaluations of the field.
fn flowed(scheme: Scheme, rate: f64, tolerance: f64) -> Result<(f64, usize), FlowError> {
    let mut x = [1.0];
    // All tolerances on the map are valid.
    let mut flow = Flow::<f64>::new(Settings::new(scheme, tolerance)).unwrap_or_default();
    let statistics = flow.advance(&ProtheroRobinson, 0.0, TIME, &mut x, &[rate])?;
    Ok(((x[0] - TIME.cos()).abs(), statistics.evaluations))
}

fn tried(scheme: Scheme, rate: f64, tolerance: f64) -> Found {
    match flowed(scheme, rate, tolerance) {
        Ok((error, _)) if error > TOLERANCES * tolerance => {
            Found::silent("less accurate than the tolerance")
        }
        Ok(_) if scheme == Scheme::Rodas5P => Found::right("done"),
        Ok((_, evaluations)) => match flowed(Scheme::Rodas5P, rate, tolerance) {
            Ok((_, fewer)) if fewer < evaluations => {
                Found::right("done, by more evaluations than Rodas5P")
            }
            _ => Found::right("done"),
        },
        Err(cause) => {
            let name = match cause {
                FlowError::Stiff { .. } => "refused as stiff",
                FlowError::TooManySteps { .. } => "too many steps",
                FlowError::StepTooSmall { .. } => "no step small enough",
                FlowError::OutOfDomain { .. } => "left the domain",
                FlowError::NotFinite { .. } => "not finite",
                _ => "another failure",
            };
            Found::reported(name, cause)
        }
    }
}

/// Integrates with the explicit method, and switches to the implicit method if the explicit method
/// reports that the field is stiff.
fn handed_over(rate: f64, tolerance: f64) -> Found {
    match flowed(Scheme::DormandPrince8, rate, tolerance) {
        Err(FlowError::Stiff { .. } | FlowError::TooManySteps { .. }) => {
            match flowed(Scheme::Rodas5P, rate, tolerance) {
                Ok((error, _)) if error <= TOLERANCES * tolerance => {
                    Found::handed_over("done by Rodas5P after order 8 failed")
                }
                _ => tried(Scheme::Rodas5P, rate, tolerance),
            }
        }
        _ => tried(Scheme::DormandPrince8, rate, tolerance),
    }
}

/// Computes four panels.
pub(super) fn draw() -> RobustnessMap {
    let (rates, tolerances) = (from_to(1.0, 8.0, 22), from_to(-12.0, -3.0, 10));
    let panel = |name: &str, method: &dyn Fn(f64, f64) -> Found| {
        let labels = ["log₁₀ of the rate λ", "log₁₀ of the tolerance"];
        let method = |x: f64, y: f64| method(10_f64.powf(x), 10_f64.powf(y));
        Panel::of((name, false), labels, [&rates, &tolerances], method)
    };
    let by = |scheme| move |rate, tolerance| tried(scheme, rate, tolerance);
    map(
        "stiffness",
        vec![
            panel("Order 8", &by(Scheme::DormandPrince8)),
            panel("Order 5", &by(Scheme::DormandPrince5)),
            panel("Rodas5P", &by(Scheme::Rodas5P)),
            panel("Order 8, then Rodas5P", &handed_over),
        ],
    )
}
