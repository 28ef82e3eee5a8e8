//! Extrema of a state along a flow.

use super::step::Step;
use crate::core::field::VectorField;
use crate::core::scalar::Scalar;
use num_dual::{Dual2, Dual2_64};

/// A local extremum of a state.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Extremum<T> {
    /// Where it is in the flow, from 0 to 1.
    pub place: T,
    /// The value of the state.
    pub value: T,
}

/// In how many parts a step is searched for changes of sign of the slope.
const PARTS: usize = 8;
/// How many times an extremum is improved at most.
const ROUNDS: usize = 12;
/// After a change of place by this part of a step, the parabola through it is the solution to rounding.
const SETTLED: f64 = 1e-5;

/// The search for all local extrema of one state, step by step: to be called by the observer of a flow.
///
/// Where the slope of dense output changes its sign, `dx_i/dσ = 0` is solved on a shorter step of the method,
/// so that place and value have the accuracy of the flow, and the derivatives of both are those of the
/// extremum: its place moves with parameters. Two extrema in one eighth of a step are found where the slope
/// of dense output shows that it comes near to zero and turns away. The ends of the flow are not counted.
///
/// ```
/// use std::ops::ControlFlow;
/// use tangency::core::flow::{Extrema, Extremum, Flow, Settings};
/// # use tangency::core::{field::VectorField, scalar::Scalar, zero::Names};
/// # struct Oscillator;
/// # impl VectorField for Oscillator {
/// #     fn names(&self) -> Names { Names::new(["x", "v"], ["frequency"]) }
/// #     fn field<T: Scalar>(&self, _t: T, x: &[T], p: &[T], f: &mut [T]) {
/// #         f[0] = x[1];
/// #         f[1] = -p[0] * p[0] * x[0];
/// #     }
/// # }
/// // x = sin t has its extrema at t = π/2 and 3π/2.
/// let mut flow = Flow::new(Settings::default()).unwrap();
/// let (mut extrema, mut found) = (Extrema::of(0), Vec::<Extremum<f64>>::new());
/// flow.observe(&Oscillator, 0.0, 6.0, &mut [0.0, 1.0], &[1.0], |step| {
///     extrema.search(step, |extremum| found.push(extremum));
///     ControlFlow::Continue(())
/// }).unwrap();
/// assert_eq!(found.len(), 2);
/// assert!((found[0].value - 1.0).abs() < 1e-12 && (found[1].value + 1.0).abs() < 1e-12);
/// assert!((6.0 * found[0].place - std::f64::consts::FRAC_PI_2).abs() < 1e-12);
/// ```
#[derive(Clone, Debug)]
pub struct Extrema<T> {
    state: usize,
    /// The last slope that was not zero.
    slope: f64,
    x: Vec<T>,
    slopes: Vec<T>,
}

impl<T: Scalar> Extrema<T> {
    /// A search for the extrema of a state.
    pub fn of(state: usize) -> Self {
        Extrema { state, slope: 0.0, x: Vec::new(), slopes: Vec::new() }
    }

    /// Begins a new flow, in which the extrema of another state may be sought.
    pub fn restart(&mut self, state: usize) {
        (self.state, self.slope) = (state, 0.0);
    }

    /// Calls `visit` with every extremum in a step, in their order.
    pub fn search<F: VectorField>(
        &mut self,
        step: &mut Step<F, T>,
        mut visit: impl FnMut(Extremum<T>),
    ) {
        let slopes = step.slopes(self.state);
        if let Some([_, _, last]) = slopes.filter(keep_clear_of_zero)
            && self.slope * last >= 0.0
        {
            self.slope = last;
            return;
        }
        step.prepare();
        if slopes.is_some_and(|slopes| crosses_once(&slopes)) {
            let [left, right] = [0.0, 1.0].map(|place| Sample::of(step, self.state, place));
            self.pass(step, left, left, &mut visit);
            self.pass(step, left, right, &mut visit);
            return;
        }
        let mut left = Sample::of(step, self.state, 0.0);
        self.pass(step, left, left, &mut visit);
        for part in 1..=PARTS {
            let right = Sample::of(step, self.state, part as f64 / PARTS as f64);
            if left.slope * right.slope > 0.0 && left.approaches() && !right.approaches() {
                let turn = Sample::root(step, self.state, left, right, |sample| sample.curvature);
                self.pass(step, left, turn, &mut visit);
                left = turn;
            }
            self.pass(step, left, right, &mut visit);
            left = right;
        }
    }

