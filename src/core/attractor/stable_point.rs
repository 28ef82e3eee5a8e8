//! Stable periodic points of a map near a motion, by Newton's method.

use super::exponent::{Exponent, Monodromy, PushForward};
use super::repetition::StateScales;
use crate::core::hybrid::Member;
use crate::core::linalg::difference;

/// Discretisation: a periodic point counts as converged if the Newton step is shorter than this
/// length, in units of the largest state; the length is ten times the tolerance of flows.
const CONVERGED: f64 = 1e-11;
/// Heuristic: the maximal number of Newton iterations; quadratic convergence needs four.
const ROUNDS: usize = 8;
/// Heuristic: the largest distance of the periodic point from the simulated motion, in units of the
/// largest state.
const NEAR: f64 = 0.03;

/// Heuristic: a motion counts as rest if its size is below this bound, in units of the states'
/// scales. For example, the state of a body that a support carries may vanish at some phase, so
/// that only rounding errors remain there.
pub(super) const REST: f64 = 1e-6;
/// Discretisation: the largest drift of a neutral state in a cycle, as a fraction of the motion's
/// size; this bound equals the tolerance for repeating motion.
const DRIFT: f64 = 1e-5;

/// Discretisation: two periodic points count as equal if their distance, in units of their size, is
/// below this bound; Newton's method is more accurate.
pub(super) const SAME: f64 = 1e-8;

/// Computes, by Newton's method, the stable periodic point of period `q` near a state of a motion,
/// and the Lyapunov exponent of this point; `size` is the size of the motion in units of the
/// scales. Returns `None` if no stable point is found nearby, or if the motion ends within `q`
/// periods. Newton's method does not change neutral states, whose values return after every period.
pub(super) fn stable_point(
    push: &mut PushForward,
    near: &Member<f64>,
    q: usize,
    (size, scales): (f64, &StateScales),
) -> Option<(Member<f64>, Exponent)> {
    let (mut member, mode, near) = (near.clone(), near.state.mode, &near.state.x);
    let (mut last, mut length) = (f64::INFINITY, f64::INFINITY);
    for _ in 0..ROUNDS {
        let motion = Monodromy::over(push, &member, q, scales)?;
        let value = motion.exponent(q)?;
        let x = &mut member.state.x;
        let missed = difference(&motion.end, x);
        let step = motion.correction(&missed)?;
        let away: Vec<f64> =
            x.iter().zip(&step).zip(near).map(|((x, s), near)| x + s - near).collect();
        let neutral = |i: &usize| !motion.coupled.contains(i);
        let drifts = scales.of_mode(mode).take(x.len()).enumerate().filter(|(i, _)| neutral(i));
        let drift = drifts.map(|(i, scale)| missed[i].abs() / scale).fold(0.0, f64::max);
        if scales.size(mode, &away) > NEAR * size || drift > DRIFT * size.max(REST) {
            return None;
        }
        let before = std::mem::replace(&mut length, scales.size(mode, &step));
        // The error of the flow is amplified by 1/(1 − μ) if the motion is attracted slowly.
        let resolved = scales.size(mode, &missed) <= CONVERGED * size && length > 0.1 * before;
        if length <= CONVERGED * size || resolved {
            // The remaining error of the orbit changes the exponent less than the last step did.
            let moved = (value - last).abs();
            let error = if moved.is_finite() { moved } else { 0.0 };
            return (value < 0.0).then_some((member, Exponent { value, error }));
        }
        x.iter_mut().zip(&step).for_each(|(x, step)| *x += step);
        last = value;
    }
    None
}
