//! A watched function within one step: its values, and its first and second derivatives.
//!
//! Slopes and curvatures are the first and second derivatives of `h(t(θ), x(θ), p)` with respect to
//! the fraction `θ` of the step. Slopes and curvatures are computed from dense output in dual
//! numbers; exact slopes are computed from a shorter step of the method and the vector field at its
//! end.

use super::step::Step;
use crate::core::linalg::{largest, refill};
use crate::core::problem::{FieldIn, WatchIn, Watchable};
use crate::core::scalar::Scalar;
use num_dual::{Dual, Dual2, Dual2_64, Dual64};

/// Heuristic: the number of parts of a step in which sign changes of the slope are searched: the
/// polynomials of dense output have degrees up to 7.
pub(super) const PARTS: usize = 8;
/// Heuristic: the largest number of iterations for a position on dense output; each iteration
/// doubles the number of correct digits.
const ROUNDS: usize = 12;

/// A sample of a watched function on dense output, at a fraction of the step.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Sample {
    pub fraction: f64,
    pub value: f64,
    pub slope: f64,
    pub curvature: f64,
}

impl Sample {
    /// Returns the position and the value of the vertex of the parabola with the value, slope and
    /// curvature of the sample.
    pub fn vertex(&self) -> [f64; 2] {
        let Sample { fraction, value, slope, curvature } = *self;
        let change = slope / curvature;
        if change.is_finite() {
            [fraction - change, value - 0.5 * slope * change]
        } else {
            [fraction, value]
        }
    }

    /// Returns the value of the function and its derivative (the slope), for the location of a
    /// zero.
    pub fn crossing(&self) -> (f64, Option<f64>) {
        (self.value, Some(self.slope))
    }

    /// Returns the slope of the function and its derivative (the curvature), for the location of an
    /// extremum.
    pub fn turning(&self) -> (f64, Option<f64>) {
        (self.slope, Some(self.curvature))
    }

    /// Whether the absolute value of the slope decreases.
    fn approaches(&self) -> bool {
        self.slope * self.curvature < 0.0
    }
}

/// The states and parameters at which a watched function is evaluated, in one scalar type.
#[derive(Clone, Debug)]
struct Arguments<S> {
    x: Vec<S>,
    p: Vec<S>,
}

impl<S> Default for Arguments<S> {
    fn default() -> Self {
        Arguments { x: Vec::new(), p: Vec::new() }
    }
}

impl<S: Scalar> Arguments<S> {
    /// Evaluates the watched function at states that an iterator yields one by one.
    fn evaluate<W: WatchIn<S>, T: Scalar>(
        &mut self,
        watch: &W,
        time: S,
        p: &[T],
        lift: impl Fn(T) -> S,
        states: impl Iterator<Item = S>,
    ) -> S {
        refill(&mut self.x, states);
        refill(&mut self.p, p.iter().map(|p| lift(*p)));
        watch.value_in(time, &self.x, &self.p)
    }
}

/// Scratch space for evaluations of a watched function, with the samples of the last sampled step.
#[derive(Clone, Debug)]
pub(super) struct WatchSampler<T> {
    pub samples: Vec<Sample>,
    real: Arguments<Dual2_64>,
    lifted: Arguments<Dual2<T>>,
    /// Arguments for evaluations of only the value and the slope of the function.
    real_slope: Arguments<Dual64>,
    slope: Arguments<Dual<T>>,
    /// Arguments for evaluations of only the value of the function.
    plain: Arguments<f64>,
}

impl<T> Default for WatchSampler<T> {
    fn default() -> Self {
        let (samples, real, lifted) = Default::default();
        let (real_slope, slope, plain) = Default::default();
        WatchSampler { samples, real, lifted, real_slope, slope, plain }
    }
}

