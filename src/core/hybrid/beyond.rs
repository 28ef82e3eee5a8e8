//! Virtual motion beyond a surface: the motion that would occur if the surface were absent.

use super::erased::{EventNumber, FieldNumber, GuardNumber, HybridEquations};
use super::leg::{GuardOf, Moment};
use super::scales::guard_scale;
use crate::core::ode::{Extrema, Flow, Scheme, Settings};
use crate::core::scalar::Scalar;
use num_dual::Dual;
use std::ops::ControlFlow;

/// Heuristic: the number of Newton iterations for the time of the virtual point: the first
/// iterations converge to its value, and each further iteration makes one more order of its
/// derivatives exact.
const ROUNDS: usize = 4;
/// Heuristic: the largest change of the time in the last Newton iteration, as a fraction of the
/// allowed time: an error of the time changes the value of the guard only quadratically.
const SETTLED: f64 = 1e-9;
/// Discretisation: the relative and absolute tolerance of the flow, which is the smallest tolerance
/// used in the crate.
const TOLERANCE: f64 = 1e-13;

/// Computes the **virtual point** of a motion that reaches a surface: the point at which the guard
/// would be minimal if the motion continued in the same mode. The arguments are a time and a state at
/// the surface; the result is the time and the state of the virtual point, or `None` if the motion
/// does not turn back within the time `within`.
///
/// ```
/// use tangency::core::hybrid::virtual_point;
/// use tangency::problems::classic::ImpactOscillator;
/// // Without forcing and damping, x = sin t: from the wall at x = 0.8 the motion would go on to x = 1.
/// let p = [0.0, 1.0, 0.8, 0.0, 0.8];
/// let start = (0.8_f64.asin(), &[0.8, 0.6][..]);
/// let guard = (ImpactOscillator::IMPACT, ImpactOscillator::FLIGHT);
/// let (time, x) = virtual_point(&ImpactOscillator, guard, start, &p, 6.0).expect("it turns");
/// assert!((time - std::f64::consts::FRAC_PI_2).abs() < 1e-12 && (x[0] - 1.0).abs() < 1e-12);
/// ```
pub fn virtual_point<T: EventNumber>(
    system: &dyn HybridEquations,
    (guard, mode): (usize, usize),
    (t, x): (T, &[T]),
    p: &[T],
    within: f64,
) -> Option<(T, Vec<T>)>
where
    Dual<T>: FieldNumber + GuardNumber,
    Dual<Dual<T>>: GuardNumber,
{
    let guess = first_turn(Moment { system, mode, t, x, p }, guard, within)?;
    let (mut t, mut x) = (t, x.to_vec());
    let mut flow = Flow::<T>::new(Settings::new(Scheme::DormandPrince8, TOLERANCE)).ok()?;
    let mut step = T::constant(guess);
    for _ in 0..ROUNDS + T::NDERIV {
        let field = T::in_mode(system, mode, T::zero());
        flow.advance(&field, t, step, &mut x, p).ok()?;
        t += step;
        let turning = Moment { system, mode, t, x: &x, p }.along(|moving| moving.rate(guard));
        if turning.eps.real().is_nan() || turning.eps.real() <= 0.0 {
            return None;
        }
        step = -turning.re / turning.eps;
    }
    (step.real().abs() <= SETTLED * within).then_some((t, x))
}

/// Returns the time after which a falling guard stops falling; zero if the guard already rises, and
/// `None` if it keeps falling.
fn first_turn<T: EventNumber>(at: Moment<T>, guard: usize, within: f64) -> Option<f64>
where
    Dual<T>: GuardNumber,
{
    if at.rate(guard).real() >= 0.0 {
        return Some(0.0);
    }
    let Moment { system, mode, t, x, p } = at;
    let real = |values: &[T]| values.iter().map(Scalar::real).collect::<Vec<f64>>();
    let (mut x, p) = (real(x), real(p));
    let scale = guard_scale(system, (guard, mode), (t.real(), &x), &p);
    let watch = GuardOf { system, guard, mode, scale };
    let (mut flow, mut turn) = (Flow::<f64>::default(), None);
    let mut extrema = Extrema::<f64>::default();
    let field = f64::in_mode(system, mode, 0.0);
    let outcome = flow.observe(&field, t.real(), within, &mut x, &p, |step| {
        extrema.search(&watch, step, |extremum| {
            turn.get_or_insert(within * extremum.place);
        });
        if turn.is_some() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    });
    // A motion that leaves the domain of the field has no turning point.
    outcome.ok()?;
    turn
}
