//! The flow of a vector field: steps from the start to the end.

use super::control::{Control, Measure, Size};
use super::error::SettingsError;
use super::motion::Motion;
use super::settings::Settings;
use super::stages::{Stages, combine};
use super::step::{Buffers, Known, Step};
use super::tableau::Tableau;
use super::{rodas, work};
use crate::core::failure::FlowError;
use crate::core::linalg::refill;
use crate::core::problem::FieldIn;
use crate::core::scalar::Scalar;
use std::cell::Cell;
use std::ops::ControlFlow;

/// The cost of a flow, as numbers of steps and evaluations.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Statistics {
    /// The number of evaluations of the vector field, in any scalar type.
    pub evaluations: usize,
    /// Accepted steps.
    pub accepted: usize,
    /// Rejected steps.
    pub rejected: usize,
}

/// A solver for the flow of vector fields in one scalar type, including all its buffers.
///
/// ```
/// use num_dual::Dual64;
/// use tangency::core::hybrid::InMode;
/// use tangency::core::ode::{Flow, Settings};
/// use tangency::problems::classic::ImpactOscillator;
/// // x' = v, v' = −x: a quarter of a period leads from (1, 0) to (0, −1).
/// let field = InMode { system: &ImpactOscillator, mode: ImpactOscillator::FLIGHT };
/// let (p, quarter) = ([0.0, 1.0, 1.0, 0.0, 9.0], std::f64::consts::FRAC_PI_2);
/// let (mut x, mut flow) = ([1.0, 0.0], Flow::<f64>::new(Settings::default()).unwrap());
/// let statistics = flow.advance(&field, 0.0, quarter, &mut x, &p).unwrap();
/// assert!(x[0].abs() < 1e-12 && (x[1] + 1.0).abs() < 1e-12 && statistics.evaluations < 130);
/// // On dual numbers: the derivative of the final state with respect to the initial x is (0, −1).
/// let mut x = [Dual64::from(1.0).derivative(), Dual64::from(0.0)];
/// let mut flow = Flow::new(Settings::default()).unwrap();
/// flow.advance(&field, 0.0.into(), quarter.into(), &mut x, &p.map(Dual64::from)).unwrap();
/// assert!(x[0].eps.abs() < 1e-12 && (x[1].eps + 1.0).abs() < 1e-12);
/// ```
pub struct Flow<T: Scalar> {
    pub(in crate::core) settings: Settings,
    size: Option<Size<T>>,
    size_of_small_states: Option<Size<T>>,
    pub(super) buffers: Buffers<T>,
    real: Vec<f64>,
}

impl<T: Scalar> Default for Flow<T> {
    fn default() -> Self {
        let (settings, buffers) = Default::default();
        Flow { settings, size: None, size_of_small_states: None, buffers, real: Vec::new() }
    }
}

/// Heuristic: the number of consecutive steps limited by stability after which a flow counts as
/// stiff (Hairer and Wanner).
const STIFF_STEPS: usize = 15;
/// Heuristic: Stiffness is reported only if the rest of the flow needs more than this number of
/// steps: if it needs fewer steps, changing to another method costs more than it saves.
const STIFF_REST: f64 = 500.0;

/// Rounding: the smallest step, as a fraction of the flow; it can be far below `ε`, because
/// positions near the start of the flow are numbers near zero, which have a fine resolution.
const SMALLEST_STEP: f64 = 1e-30;

impl<T: Scalar> Flow<T> {
    /// Creates a solver for flows with given settings. The first flow allocates the buffers of the
    /// solver.
    ///
    /// # Errors
    /// [`SettingsError`] if a setting is invalid.
    pub fn new(settings: Settings) -> Result<Self, SettingsError> {
        settings.check()?;
        Ok(Flow { settings, ..Flow::default() })
    }

    /// Sets a user-defined size of numbers for the step control, for instance the largest absolute
    /// value of a number and its derivatives. By default, the step control uses only real parts, so
    /// that a flow of dual numbers takes the same steps as a flow of real numbers.
    pub fn measured_by(mut self, size: Size<T>) -> Self {
        self.size = Some(size);
        self
    }

