//! Event location along a flow: the downward zero crossings of watched functions.

use super::extrema::improved;
use super::step::Step;
use super::watch_sampler::{Sample, WatchSampler, crosses_once, keep_clear_of_zero, slopes};
use crate::core::linalg::largest;
use crate::core::problem::{FieldIn, Watchable};
use crate::core::scalar::Scalar;
use std::ops::ControlFlow;

/// A downward zero crossing of a watched function.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Root<T> {
    /// The position of the root in the step, from 0 to 1; negative if the root lies in an earlier
    /// step.
    pub fraction: T,
    /// The rate `dh/dt` of the watched function at the root, which is zero or negative.
    pub rate: T,
}

/// Rounding: values of a watched function up to this size (a few hundred ε), in units of the
/// function's scale, count as zero at the start of a flow. A function that starts at zero counts as
/// positive only after it exceeds this size, and as negative only after it decreases by this size.
pub(super) const ZERO: f64 = 1e-13;
/// Discretisation: if a watched function is below minus this value, in units of its scale, at the
/// start of a flow, the function crossed zero before the start. At a located event, the function is
/// zero only up to the tolerance of the flow, which is usually smaller than this value by a factor
/// of 1e3.
pub(crate) const NEGATIVE: f64 = 1e-9;
/// Rounding: the largest number of iterations for a root: the same number of bisections reduces a
/// step to rounding errors.
const ROUNDS: usize = 60;
/// Rounding: the iteration for a root of dense output ends when the root changes by less than this
/// fraction of a step.
const SETTLED: f64 = 4.0 * f64::EPSILON;
/// Heuristic: if the changes of a root in successive iterations are below this fraction of a step,
/// the iteration also ends when these changes no longer decrease: close to a tangency, even a
/// rounding error of the function's value changes the root considerably.
const NEAR: f64 = 1e-6;
/// Discretisation: an extremum is close to zero if its value is smaller than this, in units of the
/// change of the function about the extremum. The sign of such an extremum is decided only after
/// the extremum is computed to the method's accuracy, because the error of dense output is smaller
/// than this bound.
const TANGENT: f64 = 1e-3;

/// Heuristic: a function is far from zero if its value is more than this multiple of its changes in
/// the current and in the previous step.
const FAR: f64 = 10.0;

/// The known sign of a watched function during a flow.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::core) enum Sign {
    /// The sign is unknown, because the flow begins.
    Unknown,
    /// The watched function has been positive: its next downward zero crossing counts as a root.
    Positive,
    /// The watched function was zero at the start of the flow and has not been positive since;
    /// `level` is its largest value so far, and `top` is the position of this value in the flow.
    Zero { level: f64, top: f64 },
    /// The watched function has crossed zero downwards: another crossing counts as a root only
    /// after the function has been positive.
    Fallen,
}

