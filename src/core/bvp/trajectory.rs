//! Trajectories known at several times.

use crate::core::failure::FlowError;
use crate::core::ode::Flow;
use crate::core::problem::FieldIn;
use std::ops::Range;

/// A trajectory on a segment, given by its states at nodes. Flows are computed only from each node
/// to the next node, because errors of an unstable motion would grow if a flow were computed over
/// the whole segment.
#[derive(Clone, Debug, PartialEq)]
pub struct Trajectory {
    /// The times since the start of the segment, in increasing order from 0.
    times: Vec<f64>,
    /// The states at the times of the nodes, node by node.
    states: Vec<f64>,
}

impl From<Vec<f64>> for Trajectory {
    /// Creates a trajectory with a single node, at the start of the segment.
    fn from(states: Vec<f64>) -> Self {
        Trajectory { times: vec![0.0], states }
    }
}

impl Trajectory {
    /// The initial states.
    pub fn start(&self) -> &[f64] {
        &self.states[..self.states.len() / self.times.len()]
    }

    /// Returns the times since the start of the segment, and the states at these times.
    pub fn nodes(&self) -> impl DoubleEndedIterator<Item = (f64, &[f64])> {
        self.times.iter().copied().zip(self.states.chunks_exact(self.start().len()))
    }

    /// Returns the last node at or before a time; if the time is earlier than all nodes, returns
    /// the first node.
    pub fn before(&self, time: f64) -> (f64, &[f64]) {
        let node = self.times.partition_point(|t| *t <= time).max(1) - 1;
        let n = self.start().len();
        (self.times[node], &self.states[node * n..][..n])
    }

    /// Appends a node; a node whose time is at or before the last node is ignored.
    pub(in crate::core) fn push(&mut self, time: f64, states: &[f64]) {
        if self.times.last().is_some_and(|last| time > *last) {
            self.times.push(time);
            self.states.extend_from_slice(states);
        }
    }

    /// Returns the part of the trajectory between two times, in which the states at the first of
    /// these times are replaced by the states `start`.
    pub(in crate::core) fn part(&self, start: Vec<f64>, times: Range<f64>) -> Self {
        let mut part = Trajectory::from(start);
        for (time, states) in self.nodes().filter(|(time, _)| *time < times.end) {
            part.push(time - times.start, states);
        }
        part
    }

    /// Replaces the part of the trajectory after a given time by another trajectory.
    pub(in crate::core) fn join(&mut self, time: f64, next: &Trajectory) {
        for (since, states) in next.nodes() {
            self.push(time + since, states);
        }
    }

    /// Computes the states of the trajectory at a given time since the start of the segment.
    ///
    /// # Errors
    /// [`FlowError`] if the flow to the requested time ends early.
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
