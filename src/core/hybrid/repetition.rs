//! Whether a motion under forcing has come back to where it was.

use super::simulation::HybridState;
use std::collections::VecDeque;

/// How near states have come to each other, in units of the largest one.
#[derive(Clone, Copy, Debug)]
pub(super) struct Nearness {
    largest: f64,
    pub least: f64,
}

impl Nearness {
    pub fn new() -> Self {
        Nearness { largest: f64::MIN_POSITIVE, least: f64::INFINITY }
    }

    /// Takes a state in that may be the largest.
    pub fn extend(&mut self, x: &[f64]) {
        self.largest = x.iter().map(|x| x * x).sum::<f64>().sqrt().max(self.largest);
    }

    /// Whether two states of one mode are as near as this.
    pub fn admit(&mut self, a: &[f64], b: &[f64], tolerance: f64) -> bool {
        let square: f64 = a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum();
        let distance = square.sqrt() / self.largest;
        self.least = self.least.min(distance);
        distance <= tolerance
    }
}

/// The last periods of a motion that is looked at once in every period: where each of them began, and the guards
/// of its events.
pub(in crate::core) struct Repetition {
    most: usize,
    tolerance: f64,
    pub(super) nearness: Nearness,
    past: VecDeque<(HybridState<f64>, Vec<usize>)>,
}

impl Repetition {
    /// Looks for up to so many periods, after which states agree to a tolerance, in units of the largest one.
    pub fn new(most: usize, tolerance: f64) -> Self {
        Repetition { most, tolerance, nearness: Nearness::new(), past: VecDeque::new() }
    }

    /// Takes in a state that may be the largest.
    pub fn extend(&mut self, x: &[f64]) {
        self.nearness.extend(x);
    }

    /// Takes in a period: the state in which it began, its events, and the state in which it ended. Returns after
    /// how many periods the motion has come back, the same events having come in as many periods before.
    pub fn push(
        &mut self,
        before: HybridState<f64>,
        events: Vec<usize>,
        after: &HybridState<f64>,
    ) -> Option<usize> {
        if self.past.len() == 2 * self.most {
            self.past.pop_front();
        }
        self.past.push_back((before, events));
        self.nearness.extend(&after.x);
        let Repetition { past, nearness, tolerance, .. } = self;
        let back = |q: &usize| {
            let (old, _) = &past[past.len() - q];
            old.mode == after.mode
                && nearness.admit(&old.x, &after.x, *tolerance)
                && repeats(past, *q)
        };
        (1..=self.most.min(past.len() / 2)).find(back)
    }
}

/// Whether the events of the last `q` periods are those of the `q` periods before.
fn repeats(past: &VecDeque<(HybridState<f64>, Vec<usize>)>, q: usize) -> bool {
    let events = |k: usize| past.iter().skip(past.len() - k).map(|(_, events)| events);
    events(q).zip(events(2 * q)).all(|(new, old)| new == old)
}
