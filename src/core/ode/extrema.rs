//! Extrema along a flow.

use super::step::Step;
use super::watch_sampler::{PARTS, Sample, WatchSampler, crosses_once, keep_clear_of_zero, slopes};
use crate::core::problem::{FieldIn, Watchable};
use crate::core::scalar::Scalar;

/// A local extremum of a watched function.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Extremum<T> {
    /// The position in the flow, from 0 to 1.
    pub place: T,
    /// The value of the function.
    pub value: T,
}

/// (R) Functions that change by less than this in a step, in units of their scale, have no extrema
/// there, since those would be extrema of rounding errors.
const FLAT: f64 = 1e-14;
/// (H) The largest number of iterations for an extremum: quadratic convergence needs four, each order
/// of derivatives one more.
const ROUNDS: usize = 12;
/// (R) After a move by less than this fraction of a step, the parabola at the place is the solution
/// to rounding error: its error is of third order.
const SETTLED: f64 = 1e-5;

/// The search for all local extrema of one watched function, step by step. The observer of a flow
/// calls the search with the same function in all steps.
///
/// At a sign change of the slope of dense output, `dh/dσ = 0` is solved on a shorter step of the
/// method. Place and value then have the accuracy of the flow, and their derivatives include the
/// motion of the extremum with parameters. A real state is taken from dense output if that is as
/// accurate as the flow; the place is then less accurate, but its error enters the value only
/// quadratically. Two extrema within one eighth of a step are found if the slope of dense output
/// comes near zero and turns away. The ends of the flow are not counted.
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
    /// The last nonzero slope.
    slope: f64,
    sampler: WatchSampler<T>,
}

impl<T: Scalar> Default for Extrema<T> {
    fn default() -> Self {
        Extrema { slope: 0.0, sampler: WatchSampler::default() }
    }
}

impl<T: Scalar> Extrema<T> {
    /// Begins a new flow, possibly with another function.
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

    /// Whether a step, of any scalar type, can contain an extremum.
    pub(in crate::core) fn may_turn<F: FieldIn<S>, S: Scalar, W: Watchable<T>>(
        &mut self,
        watch: &W,
        step: &Step<F, S>,
    ) -> bool {
        let slopes = self.sampler.ends(step, watch, None).as_ref().map(slopes);
        !self.passes(watch, step, slopes)
    }

    /// Whether slopes at the ends and in the middle of a step (for a state, in all stages) exclude an
    /// extremum.
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

    /// Proceeds to the next sample: a slope with the opposite sign of the last nonzero slope
    /// indicates an extremum.
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

/// Solves `dh/dθ = 0` by Newton's method on shorter steps, with the curvature of dense output: every
/// round gains the digits of dense output, and one order of derivatives; a round that increases the
/// slope is undone. Returns `θ` and the value there.
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
