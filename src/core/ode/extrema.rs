//! Extrema of watched functions along a flow.

use super::step::Step;
use super::watch_sampler::{PARTS, Sample, WatchSampler, crosses_once, keep_clear_of_zero, slopes};
use crate::core::problem::{FieldIn, Watchable};
use crate::core::scalar::Scalar;

/// A local extremum of a watched function along a flow.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Extremum<T> {
    /// The position of the extremum in the flow, from 0 to 1.
    pub place: T,
    /// The value of the function at the extremum.
    pub value: T,
}

/// Rounding: if a function changes in a step by less than this, in units of its scale, the step
/// contains no extremum, because any extremum would be due to rounding errors.
const FLAT: f64 = 1e-14;
/// Heuristic: the largest number of iterations for an extremum: quadratic convergence needs four
/// iterations, and each order of derivatives needs one more.
const ROUNDS: usize = 12;
/// Rounding: After a change of the position by less than this fraction of a step, the vertex of the
/// parabola is the extremum up to rounding errors, because the error of the parabola is of third
/// order.
const SETTLED: f64 = 1e-5;

/// The search for all local extrema of one watched function, step by step. The observer of a flow
/// must call the search with the same function in all steps.
///
/// If the derivative `dh/dσ` on the dense output changes sign, `dh/dσ = 0` is solved on a shorter
/// step of the method. The position and the value of the extremum then have the accuracy of the
/// flow, and their derivatives include the motion of the extremum with parameters. An extremum of a
/// state in real numbers is taken from dense output if the dense output is as accurate as the flow;
/// the position is then less accurate, but its error enters the value only quadratically. Two
/// extrema within one eighth of a step are found if the derivative on the dense output approaches
/// zero and then moves away from zero. The ends of the flow do not count as extrema.
///
/// ```
/// use std::ops::ControlFlow;
/// use tangency::core::ode::{Extrema, Extremum, Flow, Settings};
/// use tangency::core::problem::State;
/// # use tangency::core::hybrid::InMode;
/// # use tangency::problems::classic::ImpactOscillator;
/// # let oscillator = InMode { system: &ImpactOscillator, mode: ImpactOscillator::FLIGHT };
/// // x = sin t has its extrema at t = π/2 and 3π/2.
/// let mut flow = Flow::new(Settings::default()).unwrap();
/// let (mut extrema, mut found) = (Extrema::default(), Vec::<Extremum<f64>>::new());
/// flow.observe(&oscillator, 0.0, 6.0, &mut [0.0, 1.0], &[0.0, 1.0, 1.0, 0.0, 9.0], |step| {
///     extrema.search(&State(0), step, |extremum| found.push(extremum));
///     ControlFlow::Continue(())
/// }).unwrap();
/// assert_eq!(found.len(), 2);
/// assert!((found[0].value - 1.0).abs() < 1e-12 && (found[1].value + 1.0).abs() < 1e-12);
/// assert!((6.0 * found[0].place - std::f64::consts::FRAC_PI_2).abs() < 1e-10);
/// ```
#[derive(Clone, Debug)]
pub struct Extrema<T> {
    /// The last nonzero derivative of the function.
    slope: f64,
    sampler: WatchSampler<T>,
}

impl<T: Scalar> Default for Extrema<T> {
    fn default() -> Self {
        Extrema { slope: 0.0, sampler: WatchSampler::default() }
    }
}

impl<T: Scalar> Extrema<T> {
    /// Begins the search along a new flow, possibly with another function.
    pub fn restart(&mut self) {
        self.slope = 0.0;
    }

    /// Calls `visit` with every extremum in a step, in order.
    pub fn search<F: FieldIn<T>, W: Watchable<T>>(
        &mut self,
        watch: &W,
        step: &mut Step<F, T>,
        mut visit: impl FnMut(Extremum<T>),
    ) {
        let slopes = self.sampler.ends(step, watch, None).as_ref().map(slopes);
        if self.passes(watch, step, slopes) {
            return;
        }
        let brief = slopes.is_some_and(|slopes| crosses_once(&slopes));
        self.sampler.survey(step, watch, brief);
        let mut left = self.sampler.samples[0];
        for k in 0..self.sampler.samples.len() {
            let right = self.sampler.samples[k];
            self.pass(watch, step, [left, right], &mut visit);
            left = right;
        }
    }

