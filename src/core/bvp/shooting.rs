//! Shooting: the trajectory of an interval is the flow from its left end.

mod extremum_search;
mod variation;

use super::erased::Number;
use super::interval::{Block, Interval, MonitoredFunctions, weighted};
use crate::core::failure::Failure;
use crate::core::ode::{Flow, Scheme, Settings, SettingsError};
use extremum_search::{ExtremumSearch, Observers};
use std::ops::ControlFlow;
use variation::Variation;

/// The tolerance of flows that are computed only for drawing.
const DRAWN: f64 = 1e-8;

/// The smallest allowed tolerance, close to the rounding error of a flow.
const SMALLEST_TOLERANCE: f64 = 1e-14;

/// Shooting: the residual of an interval is `φ(x_left) − x_right`, where `φ` is the flow from the
/// start of the interval to its end. Several intervals give multiple shooting, which is suitable
/// for trajectories along which errors grow.
///
/// Derivatives with respect to the states at the left end and all active entries of `q` come from one flow of dual
/// numbers. The flow of dual numbers takes the same steps as the flow of real numbers, so that residual, Jacobian and
/// the extrema of monitors are consistent. During Newton's iteration, the flow uses larger tolerances than its
/// settings, within the error that the iteration allows.
///
/// ```
/// use tangency::core::bvp::Shooting;
/// use tangency::core::ode::Scheme;
/// let shooting = Shooting::new(Scheme::DormandPrince8, 1e-10).unwrap();
/// assert_eq!(shooting.settings().relative, 1e-10);
/// assert!(Shooting::new(Scheme::DormandPrince8, 0.0).is_err());
/// ```
///
/// The default is the integrator of order 8 with a tolerance of 1e-12.
#[derive(Default)]
pub struct Shooting {
    pub(super) settings: Settings,
    /// The error that is allowed during a Newton iteration.
    allowed: f64,
    four: Variation<4>,
    eight: Variation<8>,
    plain: Flow<f64>,
    observers: Observers,
    x: Vec<f64>,
}

impl Shooting {
    /// Creates shooting with an integration scheme and one tolerance, used as absolute and relative
    /// tolerance.
    ///
    /// # Errors
    /// [`SettingsError`] if the tolerance is invalid.
    pub fn new(scheme: Scheme, tolerance: f64) -> Result<Self, SettingsError> {
        Shooting::with(Settings::new(scheme, tolerance))
    }

    /// Creates shooting with given settings of the flow.
    ///
    /// # Errors
    /// [`SettingsError`] if a setting is invalid.
    pub fn with(settings: Settings) -> Result<Self, SettingsError> {
        settings.check()?;
        Ok(Shooting { settings, ..Shooting::default() })
    }

    /// The settings of the flow.
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// Returns the settings of the flow with an allowed error.
    fn allowing(&self, error: f64) -> Settings {
        let Settings { relative, absolute, .. } = &self.settings;
        let (relative, absolute) = (relative.max(error), absolute.max(error));
        Settings { relative, absolute, ..self.settings.clone() }
    }

    /// Returns the settings of the flow on an interval, with the currently allowed error.
    fn present<T: Number>(&self, interval: &Interval<T>) -> Settings {
        let settings = self.allowing(self.allowed);
        let longest = interval.problem.longest_step(interval.span.segment);
        let length = interval.times().1.real().abs();
        Settings { largest_step: settings.largest_step.min(longest / length), ..settings }
    }
}

impl Clone for Shooting {
    /// Clones the settings; the buffers of the clone are new.
    fn clone(&self) -> Self {
        Shooting { settings: self.settings.clone(), ..Shooting::default() }
    }
}

/// Rounding: the largest accepted factor by which deviations grow over an interval. Rounding errors
/// grow by the same factor, so only one or two correct digits remain at this bound.
const LARGEST_GROWTH: f64 = 1e14;

/// Returns the factor by which deviations grow over an interval: the largest absolute derivative of
/// a state at the interval's end with respect to the same state at its start, because only these
/// derivatives are dimensionless.
pub(super) fn growth(nodes: &[f64], n: usize) -> f64 {
    let own = nodes.chunks_exact(2 * n).enumerate().map(|(i, row)| row[i].abs());
    own.fold(0.0, f64::max)
}