/// The search for all downward zero crossings of one watched function, step by step. The observer of a
/// flow must call the search with the same function in all steps. Upward crossings of a function are
/// found as downward crossings of its negative.
///
/// Between extrema on dense output, a function is monotone, so that its signs at the extrema
/// bracket a root even if the function becomes negative only briefly within one step. An extremum
/// close to zero is first computed to the accuracy of the method. The root and its derivatives are
/// computed on shorter steps of the method.
///
/// A function that is zero at the start of the flow has a root at the start if it decreases; if it
/// does not decrease, it must become positive before a root counts. If the decrease is detected only
/// in a later step, the root lies before that step, at a negative fraction of the step.
///
/// ```
/// use std::ops::ControlFlow;
/// use tangency::core::ode::{Flow, Roots, Settings};
/// # use tangency::core::hybrid::InMode;
/// # use tangency::core::problem::Watch;
/// # use tangency::core::scalar::Scalar;
/// # use tangency::problems::classic::ImpactOscillator;
/// # let oscillator = InMode { system: &ImpactOscillator, mode: ImpactOscillator::FLIGHT };
/// /// Negative for a short while near the maximum of `x`.
/// struct Dip;
/// impl Watch for Dip {
///     fn value<T: Scalar>(&self, _t: T, x: &[T], _p: &[T]) -> T {
///         -x[0] + 0.995
///     }
/// }
/// // x = sin t.
/// let mut flow = Flow::<f64>::new(Settings::default()).unwrap();
/// let (mut roots, mut found) = (Roots::default(), Vec::new());
/// flow.observe(&oscillator, 0.0, 3.0, &mut [0.0, 1.0], &[0.0, 1.0, 1.0, 0.0, 9.0], |step| {
///     roots.search(&Dip, step, |step, root| {
///         found.push((step.time(root.fraction), root.rate));
///         ControlFlow::Continue(())
///     })
/// }).unwrap();
/// assert_eq!(found.len(), 1);
/// assert!((found[0].0 - 0.995_f64.asin()).abs() < 1e-11 && (found[0].1 + 0.995_f64.asin().cos()).abs() < 1e-11);
/// ```
#[derive(Clone, Debug)]
pub struct Roots<T> {
    sign: Sign,
    /// The sample at the end of the last step, with the derivative with respect to the position in
    /// the flow.
    end: Option<Sample>,
    /// The value of the function at the end of the last step and its change in that step, used
    /// while the function is far from zero and its derivatives are not computed.
    far: Option<(f64, f64)>,
    /// The unit of the tolerances for values of the function.
    scale: f64,
    sampler: WatchSampler<T>,
}

impl<T: Scalar> Default for Roots<T> {
    fn default() -> Self {
        let sampler = WatchSampler::default();
        Roots { sign: Sign::Unknown, end: None, far: None, scale: 1.0, sampler }
    }
}

impl<T: Scalar> Roots<T> {
    /// Begins the search along a new flow, possibly with another function.
    pub fn restart(&mut self) {
        self.resume(Sign::Unknown);
    }

    /// Resumes the search along a flow, given the known sign of the function.
    pub(in crate::core) fn resume(&mut self, sign: Sign) {
        (self.sign, self.end, self.far) = (sign, None, None);
    }

    /// Returns the known sign of the function.
    pub(in crate::core) fn sign(&self) -> Sign {
        self.sign
    }

    /// Calls `visit` with every root in a step, in order, until `visit` returns a break.
    pub fn search<F: FieldIn<T>, W: Watchable<T>>(
        &mut self,
        watch: &W,
        step: &mut Step<F, T>,
        mut visit: impl FnMut(&mut Step<F, T>, Root<T>) -> ControlFlow<()>,
    ) -> ControlFlow<()> {
        self.scale = step.scale_of::<T, W>(watch);
        if self.stays_far(watch, step) {
            self.end = None;
            return ControlFlow::Continue(());
        }
        let start = self.end.map(|end| Sample { fraction: 0.0, slope: end.slope * step.h, ..end });
        let ends = self.sampler.ends(step, watch, start);
        self.end = ends.map(|[_, end]| Sample { slope: end.slope / step.h, ..end });
        self.far = ends.map(|[start, end]| (end.value, end.value - start.value));
        if ends.is_some_and(|ends| self.passes(&ends)) {
            return ControlFlow::Continue(());
        }
        let one_extremum = |slopes| crosses_once(&slopes) || keep_clear_of_zero(&slopes);
        let brief = ends.is_some_and(|ends| one_extremum(slopes(&ends)));
        self.sampler.survey(step, watch, brief);
        self.begin(self.sampler.samples[0].value);
        for k in 1..self.sampler.samples.len() {
            let piece = [self.sampler.samples[k - 1], self.sampler.samples[k]];
            self.pass(watch, step, piece, &mut visit)?;
        }
        ControlFlow::Continue(())
    }