    /// Sets a size of numbers that additionally controls steps if states are small (compared with
    /// the ratio of the absolute to the relative tolerance). If a state is almost zero, as near an
    /// equilibrium at `x = 0`, the real part of a dual number cannot control the error of the
    /// derivatives, so the size of the derivatives is used.
    pub(in crate::core) fn measure_small_states_by(&mut self, size: Size<T>) {
        self.size_of_small_states = Some(size);
    }

    /// Advances the state `x` by the flow from the time `t0` for a duration `length`, which can be
    /// negative and can carry derivatives.
    ///
    /// # Errors
    /// [`FlowError`] if the trajectory ends early; `x` is then the last state of the trajectory.
    pub fn advance<F: FieldIn<T>>(
        &mut self,
        field: &F,
        t0: T,
        length: T,
        x: &mut [T],
        p: &[T],
    ) -> Result<Statistics, FlowError> {
        self.observe(field, t0, length, x, p, |_| ControlFlow::Continue(()))
    }

    /// Advances the state like [`advance`](Self::advance) and passes every accepted step to
    /// `observe`, which can end the flow. The observer can compute the state at any fraction of the
    /// step:
    ///
    /// ```
    /// use std::ops::ControlFlow;
    /// use tangency::core::ode::{Flow, Settings};
    /// use tangency::problems::classic::Lure;
    /// // In the middle of every step.
    /// let mut flow = Flow::<f64>::new(Settings::default()).unwrap();
    /// flow.observe(&Lure, 0.0, 2.0, &mut [0.1, 0.0, 0.0], &[0.8, 1.0], |step| {
    ///     let (mut dense, mut exact) = ([0.0; 3], [0.0; 3]);
    ///     step.interpolate(0.5, &mut dense);
    ///     step.state(0.5, &mut exact);
    ///     assert!((dense[0] - exact[0]).abs() < 1e-9);
    ///     ControlFlow::Continue(())
    /// }).unwrap();
    /// ```
    ///
    /// # Errors
    /// [`FlowError`] if the trajectory ends early; `x` is then the last state of the trajectory.
    pub fn observe<F: FieldIn<T>>(
        &mut self,
        field: &F,
        t0: T,
        length: T,
        x: &mut [T],
        p: &[T],
        mut observe: impl FnMut(&mut Step<F, T>) -> ControlFlow<()>,
    ) -> Result<Statistics, FlowError> {
        let evaluations = Cell::new(0);
        let motion = Motion { field, start: t0, length, p, evaluations: &evaluations };
        self.resize(field, x, p);
        let mut statistics = Statistics::default();
        let mut flown = 0.0;
        let result = self.integrate(&motion, (&mut statistics, &mut flown), &mut observe);
        x.copy_from_slice(&self.buffers.x);
        statistics.evaluations = evaluations.get();
        work::add(statistics.evaluations, flown * length.real());
        result.map(|()| statistics)
    }

    pub(super) fn resize<F: FieldIn<T>>(&mut self, field: &F, x: &[T], p: &[T]) {
        refill(&mut self.real, x.iter().chain(p).map(T::real));
        let buffers = &mut self.buffers;
        refill(&mut buffers.scales, field.state_scales(&self.real[x.len()..]));
        buffers.scales.resize(x.len(), 1.0);
        x.clone_into(&mut buffers.x);
        buffers.stages.resize(x.len());
        buffers.partial.resize(x.len());
    }

    fn integrate<F: FieldIn<T>>(
        &mut self,
        motion: &Motion<F, T>,
        (statistics, flown): (&mut Statistics, &mut f64),
        observe: &mut impl FnMut(&mut Step<F, T>) -> ControlFlow<()>,
    ) -> Result<(), FlowError> {
        let tableau = self.settings.scheme.tableau();
        let mut control = Control::new(&self.settings);
        let (mut sigma, mut stiff) = (0.0, 0);
        self.inside(motion, sigma)?;
        let mut h = self.first_step(motion)?;
        while sigma < 1.0 {
            h = self.permitted(motion, (sigma, h), statistics)?;
            let last = sigma + 1.01 * h >= 1.0;
            if last {
                h = 1.0 - sigma;
            }
            let error = self.attempt(motion, (sigma, h));
            if error.is_nan() || error > 1.0 {
                statistics.rejected += 1;
                h *= control.rejected(error);
                continue;
            }
            statistics.accepted += 1;
            let outcome = self.show(motion, (sigma, h), observe);
            if let Some(tableau) = tableau {
                stiff = self.stiffness(motion, tableau, (sigma, h), stiff)?;
            }
            std::mem::swap(&mut self.buffers.x, &mut self.buffers.stages.end);
            sigma = if last { 1.0 } else { sigma + h };
            *flown = sigma;
            self.inside(motion, sigma)?;
            if outcome.is_break() {
                break;
            }
            self.begin(motion, sigma);
            h *= control.accepted(error);
        }
        Ok(())
    }

