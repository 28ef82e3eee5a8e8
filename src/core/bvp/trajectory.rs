//! Trajectories that are known at several times.

use crate::core::failure::FlowError;
use crate::core::ode::Flow;
use crate::core::problem::FieldIn;
use std::ops::Range;

/// A trajectory on a segment, by its states at nodes. From each node it is flowed to the next one
/// only: where motion is unstable, errors would grow from the beginning of the segment to its end.
#[derive(Clone, Debug, PartialEq)]
pub struct Trajectory {
    /// Times since the beginning of the segment, rising from 0 on.
    times: Vec<f64>,
    /// The states at these times, node by node.
    states: Vec<f64>,
}

impl From<Vec<f64>> for Trajectory {
    /// The trajectory that is known at its beginning alone.
    fn from(states: Vec<f64>) -> Self {
        Trajectory { times: vec![0.0], states }
    }
}

impl Trajectory {
    /// The states with which it begins.
    pub fn start(&self) -> &[f64] {
        &self.states[..self.states.len() / self.times.len()]
    }

    /// Times since the beginning, and the states there.
    pub fn nodes(&self) -> impl DoubleEndedIterator<Item = (f64, &[f64])> {
        self.times.iter().copied().zip(self.states.chunks_exact(self.start().len()))
    }

    /// The last node that is not after a time; the first one before all of them.
    pub fn before(&self, time: f64) -> (f64, &[f64]) {
        let node = self.times.partition_point(|t| *t <= time).max(1) - 1;
        let n = self.start().len();
        (self.times[node], &self.states[node * n..][..n])
    }

    /// Adds a node after all others; one that is not after them is left out.
    pub(in crate::core) fn push(&mut self, time: f64, states: &[f64]) {
        if self.times.last().is_some_and(|last| time > *last) {
            self.times.push(time);
            self.states.extend_from_slice(states);
        }
    }

    /// The part between two times, which begins with other states.
    pub(in crate::core) fn part(&self, start: Vec<f64>, times: Range<f64>) -> Self {
        let mut part = Trajectory::from(start);
        for (time, states) in self.nodes().filter(|(time, _)| *time < times.end) {
            part.push(time - times.start, states);
        }
        part
    }

    /// Goes on from a time on as another one does from its beginning.
    pub(in crate::core) fn join(&mut self, time: f64, next: &Trajectory) {
        for (since, states) in next.nodes() {
            self.push(time + since, states);
        }
    }

    /// The states at a time since the beginning.
    ///
    /// # Errors
    /// [`FlowError`] if the trajectory ends before.
    pub(in crate::core) fn states_at<F: FieldIn<f64>>(
        &self,
        field: &F,
        time: f64,
        q: &[f64],
    ) -> Result<Vec<f64>, FlowError> {
        let (from, states) = self.before(time);
        let mut x = states.to_vec();
        Flow::<f64>::default().advance(field, from, time - from, &mut x, q)?;
        Ok(x)
    }
}