impl<T: Scalar> WatchSampler<T> {
    /// Computes the value and the slope of the watched function at both ends of the step, without
    /// evaluating the vector field; the sample at the start is computed only if it is unknown.
    /// Returns `None` for a Rosenbrock method, which does not provide time derivatives.
    pub fn ends<F: FieldIn<S>, S: Scalar, W: Watchable<T>>(
        &mut self,
        step: &Step<F, S>,
        watch: &W,
        start: Option<Sample>,
    ) -> Option<[Sample; 2]> {
        let end = step.scheme.tableau()?.end();
        let (stages, h, motion) = (&step.buffers.stages, step.h, step.motion);
        let mut sample = |fraction: f64, x: &[S], stage: usize| {
            let slopes = stages.slope(stage);
            let state = |i: usize| Dual64::new(x[i].real(), slopes[i].real() * h);
            let value = match watch.state_index() {
                Some(i) => state(i),
                None => {
                    let rate = motion.length.real() * h;
                    let time = Dual64::new(step.time(S::constant(fraction)).real(), rate);
                    let lift = |p: S| Dual64::from(p.real());
                    self.real_slope.evaluate(watch, time, motion.p, lift, (0..x.len()).map(state))
                }
            };
            Sample { fraction, value: value.re, slope: value.eps, curvature: 0.0 }
        };
        let start = start.unwrap_or_else(|| sample(0.0, &step.buffers.x, 0));
        Some([start, sample(1.0, &stages.end, end)])
    }

    /// Returns the value of the function at the end of the step.
    pub fn end_value<F: FieldIn<S>, S: Scalar, W: Watchable<T>>(
        &mut self,
        step: &Step<F, S>,
        watch: &W,
    ) -> f64 {
        let x = &step.buffers.stages.end;
        match watch.state_index() {
            Some(i) => x[i].real(),
            None => {
                let time = step.time(S::one()).real();
                let states = x.iter().map(|x| x.real());
                self.plain.evaluate(watch, time, step.motion.p, |p: S| p.real(), states)
            }
        }
    }

    /// Evaluates the watched function, in any scalar type, on dense output with coefficients that
    /// must already be computed.
    fn interpolated<F: FieldIn<T>, W: Watchable<T> + WatchIn<S>, S: Scalar>(
        arguments: &mut Arguments<S>,
        step: &Step<F, T>,
        watch: &W,
        theta: S,
        lift: impl Fn(T) -> S + Copy,
    ) -> S {
        match watch.state_index() {
            Some(i) => step.interpolated(i, theta, lift),
            None => {
                let motion = step.motion;
                let time = lift(motion.start) + lift(motion.length) * (theta * step.h + step.sigma);
                let states = (0..step.start().len()).map(|i| step.interpolated(i, theta, lift));
                arguments.evaluate(watch, time, motion.p, lift, states)
            }
        }
    }

    /// Samples the function on dense output at a fraction of the step.
    pub fn sample<F: FieldIn<T>, W: Watchable<T>>(
        &mut self,
        step: &Step<F, T>,
        watch: &W,
        fraction: f64,
    ) -> Sample {
        let theta = Dual2_64::new(fraction, 1.0, 0.0);
        let lift = |number: T| Dual2_64::from(number.real());
        let value = Self::interpolated(&mut self.real, step, watch, theta, lift);
        Sample { fraction, value: value.re, slope: value.v1, curvature: value.v2 }
    }

    /// Computes the curvature of the function on dense output, including all second derivatives.
    pub fn curvature<F: FieldIn<T>, W: Watchable<T>>(
        &mut self,
        step: &Step<F, T>,
        watch: &W,
        fraction: f64,
    ) -> T {
        let theta = Dual2::new(T::constant(fraction), T::one(), T::zero());
        Self::interpolated(&mut self.lifted, step, watch, theta, Dual2::from_re).v2
    }

    /// Computes value and slope at a fraction of the step by a shorter step, to the accuracy of the
    /// method.
    pub fn exact<F: FieldIn<T>, W: Watchable<T>>(
        &mut self,
        step: &mut Step<F, T>,
        watch: &W,
        theta: T,
    ) -> (T, T) {
        let (h, time, motion) = (step.h, step.time(theta), step.motion);
        let (x, slopes) = step.exact(theta);
        if let Some(i) = watch.state_index() {
            return (x[i], slopes[i] * h);
        }
        let along = |value: T, rate: T| Dual::new(value, rate * h);
        let time = along(time, motion.length);
        let states = x.iter().zip(slopes).map(|(x, slope)| along(*x, *slope));
        let value = self.slope.evaluate(watch, time, motion.p, Dual::from_re, states);
        (value.re, value.eps)
    }

