//! Events and observers of a hybrid motion.

use crate::core::ode::Step;
use crate::core::problem::FieldIn;
use crate::core::scalar::Scalar;
use std::ops::ControlFlow;

/// An event of a hybrid motion: the end of one mode and the beginning of the next.
#[derive(Clone, Debug, PartialEq)]
pub struct Event<T> {
    /// The guard that vanished at the event.
    pub guard: usize,
    /// The time of the event, with its derivatives.
    pub time: T,
    /// The mode before the event.
    pub mode: usize,
    /// The mode after the event.
    pub next: usize,
    /// The state just before the event, in the mode before.
    pub before: Vec<T>,
    /// The state just after the event, in the mode after.
    pub after: Vec<T>,
    /// The approach speed: the rate `−dh/dt` of the vanishing guard.
    pub approach: f64,
    /// Whether the event represents the accumulation of a series of infinitely many events.
    pub accumulation: bool,
}

impl<T: Scalar> Event<T> {
    pub(super) fn empty() -> Self {
        Event {
            guard: 0,
            time: T::zero(),
            mode: 0,
            next: 0,
            before: Vec::new(),
            after: Vec::new(),
            approach: 0.0,
            accumulation: false,
        }
    }
}

/// An observer of a hybrid motion. A closure that takes an event is an observer of events only; `()`
/// is an observer that ignores everything.
pub trait HybridObserver<T: Scalar> {
    /// Observes an integration step in a mode, from the start of the step to the fraction `end`,
    /// which is 1, or less if an event ended the step.
    fn step<F: FieldIn<T>>(&mut self, _mode: usize, _step: &mut Step<F, T>, _end: T) {}

    /// Whether the observer ends the motion after a step that no event has ended.
    fn ends(&self) -> bool {
        false
    }

    /// Observes an event; the observer can end the motion just after it.
    fn event(&mut self, _event: &Event<T>) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }
}

impl<T: Scalar> HybridObserver<T> for () {}

impl<T: Scalar, C: FnMut(&Event<T>) -> ControlFlow<()>> HybridObserver<T> for C {
    fn event(&mut self, event: &Event<T>) -> ControlFlow<()> {
        self(event)
    }
}

/// A part of a motion in one mode: times and states.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Piece {
    /// The mode.
    pub mode: usize,
    /// The times.
    pub times: Vec<f64>,
    /// The states at the recorded times.
    pub states: Vec<Vec<f64>>,
}

/// An observer that records the history of a motion: its events, and states sampled in every step.
///
/// ```
/// use tangency::core::hybrid::{History, HybridFlow, HybridSettings, HybridState};
/// use tangency::problems::classic::ImpactOscillator;
/// // Without force and loss, x = sin t up to the stop at 0.8, and back.
/// let mut flow = HybridFlow::new(&ImpactOscillator, HybridSettings::default())?;
/// let mut mass = HybridState { mode: ImpactOscillator::FLIGHT, time: 0.0, x: vec![0.0, 1.0] };
/// let mut history = History::new(4);
/// flow.advance(&mut mass, 1.0, &[0.0, 1.0, 1.0, 0.0, 0.8], &mut history)?;
/// assert!(history.events.len() == 1 && history.pieces.len() == 2);
/// assert!((history.events[0].time - 0.8_f64.asin()).abs() < 1e-12);
/// # Ok::<(), tangency::core::hybrid::HybridError>(())
/// ```
#[derive(Clone, Debug)]
pub struct History {
    /// The number of recorded states per step.
    samples: usize,
    /// The pieces of the motion, each between two successive events.
    pub pieces: Vec<Piece>,
    /// The events.
    pub events: Vec<Event<f64>>,
    begun: bool,
}

impl History {
    /// Creates a history with this number of states per step (at least 1).
    pub fn new(samples: usize) -> Self {
        History { samples: samples.max(1), pieces: Vec::new(), events: Vec::new(), begun: false }
    }
}

impl HybridObserver<f64> for History {
    fn step<F: FieldIn<f64>>(&mut self, mode: usize, step: &mut Step<F, f64>, end: f64) {
        if !self.begun {
            let (times, states) = (vec![step.time(0.0)], vec![step.start().to_vec()]);
            self.pieces.push(Piece { mode, times, states });
            self.begun = true;
        }
        let Some(piece) = self.pieces.last_mut() else { return };
        for k in 1..=self.samples {
            let fraction = end * k as f64 / self.samples as f64;
            let mut x = vec![0.0; step.start().len()];
            step.interpolate(fraction, &mut x);
            piece.times.push(step.time(fraction));
            piece.states.push(x);
        }
    }

    fn event(&mut self, event: &Event<f64>) -> ControlFlow<()> {
        self.events.push(event.clone());
        self.begun = false;
        ControlFlow::Continue(())
    }
}
