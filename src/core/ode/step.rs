//! Accepted steps, as they are passed to observers: the ends of a step, and all states within the
//! step.

use super::motion::Motion;
use super::rodas;
use super::rosenbrock::Linearisation;
use super::settings::Scheme;
use super::stages::{Stages, combine};
use crate::core::linalg::refill;
use crate::core::numerics::gauss_legendre;
use crate::core::problem::{FieldIn, Watchable};
use crate::core::scalar::Scalar;
use std::sync::LazyLock;

/// The buffers of a step.
pub(super) struct Buffers<T: Scalar> {
    /// The state at the start of the step.
    pub x: Vec<T>,
    /// The unit of each state's absolute tolerance.
    pub scales: Vec<f64>,
    /// The step.
    pub stages: Stages<T>,
    /// A part of the step that was recomputed as a shorter step.
    pub partial: Stages<T>,
    /// The linearisation of the vector field at the start of the step (for Rosenbrock methods).
    pub linear: Linearisation<T>,
    /// The coefficients of dense output: `n` numbers for each power.
    pub dense: Vec<T>,
    /// The time derivatives at the end of the recomputed part `partial`.
    pub slopes: Vec<T>,
}

/// The known results of a step, in addition to its stages.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Known {
    /// Whether the coefficients of dense output are computed.
    interpolant: bool,
    /// The fraction of the step at which the state and its time derivative were last computed
    /// exactly; used only for real numbers.
    exact: Option<f64>,
}

impl Known {
    /// Creates the record of the known results for a step whose state and time derivative are known
    /// exactly at a fraction of the step.
    pub fn at(fraction: f64) -> Self {
        Known { exact: Some(fraction), ..Known::default() }
    }
}

impl<T: Scalar> Default for Buffers<T> {
    fn default() -> Self {
        let (x, scales, dense, slopes) = Default::default();
        let (stages, partial, linear) = Default::default();
        Buffers { x, scales, stages, partial, linear, dense, slopes }
    }
}

/// Heuristic: a state is monotone in a step if the smallest of its derivatives at all stages is
/// more than this fraction of the largest.
const CLEAR: f64 = 0.05;

/// Heuristic: two positions in a step, as fractions of the step, count as equal for the polynomials
/// of dense output if their distance is smaller than this.
const NEAR: f64 = 1e-4;

/// Rounding: Over a distance less than this fraction of the step, a method of order 2 is exact up
/// to rounding errors: its error is a twelfth of the third power of the distance.
pub(super) const CLOSE: f64 = 1e-5;

/// The largest value of `θ⁴ (1 − θ)³`, the last term of dense output.
const LAST_TERM: f64 = 256.0 * 27.0 / 823_543.0;

/// The nodes and weights of a Gauss rule on the interval from 0 to 1. On an integration step, the
/// error of this rule is smaller than the error of the step, at any tolerance.
static GAUSS: LazyLock<Vec<[f64; 2]>> = LazyLock::new(|| {
    let (places, weights) = gauss_legendre(6);
    places.iter().zip(weights).map(|(y, w)| [0.5 * (1.0 + y), 0.5 * w]).collect()
});

/// The buffers of a step of real numbers, copied from a step of dual numbers.
#[derive(Default)]
pub(in crate::core) struct RealStep {
    buffers: Buffers<f64>,
    p: Vec<f64>,
    /// The position `σ` at the start of the step that was copied last, and the known results of
    /// this step.
    copied: Option<(f64, Known)>,
}

impl RealStep {
    /// Discards the copied step when a new flow begins.
    pub fn restart(&mut self) {
        self.copied = None;
    }
}

/// One accepted step of a flow, from `σ` to `σ + h`.
///
/// A fraction of the step is a position in it, from 0 (start of the step) to 1 (end of the step). A
/// fraction can carry derivatives, for instance the derivatives of an event's time with respect to
/// parameters.
pub struct Step<'a, F, T: Scalar> {
    pub(super) motion: &'a Motion<'a, F, T>,
    pub(super) scheme: Scheme,
    /// The absolute tolerance of the flow.
    pub(super) tolerance: f64,
    pub(super) sigma: f64,
    pub(super) h: f64,
    pub(super) buffers: &'a mut Buffers<T>,
    pub(super) known: Known,
}