    /// Samples the step so densely that at most one extremum lies between two samples: in equal parts
    /// unless `brief` is set, and additionally at points where the slope approaches zero and then
    /// moves away from zero.
    pub fn survey<F: FieldIn<T>, W: Watchable<T>>(
        &mut self,
        step: &mut Step<F, T>,
        watch: &W,
        brief: bool,
    ) {
        step.prepare();
        let parts = if brief { 1 } else { PARTS };
        let mut left = self.sample(step, watch, 0.0);
        self.samples.clear();
        self.samples.push(left);
        for part in 1..=parts {
            let right = self.sample(step, watch, part as f64 / parts as f64);
            let (near, away) = (left.approaches(), !right.approaches());
            if !brief && left.slope * right.slope > 0.0 && near && away {
                let turn = self.root(step, watch, [left, right], |sample| (sample.curvature, None));
                self.samples.push(turn);
            }
            self.samples.push(right);
            left = right;
        }
    }

    /// Finds the sign change of a quantity between two samples: by Newton's method within the bracket
    /// if the derivative of the quantity is known, otherwise by false position (the Illinois variant,
    /// which does not stall at one end). Returns the second sample if the sign does not change.
    pub fn root<F: FieldIn<T>, W: Watchable<T>>(
        &mut self,
        step: &Step<F, T>,
        watch: &W,
        [left, right]: [Sample; 2],
        quantity: impl Fn(&Sample) -> (f64, Option<f64>),
    ) -> Sample {
        let (mut low, mut high) =
            ((left.fraction, quantity(&left).0), (right.fraction, quantity(&right).0));
        if low.1 * high.1 >= 0.0 {
            return right;
        }
        let (mut middle, mut newton) = (right, None);
        for _ in 0..ROUNDS {
            let inside = |place: &f64| (place - low.0) * (place - high.0) < 0.0;
            let secant = (low.0 * high.1 - high.0 * low.1) / (high.1 - low.1);
            let fraction = newton.filter(inside).unwrap_or(secant);
            let change = fraction - middle.fraction;
            middle = self.sample(step, watch, fraction);
            let (value, slope) = quantity(&middle);
            // Accurate enough as a start of Newton's method on shorter steps.
            if change.abs() < 1e-6 || value == 0.0 {
                break;
            }
            newton = slope.map(|slope| fraction - value / slope);
            if value * high.1 < 0.0 {
                low = high;
            } else {
                low.1 *= 0.5;
            }
            high = (fraction, value);
        }
        middle
    }
}

/// Returns the slopes at the start, in the middle and at the end of the cubic through both ends of
/// the step.
pub(super) fn slopes([first, last]: &[Sample; 2]) -> [f64; 3] {
    let rise = last.value - first.value;
    [first.slope, 1.5 * rise - 0.25 * (first.slope + last.slope), last.slope]
}

/// Whether the slopes at three points of a step have the same sign, and absolute values within a
/// factor of five.
pub(super) fn keep_clear_of_zero(slopes: &[f64; 3]) -> bool {
    let least = slopes.iter().fold(f64::INFINITY, |least, s| least.min(s.abs()));
    let most = largest(slopes);
    slopes.iter().all(|s| s * slopes[2] > 0.0) && 5.0 * least > most
}

/// Whether the slopes at three points of a step change sign once, at a rate that varies by less
/// than a factor of three.
pub(super) fn crosses_once(slopes: &[f64; 3]) -> bool {
    let rates = [slopes[1] - slopes[0], slopes[2] - slopes[1]];
    let [a, b] = rates.map(f64::abs);
    slopes[0] * slopes[2] < 0.0 && rates[0] * rates[1] > 0.0 && a < 3.0 * b && b < 3.0 * a
}