    /// Whether the function can cross zero downwards in a step, in numbers of any scalar type; if
    /// it can, the step must be searched next.
    pub(in crate::core) fn may_fall<F: FieldIn<S>, S: Scalar, W: Watchable<T>>(
        &mut self,
        watch: &W,
        step: &Step<F, S>,
    ) -> bool {
        (self.scale, self.end, self.far) = (step.scale_of::<T, W>(watch), None, None);
        !self.sampler.ends(step, watch, None).is_some_and(|ends| self.passes(&ends))
    }

    /// Whether values and derivatives at the ends of a step exclude a downward zero crossing.
    fn passes(&mut self, ends: &[Sample; 2]) -> bool {
        self.begin(ends[0].value);
        self.keeps_sign(ends) || self.rises(ends)
    }

    /// Whether the function is positive and far from zero, compared with its changes in the current and
    /// the previous step, so that its derivatives are not needed.
    fn stays_far<F: FieldIn<T>, W: Watchable<T>>(&mut self, watch: &W, step: &Step<F, T>) -> bool {
        let Some((last, change)) = self.far.filter(|_| self.sign == Sign::Positive) else {
            return false;
        };
        let value = self.sampler.end_value(step, watch);
        let changed = value - last;
        let far = value.min(last) > FAR * changed.abs().max(change.abs());
        self.far = far.then_some((value, changed));
        far
    }

    /// Determines the sign of the function at the start of the flow.
    fn begin(&mut self, value: f64) {
        if self.sign == Sign::Unknown {
            self.sign = match value {
                value if value > ZERO * self.scale => Sign::Positive,
                value if value < -NEGATIVE * self.scale => Sign::Fallen,
                level => Sign::Zero { level, top: 0.0 },
            };
        }
    }

    /// Whether the function keeps its sign throughout the step, judged by its values and derivatives at
    /// the ends of the step: it is monotone, or so large that the derivatives cannot change it to zero.
    fn keeps_sign(&self, ends: &[Sample; 2]) -> bool {
        let least = match self.sign {
            Sign::Positive => ends[0].value.min(ends[1].value),
            Sign::Fallen => -ends[0].value.max(ends[1].value),
            Sign::Unknown | Sign::Zero { .. } => return false,
        };
        let slopes = slopes(ends);
        let clear = keep_clear_of_zero(&slopes) || least > largest(&slopes);
        least > ZERO * self.scale && clear
    }

    /// Whether the function increases throughout the step and is positive at the end of the step.
    fn rises(&mut self, ends: &[Sample; 2]) -> bool {
        let rises = keep_clear_of_zero(&slopes(ends))
            && ends[1].slope > 0.0
            && ends[1].value > ZERO * self.scale;
        if rises {
            self.sign = Sign::Positive;
        }
        rises
    }

    /// Proceeds from one sample to the next; if an extremum lies between the samples, proceeds
    /// first to the extremum.
    fn pass<F: FieldIn<T>, W: Watchable<T>>(
        &mut self,
        watch: &W,
        step: &mut Step<F, T>,
        [left, right]: [Sample; 2],
        visit: &mut impl FnMut(&mut Step<F, T>, Root<T>) -> ControlFlow<()>,
    ) -> ControlFlow<()> {
        if left.slope == 0.0 || left.slope * right.slope > 0.0 {
            return self.fall(watch, step, [left, right], visit);
        }
        let mut turn = self.sampler.root(step, watch, [left, right], Sample::turning);
        let change = (left.value - turn.value).abs().max((right.value - turn.value).abs());
        if turn.value.abs() < TANGENT * change {
            let (theta, value) = improved(&mut self.sampler, step, watch, turn.fraction);
            (turn.fraction, turn.value) = (theta.real(), value.real());
            if !(0.0..=1.0).contains(&(step.sigma + step.h * turn.fraction)) {
                // Before the flow begins or after it ends: if a flow starts at zero with zero slope, the
                // sign of the slope is a rounding error.
                return self.fall(watch, step, [left, right], visit);
            }
        }
        self.fall(watch, step, [left, turn], visit)?;
        self.fall(watch, step, [turn, right], visit)
    }