    /// Returns an error for a state that is outside the domain of the vector field or not finite.
    pub(super) fn inside<F: FieldIn<T>>(
        &mut self,
        motion: &Motion<F, T>,
        sigma: f64,
    ) -> Result<(), FlowError> {
        for (real, x) in self.real.iter_mut().zip(&self.buffers.x) {
            *real = x.real();
        }
        let (x, p) = self.real.split_at(self.buffers.x.len());
        let time = motion.time(sigma).real();
        if let Some(i) = x.iter().position(|x| !x.is_finite()) {
            return Err(not_finite(motion, time, i, x[i]));
        }
        motion.field.domain(x, p).map_err(|left| FlowError::OutOfDomain { time, left })
    }

    /// Prepares the first step from the position `σ`: computes the time derivative at `σ`, or
    /// linearises the vector field.
    fn begin<F: FieldIn<T>>(&mut self, motion: &Motion<F, T>, sigma: f64) {
        let Buffers { x, stages, linear, .. } = &mut self.buffers;
        match self.settings.scheme.tableau() {
            Some(tableau) => {
                let (n, end) = (x.len(), tableau.end());
                stages.slopes.copy_within(end * n..(end + 1) * n, 0);
            }
            None => linear.update(motion, sigma, x),
        }
    }

    /// Computes the time derivative at the start of the flow, and the length of the first step to
    /// try.
    pub(super) fn first_step<F: FieldIn<T>>(
        &mut self,
        motion: &Motion<F, T>,
    ) -> Result<f64, FlowError> {
        let scheme = self.settings.scheme;
        let Buffers { x, scales, stages, partial, linear, .. } = &mut self.buffers;
        let measure = measure(&self.settings, self.size, scales);
        motion.slope(0.0, x, stages.slope_mut(0));
        if let Some(i) = stages.slope(0).iter().position(|k| !k.real().is_finite()) {
            let value = stages.slope(0)[i].real();
            return Err(not_finite(motion, motion.start.real(), i, value));
        }
        let h = self.settings.first_step.unwrap_or_else(|| {
            let h = measure.euler_step(x, stages.slope(0)).min(1.0);
            combine(x, h, &[(0, 1.0)], &stages.slopes, &mut partial.argument);
            motion.slope(h, &partial.argument, &mut partial.slopes[..x.len()]);
            measure.first_step(scheme.order(), h, x, (stages.slope(0), partial.slope(0)))
        });
        if scheme.tableau().is_none() {
            linear.update(motion, 0.0, x);
        }
        Ok(h)
    }

    /// Returns the length of the next step to try, or an error if no further step is allowed.
    fn permitted<F: FieldIn<T>>(
        &self,
        motion: &Motion<F, T>,
        (sigma, h): (f64, f64),
        statistics: &Statistics,
    ) -> Result<f64, FlowError> {
        self.settings.cancel.check()?;
        let (time, step) = (motion.time(sigma).real(), h * motion.length.real());
        let steps = statistics.accepted + statistics.rejected;
        if steps >= self.settings.max_steps {
            return Err(FlowError::TooManySteps { time, steps, step });
        }
        if h > (10.0 * f64::EPSILON * sigma).max(SMALLEST_STEP) {
            return Ok(h.min(self.settings.largest_step));
        }
        let Buffers { x, stages, .. } = &self.buffers;
        let mut numbers = stages.end.iter().chain(&stages.slopes).map(T::real).enumerate();
        match numbers.find(|(_, number)| !number.is_finite()) {
            Some((k, value)) => Err(not_finite(motion, time, k % x.len(), value)),
            None => Err(FlowError::StepTooSmall { time, step }),
        }
    }