/// Returns an error if the linearisation of a segment has lost its significant digits.
fn check_growth(nodes: &[f64], n: usize) -> Result<(), Failure> {
    let value = growth(nodes, n);
    if value <= LARGEST_GROWTH { Ok(()) } else { Err(Failure::Growth(value)) }
}

impl Shooting {
    /// Computes the residual of the shooting equations on an interval.
    ///
    /// # Errors
    /// [`Failure::OutOfDomain`] if the trajectory leaves the domain of the field.
    pub fn residual<T: Number>(
        &self,
        interval: Interval<T>,
        work: &mut Flow<T>,
        r: &mut [T],
    ) -> Result<(), Failure> {
        self.values(interval, &[1.0], work, r, &mut |_, _| {})?;
        let right = &interval.nodes[r.len()..];
        r.iter_mut().zip(right).for_each(|(r, right)| *r -= *right);
        Ok(())
    }

    /// Computes a weighted sum of the states at the end of the flow that begins at an interval's
    /// left end, and of the contributions to the integral conditions along this flow.
    pub(super) fn nonlinear<T: Number>(
        &self,
        interval: Interval<T>,
        [weights, closing]: [&[f64]; 2],
        work: &mut Flow<T>,
        r: &mut [T],
    ) -> Result<T, Failure> {
        let end = &mut r[..weights.len()];
        self.values(interval, &[1.0], work, end, &mut |_, _| {})?;
        let mut sum = weighted(end, weights);
        if !closing.is_empty() {
            let (problem, g) = (T::residual(interval.problem), &mut r[..closing.len()]);
            self.quadrature(interval, work, &mut |weight, t, x| {
                g.fill(T::zero());
                problem.integrand_in(interval.span.segment, t, x, interval.q, g);
                sum += weighted(g, closing) * weight;
            })?;
        }
        Ok(sum)
    }

    /// Visits the states at several points of an interval, given by their positions from 0 to 1 in
    /// ascending order. The states at the last point have the error of the flow, and the states at
    /// the other points the larger error of dense output.
    pub fn values<T: Number>(
        &self,
        interval: Interval<T>,
        places: &[f64],
        work: &mut Flow<T>,
        x: &mut [T],
        visit: &mut dyn FnMut(usize, &[T]),
    ) -> Result<(), Failure> {
        x.copy_from_slice(&interval.nodes[..x.len()]);
        work.settings = self.present(&interval);
        work.measure_small_states_by(T::largest_derivative);
        let ((start, length), field) = (interval.times(), interval.field());
        let Some(&end) = places.last() else { return Ok(()) };
        let inner = places.partition_point(|place| *place < end);
        let mut next = 0;
        if inner == 0 && end > 0.0 {
            work.advance(&field, start, length * end, x, interval.q)?;
        } else if inner > 0 {
            let mut between = x.to_vec();
            work.observe(&field, start, length * end, x, interval.q, |step| {
                let (from, to) = step.span();
                while next < inner && places[next] <= to * end {
                    let share = (places[next] / end - from) / (to - from);
                    step.interpolate(T::from(share), &mut between);
                    visit(next, &between);
                    next += 1;
                }
                ControlFlow::Continue(())
            })?;
        }
        (next..places.len()).for_each(|k| visit(k, x));
        Ok(())
    }

    /// Evaluates the trajectory on an interval from the dense output of one flow.
    pub(super) fn trajectory(
        &self,
        interval: Interval<f64>,
        count: usize,
        work: &mut Flow<f64>,
        visit: &mut dyn FnMut(f64, &[f64]),
    ) -> Result<(), Failure> {
        let mut x = interval.nodes[..interval.nodes.len() / 2].to_vec();
        let (mut next, mut between) = (0, x.clone());
        work.settings = self.allowing(DRAWN);
        let (start, length) = interval.times();
        let field = interval.field();
        work.observe(&field, start, length, &mut x, interval.q, |step| {
            let (start, end) = step.span();
            while next < count && (next as f64) < end * count as f64 {
                let place = next as f64 / count as f64;
                step.interpolate((place - start) / (end - start), &mut between);
                visit(place, &between);
                next += 1;
            }
            ControlFlow::Continue(())
        })?;
        Ok(())
    }