/// Evaluates `F₀ θ + F₁ θ (1 − θ) + F₂ θ² (1 − θ) + F₃ θ² (1 − θ)² + …`: dense output in the form of
/// Hairer, Nørsett and Wanner (1993), section II.6, with the last coefficient first.
fn nested<S: Scalar>(coefficients: impl Iterator<Item = (usize, S)>, theta: S) -> S {
    coefficients.fold(S::zero(), |sum, (power, coefficient)| {
        let factor = if power % 2 == 0 { theta } else { S::one() - theta };
        (sum + coefficient) * factor
    })
}

impl<'a, F: FieldIn<T>, T: Scalar> Step<'a, F, T> {
    /// Returns the start and the end of the step, as fractions of the flow.
    pub fn span(&self) -> (f64, f64) {
        (self.sigma, self.sigma + self.h)
    }

    /// Returns the length of the step, as a fraction of the duration of the flow.
    pub fn length(&self) -> f64 {
        self.h
    }

    /// Returns the position in the flow (from 0 to 1) of a fraction of the step.
    pub fn place(&self, fraction: T) -> T {
        fraction * self.h + self.sigma
    }

    /// Returns the time at a fraction of the step.
    pub fn time(&self, fraction: T) -> T {
        self.motion.start + self.motion.length * self.place(fraction)
    }

    /// Returns the state at the start of the step.
    pub fn start(&self) -> &[T] {
        &self.buffers.x
    }

    /// Returns the state at the end of the step.
    pub fn end(&self) -> &[T] {
        &self.buffers.stages.end
    }

    /// Computes the state at a fraction of the step by dense output: for the method of order 8, the
    /// dense output has order 7 and costs three evaluations of the vector field per step; for the
    /// methods of order 5, it has order 4 and costs no evaluations.
    pub fn interpolate(&mut self, fraction: T, x: &mut [T]) {
        self.prepare();
        for (i, x) in x.iter_mut().enumerate() {
            *x = self.interpolated(i, fraction, |coefficient| coefficient);
        }
    }

    /// Computes the state at a fraction of the step by a shorter step of the same method: the
    /// result has the method's order of accuracy, at the cost of a step.
    pub fn state(&mut self, fraction: T, x: &mut [T]) {
        match self.met_within(CLOSE, fraction) {
            Some(_) => {
                self.exact(fraction);
            }
            None => {
                self.shorten(fraction);
                self.known.exact = None;
            }
        }
        x.copy_from_slice(&self.buffers.partial.end);
    }

    /// Calls `visit` for each node of a Gauss rule for the integral over the first part of
    /// the step, up to the fraction `end`, with the weight (in units of time), the time and the state
    /// of the node.
    pub fn quadrature(&mut self, end: f64, mut visit: impl FnMut(T, T, &[T])) {
        let mut x = self.buffers.x.clone();
        for [place, weight] in GAUSS.iter() {
            self.interpolate(T::constant(end * place), &mut x);
            let time = self.time(T::constant(end * place));
            visit(self.motion.length * (self.h * end * weight), time, &x);
        }
    }

    /// Returns the start time, the duration and the parameters of the flow.
    pub(in crate::core) fn flow(&self) -> (T, T, &'a [T]) {
        (self.motion.start, self.motion.length, self.motion.p)
    }

    /// Recomputes the part of the step up to a fraction.
    fn shorten(&mut self, fraction: T) {
        let (sigma, h) = (self.sigma, self.h);
        let motion = self.motion.slowed(sigma, fraction);
        let Buffers { x: start, stages, partial, linear, .. } = &mut *self.buffers;
        match self.scheme.tableau() {
            Some(tableau) => {
                for (slow, k) in partial.slope_mut(0).iter_mut().zip(stages.slope(0)) {
                    *slow = *k * fraction;
                }
                partial.advance(tableau, &motion, (0.0, h), start);
            }
            None => {
                // A shorter step has a matrix farther from singular.
                partial.advance_linearised(linear, &motion, fraction, (0.0, h), start);
            }
        }
    }