    /// Proceeds from one sample to another sample, where the function is monotone between them.
    fn fall<F: FieldIn<T>, W: Watchable<T>>(
        &mut self,
        watch: &W,
        step: &mut Step<F, T>,
        [left, right]: [Sample; 2],
        visit: &mut impl FnMut(&mut Step<F, T>, Root<T>) -> ControlFlow<()>,
    ) -> ControlFlow<()> {
        let root = match self.sign {
            Sign::Positive | Sign::Fallen if right.value < 0.0 && left.value > 0.0 => {
                self.between(watch, step, [left, right])
            }
            Sign::Positive if right.value < 0.0 => self.at_once(watch, step, left.fraction),
            Sign::Zero { level, top } if right.value < level - ZERO * self.scale => {
                // A small rise is followed by a fall of the same duration.
                let place = (2.0 * top).min(step.sigma + step.h * right.fraction);
                self.at_once(watch, step, (place - step.sigma) / step.h)
            }
            Sign::Zero { .. } if right.value > ZERO * self.scale => {
                self.sign = Sign::Positive;
                return ControlFlow::Continue(());
            }
            Sign::Zero { level, .. } => {
                if right.value > level {
                    let top = step.sigma + step.h * right.fraction;
                    self.sign = Sign::Zero { level: right.value, top };
                }
                return ControlFlow::Continue(());
            }
            Sign::Fallen if right.value > 0.0 => {
                self.sign = Sign::Positive;
                return ControlFlow::Continue(());
            }
            _ => return ControlFlow::Continue(()),
        };
        self.sign = Sign::Fallen;
        visit(step, root)
    }

    /// Computes the root between a positive and a negative sample by Newton's method within the bracket;
    /// the iteration starts from the root of dense output or, close to a tangency, from the root of a
    /// parabola.
    fn between<F: FieldIn<T>, W: Watchable<T>>(
        &mut self,
        watch: &W,
        step: &mut Step<F, T>,
        [left, right]: [Sample; 2],
    ) -> Root<T> {
        let parabola = right.fraction - (-2.0 * right.value / right.curvature).sqrt();
        let tangent = -right.value < TANGENT * left.value && parabola > left.fraction;
        let guess = if tangent {
            parabola
        } else {
            self.sampler.root(step, watch, [left, right], Sample::crossing).fraction
        };
        let (mut low, mut high) = (left.fraction, right.fraction);
        let (mut theta, mut last) = (guess, f64::INFINITY);
        for _ in 0..ROUNDS {
            let (value, slope) = self.sampler.exact(step, watch, T::constant(theta));
            let change = value.real() / slope.real();
            let (size, next) = (change.abs(), theta - change);
            if size <= SETTLED || (size < NEAR && 2.0 * size > last) {
                break;
            }
            *(if value.real() > 0.0 { &mut low } else { &mut high }) = theta;
            theta = if next > low && next < high { next } else { 0.5 * (low + high) };
            last = size;
        }
        self.at_once(watch, step, theta)
    }

    /// Computes the derivatives of a root whose real part is known, by Newton's method, one order
    /// of derivatives in each iteration.
    pub(in crate::core) fn at_once<F: FieldIn<T>, W: Watchable<T>>(
        &mut self,
        watch: &W,
        step: &mut Step<F, T>,
        fraction: f64,
    ) -> Root<T> {
        let mut theta = T::constant(fraction);
        for _ in 0..T::NDERIV {
            let (value, slope) = self.sampler.exact(step, watch, theta);
            let curvature = self.sampler.curvature(step, watch, fraction).real();
            // At a tangency to working accuracy, the place has no derivatives.
            if slope.real().powi(2) <= 2.0 * ZERO * self.scale * curvature.abs() {
                break;
            }
            theta -= (value - value.real()) / slope;
        }
        let (_, slope) = self.sampler.exact(step, watch, theta);
        let rate = slope / (step.motion.length * step.h);
        Root { fraction: theta, rate }
    }
}
