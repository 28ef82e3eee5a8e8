//! Detection of repeating motion.

use crate::core::hybrid::{HybridEquations, HybridState};
use std::collections::VecDeque;

/// Heuristic: the period of a cycle counts as minimal if the distance between states after fewer
/// returns exceeds the distance after the whole period by this factor.
const DISTINCT: f64 = 1e3;

/// The scales of the states in each mode, by which sizes and distances are measured; 1 by default.
#[derive(Clone, Debug, Default)]
pub(in crate::core) struct StateScales(Vec<Vec<f64>>);

impl StateScales {
    /// Returns the scales of the states of a system.
    pub(in crate::core) fn of(system: &dyn HybridEquations, p: &[f64]) -> Self {
        StateScales::in_modes(system.modes().len(), |mode| system.scales_of(mode, p))
    }

    /// Creates the scales of the states in each of several modes.
    pub fn in_modes(modes: usize, of_mode: impl Fn(usize) -> Vec<f64>) -> Self {
        StateScales((0..modes).map(of_mode).collect())
    }

    /// Returns the scales of a mode's states.
    pub fn of_mode(&self, mode: usize) -> impl Iterator<Item = &f64> {
        self.0.get(mode).into_iter().flatten().chain(std::iter::repeat(&1.0))
    }

    /// Returns the Euclidean norm of a state in a mode, in units of the scales.
    pub fn size(&self, mode: usize, x: &[f64]) -> f64 {
        let parts = x.iter().zip(self.of_mode(mode)).map(|(x, scale)| x / scale);
        parts.map(|x| x * x).sum::<f64>().sqrt()
    }

    /// Returns the Euclidean distance between two states in a mode, in units of the scales.
    pub fn distance(&self, mode: usize, a: &[f64], b: &[f64]) -> f64 {
        let parts = a.iter().zip(b).zip(self.of_mode(mode)).map(|((a, b), scale)| (a - b) / scale);
        parts.map(|x| x * x).sum::<f64>().sqrt()
    }
}

/// A sample of a motion, with the events since the preceding sample.
struct Sample {
    state: HybridState<f64>,
    /// The number that identifies each event, and whether infinitely many events accumulate there.
    events: Vec<(usize, bool)>,
    /// The size of the motion at the sample.
    size: f64,
}

/// A detector of repetition in the last samples of a motion.
pub(super) struct Repetition {
    most: usize,
    tolerance: f64,
    pub scales: StateScales,
    past: VecDeque<Sample>,
    /// The number of samples processed.
    pub samples: usize,
    /// The smallest distance between two compared states, in units of the motion's size.
    pub nearest: f64,
}

impl Repetition {
    /// Creates a detector of repetition: the states must agree to a tolerance, in units of the
    /// motion's size, after at most `most` samples.
    pub fn new(most: usize, tolerance: f64, scales: StateScales) -> Self {
        let (past, nearest) = (VecDeque::new(), f64::INFINITY);
        Repetition { most, tolerance, scales, past, samples: 0, nearest }
    }

    /// Processes a sample: its state, the events since the previous sample, and the size of the
    /// motion. Returns the number `q` of samples after which the motion has repeated, if the last
    /// `q` samples have the same events as the `q` samples before.
    pub fn push(
        &mut self,
        state: HybridState<f64>,
        events: Vec<(usize, bool)>,
        size: f64,
    ) -> Option<usize> {
        if self.past.len() == 2 * self.most {
            self.past.pop_front();
        }
        self.past.push_back(Sample { state, events, size });
        self.samples += 1;
        (1..=self.most.min(self.past.len() / 2)).find(|q| {
            let sizes = self.last(*q).map(|sample| sample.size);
            let distance = self.distance(*q) / sizes.fold(f64::MIN_POSITIVE, f64::max);
            self.nearest = self.nearest.min(distance);
            distance <= self.tolerance
        })
    }

    /// Whether `q` is the minimal period in samples, so that the motion does not repeat after a
    /// proper divisor of `q`. A motion that spirals towards a cycle may first approach its own
    /// earlier states after a multiple of the minimal period.
    pub fn is_least(&self, q: usize) -> bool {
        let near = DISTINCT * self.distance(q);
        (1..q).filter(|part| q.is_multiple_of(*part)).all(|part| near <= self.distance(part))
    }

    /// Returns the distance between the last state and the state `q` samples before; infinite if
    /// the events since then do not repeat.
    fn distance(&self, q: usize) -> f64 {
        let (old, new) = (self.before(q), self.before(0));
        let repeats = self.last(q).zip(self.last(2 * q)).all(|(new, old)| new.events == old.events);
        let alike = old.mode == new.mode && repeats;
        if alike { self.scales.distance(new.mode, &old.x, &new.x) } else { f64::INFINITY }
    }

    /// Finds the earlier sample whose state is closest to the last state; returns the number of
    /// samples between them, the distance between the two states, and the size of the motion, or
    /// `None` if no sequence of events repeats.
    pub fn nearest_return(&self) -> Option<(usize, f64, f64)> {
        let returns = (1..=self.most.min(self.past.len() / 2)).map(|q| (q, self.distance(q)));
        let (q, distance) = returns.min_by(|a, b| a.1.total_cmp(&b.1))?;
        let size = self.last(q).map(|sample| sample.size).fold(0.0, f64::max);
        distance.is_finite().then_some((q, distance, size))
    }

    /// Returns, for each event in the last `q` samples, the number that identifies it, and whether
    /// infinitely many events accumulate there.
    pub fn numbers(&self, q: usize) -> Vec<(usize, bool)> {
        self.last(q).flat_map(|sample| sample.events.iter().copied()).collect()
    }

    /// Compares two distances from a state `x`: returns whether the last state is closer to `x`
    /// than the oldest stored state that lies a multiple of `q` samples before the last one.
    pub fn approaches(&self, x: &[f64], q: usize) -> bool {
        let [old, new] = [(self.past.len() - 1) / q * q, 0].map(|before| self.before(before));
        let distance = |sample: &HybridState<f64>| self.scales.distance(sample.mode, &sample.x, x);
        old.mode == new.mode && distance(new) < distance(old)
    }

    /// Returns the last `q` samples.
    fn last(&self, q: usize) -> impl Iterator<Item = &Sample> {
        self.past.range(self.past.len() - q..)
    }

    /// Returns the state `q` samples before the last one.
    pub fn before(&self, q: usize) -> &HybridState<f64> {
        &self.past[self.past.len() - 1 - q].state
    }

    /// Returns the number of events in the last `q` samples.
    pub fn events(&self, q: usize) -> usize {
        self.last(q).map(|sample| sample.events.len()).sum()
    }
}
