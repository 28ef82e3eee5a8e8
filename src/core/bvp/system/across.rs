//! The other solutions that graze where one of a system does: with the event that it touches, or
//! without it.

use super::BoundarySystem;
use super::layout::Segment;
use crate::core::bvp::{Equations, Mesh, Number, Trajectory};
use crate::core::condition::Failure;
use crate::core::zero::{Across, System};
use std::sync::Arc;

/// A solution that grazes, as one of the others that do.
pub(super) struct Beside {
    /// The solution of this system that it belongs to.
    at: Vec<f64>,
    system: Box<BoundarySystem>,
    x: Vec<f64>,
}

/// A solution by its trajectories.
pub(in crate::core) struct Known {
    /// The problem, with its numbers.
    pub problem: Arc<dyn Equations>,
    pub q: Vec<f64>,
    /// One for each segment.
    pub trajectories: Vec<Trajectory>,
}

impl BoundarySystem {
    /// A solution by its trajectories, with the states where intervals begin: the problem that it
    /// solves on meshes from 0 to 1, the trajectories, and the numbers `q`.
    pub(in crate::core) fn trajectories_of(&self, z: &[f64], p: &[f64]) -> Known {
        let (layout, mut numbers) = (&self.equations.layout, Vec::new());
        let q = [p, &z[layout.values()..]].concat();
        layout.spread(&q, &mut numbers);
        let equations = f64::residual(&**self.problem());
        let trajectory = |(segment, s): (usize, &Segment)| {
            let states = |interval: usize| -> Vec<f64> {
                let node = &layout.order[layout.interval(segment, interval)][..s.states];
                node.iter().map(|&k| z[k]).collect()
            };
            let duration = equations.duration_in(segment, &numbers[layout.local(segment)]);
            let mut known = Trajectory::from(states(0));
            for interval in 1..s.intervals {
                let start = self.equations.span(segment, interval).start;
                known.push(start * duration, &states(interval));
            }
            known
        };
        let trajectories = layout.segments.iter().enumerate().map(trajectory).collect();
        let end = self.meshes()[0].end();
        let spanning = if end == 1.0 { None } else { self.problem().spanning(end, &q) };
        let (problem, q) = spanning.unwrap_or_else(|| (self.problem().clone(), q));
        Known { problem, trajectories, q }
    }

    /// The number of intervals of the segment that has most.
    pub(super) fn most_intervals(&self) -> usize {
        self.meshes().iter().map(Mesh::intervals).max().unwrap_or(1)
    }

    /// The other solution at a grazing, computed once for each.
    pub(super) fn beside_at(&mut self, x: &[f64]) -> Result<Option<Across<'_>>, Failure> {
        if self.beside.as_ref().is_none_or(|beside| beside.at != x) {
            self.beside = self.beside_found(x)?;
        }
        let Some(Beside { system, x, .. }) = &mut self.beside else { return Ok(None) };
        Ok(Some(Across { system: &mut **system, x }))
    }

    fn beside_found(&mut self, x: &[f64]) -> Result<Option<Beside>, Failure> {
        let passes = (self as &mut dyn System).passes_touched(x)?;
        let (z, p) = x.split_at(self.equations.layout.dimension);
        let Known { problem, trajectories: known, q } = self.trajectories_of(z, p);
        let other = match passes {
            true => problem.without_touched(&known, &q)?,
            // What holds at the start of a curve holds along it.
            false if self.beside.is_some() || problem.touch_matters(&known, &q)? => {
                problem.with_touched(&known, &q)?
            }
            false => None,
        };
        let Some(other) = other else { return Ok(None) };
        let (method, intervals) = (self.equations.method.clone(), self.most_intervals());
        let (system, mut x_there) = other.discretised(p, method, intervals)?;
        x_there.extend_from_slice(p);
        Ok(Some(Beside { at: x.to_vec(), system: Box::new(system), x: x_there }))
    }
}
