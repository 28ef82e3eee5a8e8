//! The state of a flow in a lane between two batched steps.

use super::control::Control;
use super::forecast::EventForecast;
use super::integrate::Statistics;
use super::settings::Settings;
use super::step::CLOSE;
use crate::core::linalg::refill;
use crate::core::scalar::Scalar;

/// Heuristic: the largest number of shortened steps that try to end at a root; if they fail, the
/// root is located outside the batch.
const TRIES: usize = 4;

/// The purpose of the next step of a flow in its lane.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Purpose {
    /// An ordinary step.
    Advance,
    /// A shortened step that should end at a zero of a watched function; `fraction` is its length
    /// as a fraction of the ordinary step.
    Aim { watched: usize, fraction: f64, tries: usize },
    /// A step in which roots must be located outside the batch.
    Look,
}

/// A root of a watched function, at which a shortened step ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::core) struct Reached {
    /// The index of the watched function that has the root.
    pub watched: usize,
    /// The position of the root, in units of the shortened step.
    pub fraction: f64,
    /// The length of the ordinary step, in units of the shortened step.
    pub whole: f64,
}

/// A flow between two steps of a batch.
pub struct LaneState<T> {
    /// The time at which the flow starts.
    pub(super) start: T,
    /// The duration of the flow.
    pub(super) length: T,
    /// The progress of the flow, from 0 to 1.
    pub(super) sigma: f64,
    /// The length of the next step to try.
    h: f64,
    /// The state.
    pub(super) x: Vec<T>,
    /// The derivative of the state with respect to time.
    pub(super) slope: Vec<T>,
    largest_step: f64,
    control: Control,
    purpose: Purpose,
    /// The cost of the flow so far.
    pub statistics: Statistics,
}

impl<T: Scalar> LaneState<T> {
    /// Creates the state of a lane without a flow.
    pub fn new() -> Self {
        let settings = Settings::default();
        LaneState {
            start: T::zero(),
            length: T::zero(),
            sigma: 0.0,
            h: 0.0,
            x: Vec::new(),
            slope: Vec::new(),
            largest_step: 1.0,
            control: Control::new(&settings),
            purpose: Purpose::Advance,
            statistics: Statistics::default(),
        }
    }

    /// Begins a flow, given its first step to try, its initial state, and the time derivative of
    /// this state.
    pub(super) fn begin(
        &mut self,
        [start, length]: [T; 2],
        h: f64,
        x: &[T],
        slope: impl Iterator<Item = T>,
        settings: &Settings,
    ) {
        x.clone_into(&mut self.x);
        refill(&mut self.slope, slope);
        (self.start, self.length, self.sigma, self.h) = (start, length, 0.0, h);
        self.largest_step = settings.largest_step;
        self.control = Control::new(settings);
        self.purpose = Purpose::Advance;
        self.statistics = Statistics::default();
    }

    /// The state.
    pub fn state(&self) -> &[T] {
        &self.x
    }

    /// Returns the number of tried steps.
    pub fn steps(&self) -> usize {
        self.statistics.accepted + self.statistics.rejected
    }

    /// Whether the flow has ended.
    pub fn is_over(&self) -> bool {
        self.sigma >= 1.0
    }

    /// Returns the length of the next step to try, and whether this step is the last step of the
    /// flow.
    pub(super) fn step(&self) -> (f64, bool) {
        let h = self.h.min(self.largest_step);
        let (h, last) =
            if self.sigma + 1.01 * h >= 1.0 { (1.0 - self.sigma, true) } else { (h, false) };
        match self.purpose {
            Purpose::Aim { fraction, .. } => (h * fraction, false),
            Purpose::Advance | Purpose::Look => (h, last),
        }
    }

    /// Shortens the step after a rejection with a given error; `None` if the flow must be examined
    /// outside the batch.
    pub fn reject(&mut self, error: f64) -> Option<()> {
        self.statistics.rejected += 1;
        self.h = self.step().0 * self.control.rejected(error);
        self.purpose = Purpose::Advance;
        (error.is_finite() && self.h > 1e-12).then_some(())
    }

    /// Advances the flow by an accepted step of length `h`, whose error is given.
    pub(super) fn accept(&mut self, h: f64, error: f64) {
        self.h = h * self.control.accepted(error);
        self.purpose = Purpose::Advance;
        self.statistics.accepted += 1;
    }

    /// Whether the last step was meant to end at a zero of a watched function.
    pub fn aims(&self) -> bool {
        matches!(self.purpose, Purpose::Aim { .. })
    }

    /// Aims the next step at the only root of a watched function in the step just tried; `None` if
    /// the forecast does not contain a single root.
    pub fn aim(&mut self, watched: usize, forecast: &EventForecast, lane: usize) -> Option<()> {
        let guess = forecast.fall(lane).filter(|_| self.purpose == Purpose::Advance)?;
        self.purpose = Purpose::Aim { watched, fraction: guess, tries: 0 };
        Some(())
    }

    /// Returns the root, if the shortened step that was just tried ends close enough to the root to
    /// determine its position. If the shortened step does not end close to the root, either another
    /// shortened step is tried, or the root is located outside the batch.
    pub(in crate::core) fn reached(
        &mut self,
        forecasts: &[EventForecast],
        lane: usize,
    ) -> Option<Reached> {
        let Purpose::Aim { watched, fraction, tries } = self.purpose else { return None };
        let change = forecasts[watched].correction(lane);
        let next = fraction * (1.0 + change);
        if (change * fraction).abs() <= CLOSE {
            return Some(Reached { watched, fraction: 1.0 + change, whole: 1.0 / fraction });
        }
        let inside = next > 0.0 && next < 1.0;
        self.purpose = match inside && tries < TRIES {
            true => Purpose::Aim { watched, fraction: next, tries: tries + 1 },
            false => Purpose::Look,
        };
        None
    }
}
