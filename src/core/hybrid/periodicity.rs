//! Checks that a forced system has its stated period.

use super::{Guard, HybridEquations, Mode};
use crate::core::linalg::{generic, largest};
use crate::core::problem::Forcing;
use std::f64::consts::GOLDEN_RATIO;

/// Heuristic: the number of times at which a period is checked.
const TIMES: usize = 8;

/// Heuristic: a rate changes after a period if it changes by more than this fraction of its changes
/// within the period. A missing factor causes larger changes; π with six digits causes smaller changes.
const AGREES: f64 = 1e-3;

/// Heuristic: the number of times at which a rate must change after a period. A single time may lie so
/// close to a jump of the rate that rounding decides the comparison.
const LEAST: usize = 2;

/// Rounding: a change of a rate is zero if it is smaller than this fraction of the rate, of the same
/// state's rates in other modes, or of the rate at which the state changes by its size in one period:
/// rates along a surface on which motion slides are differences of the rates beside the surface.
const ROUNDING: f64 = 1e-12;

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

/// Returns the largest absolute value of the rate of a state over all modes with the same states; 0 for
/// a guard, whose index follows the indices of the states.
fn rates_elsewhere(
    system: &dyn HybridEquations,
    (states, time, x): (&[String], f64, &[f64]),
    state: usize,
    p: &[f64],
) -> f64 {
    let modes = system.modes().into_iter().enumerate();
    let rate = |mode: usize| {
        let mut rates = vec![0.0; x.len()];
        system.field(mode, time, x, p, &mut rates);
        rates.get(state).map_or(0.0, |rate| rate.abs())
    };
    let same = modes.filter(|(_, other)| other.states == states);
    same.map(|(mode, _)| rate(mode)).fold(0.0, f64::max)
}

/// Checks that the rates of a forced system and the functions of its guards have the stated period: for
/// each mode, the values at one state and several times are compared with the values one period later.
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
    for (mode, Mode { states, .. }) in system.modes().into_iter().enumerate() {
        let sizes = system.sizes_of(mode, p);
        let x: Vec<f64> =
            generic(states.len(), 0).iter().zip(&sizes).map(|(x, size)| x * size).collect();
        let own = |(_, guard): &(usize, &Guard)| guard.modes.contains(&mode) && !guard.is_timed();
        let own: Vec<(usize, &Guard)> = guards.iter().enumerate().filter(own).collect();
        let values = |t: f64| {
            let mut values = vec![0.0; x.len()];
            system.field(mode, t, &x, p, &mut values);
            values.extend(own.iter().map(|(k, _)| system.guard(*k, mode, t, &x, p)));
            values
        };
        // Multiples of the golden ratio fill the period evenly, and avoid its simple fractions.
        let part = |k: usize| (k as f64 * (GOLDEN_RATIO - 1.0)).fract();
        let times: Vec<f64> = (1..=TIMES).map(|k| part(k) * period).collect();
        let now: Vec<Vec<f64>> = times.iter().map(|t| values(*t)).collect();
        let later: Vec<Vec<f64>> = times.iter().map(|t| values(t + period)).collect();
        for k in 0..now[0].len() {
            let all: Vec<f64> = now.iter().map(|values| values[k]).collect();
            let [low, high] = [f64::min, f64::max].map(|of| all.iter().copied().fold(all[0], of));
            let usual =
                sizes.get(k).filter(|_| k < x.len()).map_or(0.0, |size| size / period.abs());
            let allowed = AGREES * (high - low) + ROUNDING * largest(&all).max(usual);
            let change = |i: &usize| (now[*i][k] - later[*i][k]).abs();
            let elsewhere = |i: &usize| rates_elsewhere(system, (&states, times[*i], &x), k, p);
            let mut differing =
                (0..TIMES).filter(|i| change(i) > allowed && change(i) > ROUNDING * elsewhere(i));
            if let (Some(i), true) = (differing.next(), differing.count() + 1 >= LEAST) {
                let names = states.iter().map(|state| format!("the rate of {state}"));
                let mut names =
                    names.chain(own.iter().map(|(_, guard)| format!("the guard `{}`", guard.name)));
                let (of, time) = (names.nth(k).unwrap_or_default(), times[i]);
                return Err(NotPeriodic { period, of, time, rates: [now[i][k], later[i][k]] });
            }
        }
    }
    Ok(())
}