    /// Computes the state and its time derivative at a fraction of the step by a shorter step of
    /// the same method.
    pub(super) fn exact(&mut self, fraction: T) -> (&[T], &[T]) {
        match self.met_within(CLOSE, fraction) {
            Some(met) if met == fraction.real() => {}
            Some(met) => self.move_from(met, fraction),
            None => {
                self.shorten(fraction);
                let time = self.time(fraction);
                let Buffers { x, partial, slopes, .. } = &mut *self.buffers;
                slopes.resize(x.len(), T::zero());
                self.motion.slope_at(time, &partial.end, slopes);
            }
        }
        self.known.exact = Some(fraction.real());
        (&self.buffers.partial.end, &self.buffers.slopes)
    }

    /// Moves the exactly known state to a nearby fraction of the step, by a step of Heun's method.
    fn move_from(&mut self, met: f64, fraction: T) {
        let (h, time) = ((fraction - met) * self.h, self.time(fraction));
        let Buffers { partial, slopes, .. } = &mut *self.buffers;
        let (argument, end) = (&mut partial.argument, &mut partial.end);
        for ((argument, end), slope) in argument.iter_mut().zip(&mut *end).zip(&*slopes) {
            *argument = *end + *slope * h;
            *end += *slope * h * 0.5;
        }
        self.motion.slope_at(time, argument, slopes);
        end.iter_mut().zip(slopes).for_each(|(end, slope)| *end += *slope * h * 0.5);
    }

    /// For real numbers, returns the fraction of the step at which the state was last computed
    /// exactly, if it lies within a given distance of `fraction`.
    fn met_within(&self, distance: f64, fraction: T) -> Option<f64> {
        self.known.exact.filter(|met| T::NDERIV == 0 && (met - fraction.real()).abs() <= distance)
    }

    /// For real numbers, returns the fraction of the step at which the state was last computed
    /// exactly, if it is very near to `fraction`.
    pub(super) fn met_near(&self, fraction: f64) -> Option<f64> {
        self.met_within(NEAR, T::constant(fraction))
    }

    /// Whether the derivatives of a state at all stages of an explicit step have the same sign and
    /// are not close to zero. Since the stages are close together, such a state has no extremum
    /// between them.
    pub(super) fn keeps_direction(&self, state: usize) -> bool {
        let Some(tableau) = self.scheme.tableau() else { return false };
        let (n, slopes) = (self.buffers.x.len(), &self.buffers.stages.slopes);
        let of_state = slopes[state..(tableau.end() + 1) * n].iter().step_by(n).map(T::real);
        let outermost = |(least, most): (f64, f64), slope| (least.min(slope), most.max(slope));
        let (least, most) = of_state.fold((f64::INFINITY, f64::NEG_INFINITY), outermost);
        least > CLEAR * most || most < CLEAR * least
    }