    /// Computes the residual of an interval, its derivatives with respect to the nodes and to the
    /// active entries of `q`, and the extrema that [`extrema`](Self::extrema) visits.
    pub fn linearise(
        &mut self,
        interval: Interval<f64>,
        active: &[usize],
        mut block: Block,
        functions: MonitoredFunctions,
        visit: &mut dyn FnMut(usize, f64, f64),
    ) -> Result<(), Failure> {
        if !(functions.is_empty() || self.settings.scheme.is_explicit()) {
            self.linearise(interval, active, block, MonitoredFunctions::default(), visit)?;
            return self.extrema(interval, functions, None, visit);
        }
        let n = interval.nodes.len() / 2;
        let (settings, interval, block) = (self.present(&interval), &interval, &mut block);
        for (i, row) in block.nodes.chunks_exact_mut(2 * n).enumerate() {
            row[n..].fill(0.0);
            row[n + i] = -1.0;
        }
        let (all, observers) = ((active, 0), &mut self.observers);
        let search = &mut ExtremumSearch { functions, observers, visit };
        let flowed = match n + active.len() {
            0..=4 => self.four.linearise(settings, interval, all, block, search),
            directions => (0..directions).step_by(8).try_for_each(|first| {
                // Trajectories of further directions are identical.
                if first > 0 {
                    search.functions = MonitoredFunctions::default();
                }
                self.eight.linearise(settings.clone(), interval, (active, first), block, search)
            }),
        };
        flowed.and_then(|()| check_growth(block.nodes, n))
    }

    /// See [`Method::allow`](super::method::Method).
    pub(super) fn allow(&mut self, error: f64) -> bool {
        self.allowed = error;
        error > 0.0
    }

    /// Visits extrema and upward crossings of monitored functions with the function's number and
    /// position (from 0 to 1); also computes the residual if a buffer for it is given.
    pub fn extrema(
        &mut self,
        interval: Interval<f64>,
        functions: MonitoredFunctions,
        residual: Option<&mut [f64]>,
        visit: &mut dyn FnMut(usize, f64, f64),
    ) -> Result<(), Failure> {
        let settings = self.present(&interval);
        let Shooting { plain, observers, x, .. } = self;
        plain.settings = settings;
        let (left, right) = interval.nodes.split_at(interval.nodes.len() / 2);
        let mut search = ExtremumSearch { functions, observers, visit };
        search.begin();
        search.end(&interval, 0.0, left);
        left.clone_into(x);
        let (start, length) = interval.times();
        let field = interval.field();
        plain.observe(&field, start, length, x, interval.q, |step| search.real(&interval, step))?;
        search.end(&interval, 1.0, x);
        if let Some(r) = residual {
            r.iter_mut().zip(x.iter().zip(right)).for_each(|(r, (x, right))| *r = x - right);
        }
        Ok(())
    }

    /// Visits the nodes of a quadrature in every step of one flow, evaluated by dense output.
    pub(super) fn quadrature<T: Number>(
        &self,
        interval: Interval<T>,
        work: &mut Flow<T>,
        visit: &mut dyn FnMut(T, T, &[T]),
    ) -> Result<(), Failure> {
        let mut x = interval.nodes[..interval.nodes.len() / 2].to_vec();
        work.settings = self.present(&interval);
        work.measure_small_states_by(T::largest_derivative);
        let (start, length) = interval.times();
        let field = interval.field();
        work.observe(&field, start, length, &mut x, interval.q, |step| {
            step.quadrature(1.0, &mut *visit);
            ControlFlow::Continue(())
        })?;
        Ok(())
    }

    /// Returns a variant of the method with the same tolerance, but with steps of at most a
    /// hundredth of an interval; its errors differ from the errors of this method, which helps if
    /// rounding errors rule out a more accurate method.
    pub(super) fn by_other_steps(&self) -> Self {
        let settings = Settings { largest_step: 0.01, ..self.settings.clone() };
        Shooting { settings, ..Shooting::default() }
    }

    /// Returns a variant with a hundredth of the tolerance, bounded below by rounding errors;
    /// `None` if the tolerance is already at this bound.
    pub fn finer(&self) -> Option<Self> {
        // A power of ten stays a power of ten.
        let digits = (1.0 / self.settings.relative).round();
        let tolerance = (1.0 / (100.0 * digits)).max(SMALLEST_TOLERANCE);
        let ratio = tolerance / self.settings.relative;
        let absolute = self.settings.absolute * ratio;
        let settings = Settings { relative: tolerance, absolute, ..self.settings.clone() };
        (ratio < 1.0).then(|| Shooting { settings, ..Shooting::default() })
    }
}