    /// Whether a step, in numbers of any scalar type, can contain an extremum of the function.
    pub(in crate::core) fn may_turn<F: FieldIn<S>, S: Scalar, W: Watchable<T>>(
        &mut self,
        watch: &W,
        step: &Step<F, S>,
    ) -> bool {
        let slopes = self.sampler.ends(step, watch, None).as_ref().map(slopes);
        !self.passes(watch, step, slopes)
    }

    /// Whether the derivatives of the function at the ends and in the middle of a step (for a state,
    /// also at all stages) exclude an extremum.
    fn passes<F: FieldIn<S>, S: Scalar, W: Watchable<T>>(
        &mut self,
        watch: &W,
        step: &Step<F, S>,
        slopes: Option<[f64; 3]>,
    ) -> bool {
        let Some(slopes) = slopes else { return false };
        let flat = FLAT * step.scale_of::<T, W>(watch);
        if slopes.iter().all(|slope| slope.abs() < flat) {
            return true;
        }
        let steady = || watch.state_index().is_some_and(|i| step.keeps_direction(i));
        let passes = self.slope * slopes[2] >= 0.0 && (keep_clear_of_zero(&slopes) || steady());
        if passes {
            self.slope = slopes[2];
        }
        passes
    }

    /// Proceeds to the next sample: if the signs of its derivative and of the last nonzero
    /// derivative are opposite, an extremum lies between the samples.
    fn pass<F: FieldIn<T>, W: Watchable<T>>(
        &mut self,
        watch: &W,
        step: &mut Step<F, T>,
        [left, right]: [Sample; 2],
        visit: &mut impl FnMut(Extremum<T>),
    ) {
        if self.slope * right.slope < 0.0 {
            let turn = self.sampler.root(step, watch, [left, right], Sample::turning);
            let enough =
                T::NDERIV == 0 && watch.state_index().is_some_and(|i| step.is_dense_enough(i));
            let (theta, value) = match enough {
                true => turn.vertex().map(T::constant).into(),
                false => improved(&mut self.sampler, step, watch, turn.fraction),
            };
            visit(Extremum { place: step.place(theta), value });
        }
        if right.slope != 0.0 {
            self.slope = right.slope;
        }
    }
}

/// Solves `dh/dθ = 0` by Newton's method on shorter steps, with the second derivative on the dense
/// output. Each iteration adds as many correct digits as the dense output has, and makes one more
/// order of derivatives correct; an iteration that increases `|dh/dθ|` is undone. Returns the
/// position `θ` of the extremum, and the value at the extremum.
pub(super) fn improved<F: FieldIn<T>, T: Scalar, W: Watchable<T>>(
    sampler: &mut WatchSampler<T>,
    step: &mut Step<F, T>,
    watch: &W,
    guess: f64,
) -> (T, T) {
    let curvature = sampler.curvature(step, watch, guess);
    let mut theta = T::constant(step.met_near(guess).unwrap_or(guess));
    let mut extreme = T::zero();
    let mut before: Option<(T, T, f64)> = None;
    for round in 0..ROUNDS {
        let (value, slope) = sampler.exact(step, watch, theta);
        // Where the curvature is a rounding error, as just after a release from rest, its parabola
        // diverges.
        if let Some((place, known, steep)) = before
            && slope.real().abs() > steep
            && (theta - place).real().abs() > SETTLED
        {
            return (place, known);
        }
        before = Some((theta, value, slope.real().abs()));
        let change = slope / curvature;
        extreme = value;
        let strayed = (theta - change - guess).real().abs() > 1.0 / PARTS as f64;
        if strayed || !change.real().is_finite() {
            break;
        }
        theta -= change;
        // On the parabola, the remaining move changes the value by half the slope times the move.
        extreme -= slope * change * 0.5;
        if change.real().abs() < SETTLED && round >= T::NDERIV {
            break;
        }
    }
    (theta, extreme)
}