    /// Passes the real parts of this step of an explicit method, as a step of real numbers, to
    /// `show`.
    pub(in crate::core) fn without_derivatives(
        &self,
        real: &mut RealStep,
        show: impl FnOnce(&mut Step<F::Real<'_>, f64>),
    ) {
        let Some(tableau) = self.scheme.tableau() else { return };
        let known = match real.copied {
            Some((sigma, known)) if sigma == self.sigma => known,
            _ => self.copy_to(real, (tableau.end() + 1) * self.buffers.x.len()),
        };
        let RealStep { buffers, p, copied } = real;
        let Motion { field, evaluations, .. } = *self.motion;
        let (start, length) = (self.motion.start.real(), self.motion.length.real());
        let motion = &Motion { field: &field.real(), start, length, p, evaluations };
        let (scheme, tolerance, sigma, h) = (self.scheme, self.tolerance, self.sigma, self.h);
        let mut step = Step { motion, scheme, tolerance, sigma, h, buffers, known };
        show(&mut step);
        *copied = Some((sigma, step.known));
    }

    /// Copies the real parts of the states, of the parameters and of the first `slopes` stage
    /// derivatives of the step.
    fn copy_to(&self, real: &mut RealStep, slopes: usize) -> Known {
        let (Buffers { x, scales, stages, .. }, RealStep { buffers, p, .. }) =
            (&*self.buffers, real);
        let copy = |from: &[T], to: &mut Vec<f64>| {
            refill(to, from.iter().map(T::real));
        };
        buffers.scales.clone_from(scales);
        copy(&stages.slopes[..slopes], &mut buffers.stages.slopes);
        copy(&stages.end, &mut buffers.stages.end);
        copy(x, &mut buffers.x);
        copy(self.motion.p, p);
        buffers.stages.resize(x.len());
        buffers.partial.resize(x.len());
        Known::default()
    }

    /// Returns the unit of the tolerances for values of a watched function.
    pub(super) fn scale_of<S: Scalar, W: Watchable<S>>(&self, watch: &W) -> f64 {
        watch.state_index().map_or_else(|| watch.size(), |state| self.buffers.scales[state])
    }

    /// Evaluates state `i` at a fraction of the step by dense output, in any scalar type to which the
    /// coefficients can be lifted. Requires [`prepare`](Self::prepare).
    pub(super) fn interpolated<S: Scalar>(&self, i: usize, theta: S, lift: impl Fn(T) -> S) -> S {
        let n = self.buffers.x.len();
        let powers = self.buffers.dense.len() / n;
        let coefficients =
            (0..powers).rev().map(|power| (power, lift(self.buffers.dense[power * n + i])));
        nested(coefficients, theta) + lift(self.buffers.x[i])
    }

    /// Whether the dense output of a state is as accurate as the flow: its last term is below ten
    /// tolerances, and its error is a small fraction of its last term. Requires
    /// [`prepare`](Self::prepare).
    pub(super) fn is_dense_enough(&self, state: usize) -> bool {
        let n = self.buffers.x.len();
        let last = self.buffers.dense[self.buffers.dense.len() - n + state].real().abs();
        self.scheme.order() == 8
            && LAST_TERM * last <= 10.0 * self.tolerance * self.buffers.scales[state]
    }

    /// Computes the coefficients of dense output, once per step.
    pub(super) fn prepare(&mut self) {
        if !self.known.interpolant {
            match self.scheme.tableau() {
                Some(_) => self.prepare_explicit(),
                None => self.prepare_linearised(),
            }
            self.known.interpolant = true;
        }
    }

    fn prepare_explicit(&mut self) {
        let Some(tableau) = self.scheme.tableau() else { return };
        let (sigma, h) = (self.sigma, self.h);
        let Buffers { x, stages, partial, dense, .. } = &mut *self.buffers;
        let n = x.len();
        let rows = tableau.extra_rows.iter().zip(tableau.extra_nodes);
        for (i, (row, node)) in rows.enumerate() {
            combine(x, h, row, &stages.slopes, &mut partial.argument);
            let slope = stages.slope_mut(tableau.end() + 1 + i);
            self.motion.slope(sigma + node * h, &partial.argument, slope);
        }
        dense.resize((3 + tableau.dense.len()) * n, T::zero());
        for i in 0..n {
            let change = stages.end[i] - x[i];
            let hermite = stages.slope(0)[i] * h - change;
            dense[i] = change;
            dense[n + i] = hermite;
            dense[2 * n + i] = change - stages.slope(tableau.end())[i] * h - hermite;
            for (power, row) in tableau.dense.iter().enumerate() {
                let terms = row.iter().map(|(j, d)| stages.slope(*j)[i] * (h * d));
                dense[(3 + power) * n + i] = terms.fold(T::zero(), |sum, term| sum + term);
            }
        }
    }

    fn prepare_linearised(&mut self) {
        let Buffers { x, stages, dense, .. } = &mut *self.buffers;
        let n = x.len();
        dense.resize(4 * n, T::zero());
        for i in 0..n {
            let sum = |row: &[f64]| {
                let terms = row.iter().enumerate().map(|(j, h)| stages.slope(j)[i] * *h);
                terms.fold(T::zero(), |sum, term| sum + term)
            };
            let [first, second, third] = [0, 1, 2].map(|power| sum(&rodas::DENSE[power]));
            dense[i] = stages.end[i] - x[i];
            dense[n + i] = first;
            dense[2 * n + i] = second + third;
            dense[3 * n + i] = -third;
        }
    }
}