    /// Goes on from one sample to the next: a slope of the other sign than the last one that was not zero
    /// tells an extremum.
    fn pass<F: VectorField>(
        &mut self,
        step: &mut Step<F, T>,
        left: Sample,
        right: Sample,
        visit: &mut impl FnMut(Extremum<T>),
    ) {
        if self.slope * right.slope < 0.0 {
            let root = Sample::root(step, self.state, left, right, |sample| sample.slope);
            visit(self.improve(step, root.fraction));
        }
        if right.slope != 0.0 {
            self.slope = right.slope;
        }
    }

    /// Newton's method for `dx_i/dθ = 0` on shorter steps, with the curvature of dense output: every round
    /// gains the digits that dense output has, and one order of derivatives.
    fn improve<F: VectorField>(&mut self, step: &mut Step<F, T>, guess: f64) -> Extremum<T> {
        let (i, n) = (self.state, step.start().len());
        self.x.resize(n, T::zero());
        self.slopes.resize(n, T::zero());
        let start = T::constant(guess);
        let place = Dual2::new(start, T::one(), T::zero());
        let curvature = step.interpolated(i, place, Dual2::from_re).v2;
        let mut theta = start;
        let mut value = T::zero();
        for round in 0..ROUNDS {
            step.state(theta, &mut self.x);
            step.slope(theta, &self.x, &mut self.slopes);
            let slope = self.slopes[i] * step.length();
            let change = slope / curvature;
            value = self.x[i];
            let strayed = (theta - change - guess).real().abs() > 1.0 / PARTS as f64;
            if strayed || !change.real().is_finite() {
                break;
            }
            theta -= change;
            // On the parabola, the rest of the way changes the value by half the slope times it.
            value -= slope * change * 0.5;
            if change.real().abs() < SETTLED && round >= T::NDERIV {
                break;
            }
        }
        Extremum { place: step.place(theta), value }
    }
}

/// Whether slopes in three places of a step have one sign and sizes that differ by less than five times.
fn keep_clear_of_zero(slopes: &[f64; 3]) -> bool {
    let least = slopes.iter().fold(f64::INFINITY, |least, s| least.min(s.abs()));
    let most = slopes.iter().fold(0.0, |most: f64, s| most.max(s.abs()));
    slopes.iter().all(|s| s * slopes[2] > 0.0) && 5.0 * least > most
}

/// Whether slopes in three places of a step change their sign once, at a rate that changes by less than
/// three times.
fn crosses_once(slopes: &[f64; 3]) -> bool {
    let rates = [slopes[1] - slopes[0], slopes[2] - slopes[1]];
    let [a, b] = rates.map(f64::abs);
    slopes[0] * slopes[2] < 0.0 && rates[0] * rates[1] > 0.0 && a < 3.0 * b && b < 3.0 * a
}

/// Slope and curvature of dense output of a state at a fraction of the step.
#[derive(Clone, Copy)]
struct Sample {
    fraction: f64,
    slope: f64,
    curvature: f64,
}

impl Sample {
    fn of<F: VectorField, T: Scalar>(step: &Step<F, T>, state: usize, fraction: f64) -> Self {
        let place = Dual2_64::new(fraction, 1.0, 0.0);
        let x = step.interpolated(state, place, |coefficient| coefficient.real().into());
        Sample { fraction, slope: x.v1, curvature: x.v2 }
    }

    /// Whether the slope becomes smaller in size.
    fn approaches(&self) -> bool {
        self.slope * self.curvature < 0.0
    }

    /// Where a quantity changes its sign between two samples, by false position (of the Illinois kind, which
    /// does not stall at one end); `right` if it does not.
    fn root<F: VectorField, T: Scalar>(
        step: &Step<F, T>,
        state: usize,
        left: Sample,
        right: Sample,
        quantity: impl Fn(&Sample) -> f64,
    ) -> Self {
        let (mut low, mut high) =
            ((left.fraction, quantity(&left)), (right.fraction, quantity(&right)));
        if low.1 * high.1 >= 0.0 {
            return right;
        }
        let mut middle = right;
        for _ in 0..ROUNDS {
            let fraction = (low.0 * high.1 - high.0 * low.1) / (high.1 - low.1);
            let change = fraction - middle.fraction;
            middle = Sample::of(step, state, fraction);
            let value = quantity(&middle);
            // Good enough for Newton's method on shorter steps.
            if change.abs() < 1e-6 || value == 0.0 {
                break;
            }
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
