//! Detection of repeating motion.

use crate::core::hybrid::{HybridEquations, HybridState};
use std::collections::VecDeque;

/// (H) The minimal ratio of the distance of states after fewer returns to that after a period of
/// the cycle.
const DISTINCT: f64 = 1e3;

/// The scales of the states of each mode, which are the units of sizes and distances; 1 by default.
#[derive(Clone, Debug, Default)]
pub(in crate::core) struct StateScales(Vec<Vec<f64>>);

impl StateScales {
    /// Returns the scales of a system.
    pub(in crate::core) fn of(system: &dyn HybridEquations, p: &[f64]) -> Self {
        StateScales::in_modes(system.modes().len(), |mode| system.scales_of(mode, p))
    }

    /// Creates the scales of the states of several modes.
    pub fn in_modes(modes: usize, of_mode: impl Fn(usize) -> Vec<f64>) -> Self {
        StateScales((0..modes).map(of_mode).collect())
    }

    /// The scales of a mode's states.
    pub fn of_mode(&self, mode: usize) -> impl Iterator<Item = &f64> {
        self.0.get(mode).into_iter().flatten().chain(std::iter::repeat(&1.0))
    }

    /// The Euclidean norm of a state of a mode.
    pub fn size(&self, mode: usize, x: &[f64]) -> f64 {
        let parts = x.iter().zip(self.of_mode(mode)).map(|(x, scale)| x / scale);
        parts.map(|x| x * x).sum::<f64>().sqrt()
    }

    /// The Euclidean distance of two states of a mode.
    pub fn distance(&self, mode: usize, a: &[f64], b: &[f64]) -> f64 {
        let parts = a.iter().zip(b).zip(self.of_mode(mode)).map(|((a, b), scale)| (a - b) / scale);
        parts.map(|x| x * x).sum::<f64>().sqrt()
    }
}

/// A sample of a motion, with the events since the preceding sample.
struct Sample {
    state: HybridState<f64>,
    /// The numbers of the events, and whether each is an accumulation.
    events: Vec<(usize, bool)>,
    /// The size of the motion.
    size: f64,
}

/// Detects whether a motion repeats, from its last samples.
pub(super) struct Repetition {
    most: usize,
    tolerance: f64,
    pub scales: StateScales,
    past: VecDeque<Sample>,
    /// The number of samples.
    pub samples: usize,
    /// The smallest distance of two compared states, in units of the motion's size.
    pub nearest: f64,
}

impl Repetition {
    /// Creates a search for a number of samples, up to `most`, after which states agree to a
    /// tolerance, in units of the motion's size.
    pub fn new(most: usize, tolerance: f64, scales: StateScales) -> Self {
        let (past, nearest) = (VecDeque::new(), f64::INFINITY);
        Repetition { most, tolerance, scales, past, samples: 0, nearest }
    }

    /// Processes a sample: the state, the events since the last sample, and the size of the motion.
    /// Returns the number of samples after which the motion has repeated, with the same events in
    /// as many samples before.
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

    /// Whether no proper divisor of `q` is the number of samples after which the motion repeats: a
    /// motion that spirals towards a cycle may first be near it after a multiple of its period.
    pub fn is_least(&self, q: usize) -> bool {
        let near = DISTINCT * self.distance(q);
        (1..q).filter(|part| q.is_multiple_of(*part)).all(|part| near <= self.distance(part))
    }

    /// The distance of the state from the state of `q` samples before; infinite if other events
    /// occurred.
    fn distance(&self, q: usize) -> f64 {
        let (old, new) = (self.before(q), self.before(0));
        let repeats = self.last(q).zip(self.last(2 * q)).all(|(new, old)| new.events == old.events);
        let alike = old.mode == new.mode && repeats;
        if alike { self.scales.distance(new.mode, &old.x, &new.x) } else { f64::INFINITY }
    }

    /// Returns the number of samples after which the motion has come closest to its last state, the
    /// distance, and the size of the motion; `None` if no sequence of events repeats.
    pub fn nearest_return(&self) -> Option<(usize, f64, f64)> {
        let returns = (1..=self.most.min(self.past.len() / 2)).map(|q| (q, self.distance(q)));
        let (q, distance) = returns.min_by(|a, b| a.1.total_cmp(&b.1))?;
        let size = self.last(q).map(|sample| sample.size).fold(0.0, f64::max);
        distance.is_finite().then_some((q, distance, size))
    }

    /// The numbers of the events in the last `q` samples, and whether each is an accumulation.
    pub fn numbers(&self, q: usize) -> Vec<(usize, bool)> {
        self.last(q).flat_map(|sample| sample.events.iter().copied()).collect()
    }

    /// Whether the last state is closer to `x` than the oldest state a multiple of `q` samples
    /// before.
    pub fn approaches(&self, x: &[f64], q: usize) -> bool {
        let [old, new] = [(self.past.len() - 1) / q * q, 0].map(|before| self.before(before));
        let distance = |sample: &HybridState<f64>| self.scales.distance(sample.mode, &sample.x, x);
        old.mode == new.mode && distance(new) < distance(old)
    }

    /// The last `q` samples.
    fn last(&self, q: usize) -> impl Iterator<Item = &Sample> {
        self.past.range(self.past.len() - q..)
    }

    /// The state `q` samples before the last one.
    pub fn before(&self, q: usize) -> &HybridState<f64> {
        &self.past[self.past.len() - 1 - q].state
    }

    /// The number of events in the last `q` samples.
    pub fn events(&self, q: usize) -> usize {
        self.last(q).map(|sample| sample.events.len()).sum()
    }
}