    /// Tries a step and returns the error of the step, in units of the tolerance.
    fn attempt<F: FieldIn<T>>(&mut self, motion: &Motion<F, T>, (sigma, h): (f64, f64)) -> f64 {
        let Buffers { x, scales, stages, linear, .. } = &mut self.buffers;
        let measure = measure(&self.settings, self.size, scales);
        let Some(tableau) = self.settings.scheme.tableau() else {
            let regular = stages.advance_linearised(linear, motion, T::one(), (sigma, h), x);
            let error = measure.error(1.0, rodas::ERROR, x, stages);
            return if regular { error } else { f64::NAN };
        };
        stages.advance(tableau, motion, (sigma, h), x);
        if tableau.end_in_error() {
            stages.end_slope(tableau.end(), motion, sigma + h);
        }
        let error = measure.explicit_error(h, tableau, x, stages);
        let of_derivatives =
            self.size_of_small_states.and_then(|it| measure.of_derivatives(it, x, stages));
        match of_derivatives {
            Some(measure) => error.max(measure.explicit_error(h, tableau, x, stages)),
            None => error,
        }
    }

    /// Passes an accepted step to the observer.
    fn show<F: FieldIn<T>>(
        &mut self,
        motion: &Motion<F, T>,
        (sigma, h): (f64, f64),
        observe: &mut impl FnMut(&mut Step<F, T>) -> ControlFlow<()>,
    ) -> ControlFlow<()> {
        let (&Settings { scheme, absolute, .. }, buffers) = (&self.settings, &mut self.buffers);
        if let Some(tableau) = scheme.tableau().filter(|tableau| !tableau.end_in_error()) {
            buffers.stages.end_slope(tableau.end(), motion, sigma + h);
        }
        let (tolerance, known) = (absolute, Known::default());
        observe(&mut Step { motion, scheme, tolerance, sigma, h, buffers, known })
    }

    /// Returns the number of consecutive steps limited by stability. The derivatives `k_j` at the
    /// last stage and at the end of the step belong to the same time; their difference, divided by
    /// the difference of their arguments, estimates the fastest rate of the vector field (Hairer
    /// and Wanner 1996, section IV.2).
    fn stiffness<F: FieldIn<T>>(
        &self,
        motion: &Motion<F, T>,
        tableau: &Tableau,
        (sigma, h): (f64, f64),
        stiff: usize,
    ) -> Result<usize, FlowError> {
        let Stages { end, argument, .. } = &self.buffers.stages;
        let last = self.buffers.stages.slope(tableau.end() - 1);
        let slopes = distance(self.buffers.stages.slope(tableau.end()), last);
        let square = h * h * slopes / distance(end, argument);
        if square.is_nan() || square <= tableau.stability.powi(2) {
            return Ok(0);
        }
        if stiff + 1 < STIFF_STEPS || (1.0 - sigma) / h < STIFF_REST {
            return Ok(stiff + 1);
        }
        let (time, step) = (motion.time(sigma).real(), h * motion.length.real());
        Err(FlowError::Stiff { time, step, product: square.sqrt() })
    }
}

/// Returns the measure of errors for the solver's settings.
fn measure<'a, T>(settings: &Settings, size: Option<Size<T>>, scales: &'a [f64]) -> Measure<'a, T> {
    let Settings { relative, absolute, .. } = *settings;
    Measure { relative, absolute, scales, size, only_small: false }
}

/// Returns the squared distance between the real parts of two vectors.
fn distance<T: Scalar>(a: &[T], b: &[T]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a.real() - b.real()).powi(2)).sum()
}

/// Creates the error for a state that is not finite or whose time derivative is not finite.
fn not_finite<F: FieldIn<T>, T: Scalar>(
    motion: &Motion<F, T>,
    time: f64,
    state: usize,
    value: f64,
) -> FlowError {
    FlowError::NotFinite { time, state: motion.field.state_name(state), value }
}
