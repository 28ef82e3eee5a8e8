//! Checks that a forced system has its stated period.

use super::{Guard, HybridEquations, Mode};
use crate::core::linalg::generic;
use crate::core::problem::Forcing;

/// Heuristic: the times at which a period is checked, in units of the period.
const TIMES: [f64; 3] = [0.137, 0.519, 0.871];

/// Rounding: rates at times a period apart agree if they differ by at most this fraction.
const AGREES: f64 = 1e-6;

/// Rounding: a difference is zero if it is smaller than this fraction of the size of a state, divided by
/// the period for rates.
const ZERO: f64 = 1e-12;

/// The error of a forced system whose rates change from period to period.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error(
    "the equations do not have the stated period, {period}: at the same states, {of} is {} at t = {time:.6}, and {} \
     one period later", rates[0], rates[1]
)]
pub struct NotPeriodic {
    /// The stated period.
    pub period: f64,
    /// The quantity that differs: the rate of a state, or the function of a guard.
    pub of: String,
    /// The time.
    pub time: f64,
    /// The values at this time, and one period later.
    pub rates: [f64; 2],
}

/// Checks, at a few states and times, that the rates of a forced system and the functions of its guards
/// have the stated period.
///
/// # Errors
/// [`NotPeriodic`] with the first quantity that differs after a period.
///
/// ```
/// use tangency::core::hybrid::check_period;
/// use tangency::core::orbit::Smooth;
/// use tangency::vector_field;
/// use std::f64::consts::TAU;
/// vector_field! {
///     /// A forced relaxation.
///     struct Forced { period: f64 } [x; omega; t] {
///         d/dt x = (omega * t).cos() - x;
///         period = omega.recip() * period;
///     }
/// }
/// assert!(check_period(&Smooth(Forced { period: TAU }), &[2.0]).is_ok());
/// let wrong = check_period(&Smooth(Forced { period: 1.0 }), &[2.0]).unwrap_err();
/// assert_eq!((wrong.of.as_str(), wrong.period), ("the rate of x", 0.5));
/// ```
pub fn check_period(system: &dyn HybridEquations, p: &[f64]) -> Result<(), NotPeriodic> {
    if system.forcing() == Forcing::None {
        return Ok(());
    }
    let (period, guards) = (system.period(p), system.guards());
    let ends = |guard: &Guard, mode: usize| guard.modes.contains(&mode) && !guard.is_timed();
    for (mode, Mode { states, .. }) in system.modes().into_iter().enumerate() {
        let sizes = system.sizes_of(mode, p);
        for (seed, part) in TIMES.into_iter().enumerate() {
            let state = generic(states.len(), seed);
            let x: Vec<f64> = state.iter().zip(&sizes).map(|(x, size)| x * size).collect();
            let [now, later] = [part * period, (1.0 + part) * period].map(|t| {
                let mut rates = vec![0.0; x.len()];
                system.field(mode, t, &x, p, &mut rates);
                let own = guards.iter().enumerate().filter(|(_, guard)| ends(guard, mode));
                rates.extend(own.map(|(k, _)| system.guard(k, mode, t, &x, p)));
                rates
            });
            let largest = sizes.iter().fold(0.0, |most: f64, size| most.max(*size));
            let differs = |k: &usize| {
                let (a, b) = (now[*k], later[*k]);
                let zero = ZERO * sizes.get(*k).map_or(largest, |size| size / period);
                (a - b).abs() > AGREES * a.abs().max(b.abs()) + zero && (a - b).is_finite()
            };
            let Some(k) = (0..now.len()).find(differs) else { continue };
            let own = guards.iter().filter(|guard| ends(guard, mode));
            let names = states.iter().map(|state| format!("the rate of {state}"));
            let mut names = names.chain(own.map(|guard| format!("the guard `{}`", guard.name)));
            let of = names.nth(k).unwrap_or_default();
            return Err(NotPeriodic { period, of, time: part * period, rates: [now[k], later[k]] });
        }
    }
    Ok(())
}
