//! Whether a motion has come back to where it was.

use crate::core::hybrid::{HybridEquations, HybridState};
use std::collections::VecDeque;

/// (H) States after fewer returns are farther away than those after a period of the cycle by this
/// factor.
const DISTINCT: f64 = 1e3;

/// The scales of the states of each mode, in units of which sizes and distances are; all 1 where
/// there are none.
#[derive(Clone, Debug, Default)]
pub(in crate::core) struct StateScales(Vec<Vec<f64>>);

impl StateScales {
    /// The scales of a system.
    pub(in crate::core) fn of(system: &dyn HybridEquations, p: &[f64]) -> Self {
        StateScales::in_modes(system.modes().len(), |mode| system.scales_of(mode, p))
    }

    /// The scales of the states of each of several modes.
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

/// How near states have come to each other, in units of a size.
#[derive(Clone, Debug)]
pub(in crate::core) struct Nearness {
    scales: StateScales,
    largest: f64,
    pub least: f64,
}

impl Nearness {
    pub fn new(scales: StateScales) -> Self {
        Nearness { scales, largest: f64::MIN_POSITIVE, least: f64::INFINITY }
    }

    /// Takes in a size that may be the largest.
    pub fn extend(&mut self, size: f64) {
        self.largest = self.largest.max(size);
    }

    /// The distance of two states of a mode, in units of the largest size.
    pub fn distance(&self, mode: usize, a: &[f64], b: &[f64]) -> f64 {
        self.scales.distance(mode, a, b) / self.largest
    }

    /// The least number of returns, up to `most`, after which the distance is within a tolerance.
    pub fn first(
        &mut self,
        most: usize,
        tolerance: f64,
        distance: impl Fn(&Self, usize) -> f64,
    ) -> Option<usize> {
        (1..=most).find(|returns| {
            let distance = distance(self, *returns);
            self.least = self.least.min(distance);
            distance <= tolerance
        })
    }
}

/// Whether a motion that comes back after some returns comes back after no part of them: a motion
/// that spirals towards a cycle may be near it first after a multiple of its period.
pub(in crate::core) fn is_least(returns: usize, distance: impl Fn(usize) -> f64) -> bool {
    let divisors = (1..returns).filter(|part| returns.is_multiple_of(*part));
    let near = DISTINCT * distance(returns);
    divisors.map(distance).all(|distance| near <= distance)
}

/// The last periods of a motion that is sampled once in every period: where each of them began, and
/// the guards of its events.
pub(in crate::core) struct Repetition {
    most: usize,
    tolerance: f64,
    pub(in crate::core) nearness: Nearness,
    past: VecDeque<(HybridState<f64>, Vec<usize>)>,
}

impl Repetition {
    /// Looks for a number of periods, up to `most`, after which states agree to a tolerance, in
    /// units of the largest size.
    pub fn new(most: usize, tolerance: f64, scales: StateScales) -> Self {
        Repetition { most, tolerance, nearness: Nearness::new(scales), past: VecDeque::new() }
    }

    /// Takes in a period: the state in which it began, its events, the state in which it ended, and
    /// the size of the motion. Returns after how many periods the motion has come back, the same
    /// events having come in as many periods before.
    pub fn push(
        &mut self,
        before: HybridState<f64>,
        events: Vec<usize>,
        after: &HybridState<f64>,
        size: f64,
    ) -> Option<usize> {
        if self.past.len() == 2 * self.most {
            self.past.pop_front();
        }
        self.past.push_back((before, events));
        self.nearness.extend(size);
        let Repetition { past, nearness, tolerance, most } = self;
        let most = (*most).min(past.len() / 2);
        nearness.first(most, *tolerance, |nearness, q| back(past, nearness, q, after))
    }

    /// Whether the motion that has come back in a state after some periods comes back after no part
    /// of them.
    pub fn is_least(&self, periods: usize, after: &HybridState<f64>) -> bool {
        is_least(periods, |q| back(&self.past, &self.nearness, q, after))
    }
}

/// How near a state is to that of `q` periods before; infinitely far if other events have come.
fn back(
    past: &VecDeque<(HybridState<f64>, Vec<usize>)>,
    nearness: &Nearness,
    q: usize,
    after: &HybridState<f64>,
) -> f64 {
    let (old, _) = &past[past.len() - q];
    let alike = old.mode == after.mode && repeats(past, q);
    if alike { nearness.distance(after.mode, &old.x, &after.x) } else { f64::INFINITY }
}

/// Whether the events of the last `q` periods are those of the `q` periods before.
fn repeats(past: &VecDeque<(HybridState<f64>, Vec<usize>)>, q: usize) -> bool {
    let events = |k: usize| past.iter().skip(past.len() - k).map(|(_, events)| events);
    events(q).zip(events(2 * q)).all(|(new, old)| new == old)
}
