//! The other solutions that graze where one of a system does: with the event that it touches, or without it.

use super::BoundarySystem;
use super::layout::Segment;
use crate::core::bvp::{Mesh, Number, Trajectory};
use crate::core::condition::Failure;
use crate::core::zero::{Across, System};

/// A solution that grazes, as one of the others that do.
pub(super) struct Beside {
    /// The solution of this system that it belongs to.
    at: Vec<f64>,
    system: Box<BoundarySystem>,
    x: Vec<f64>,
}

impl BoundarySystem {
    /// The trajectories of a solution by the states where intervals begin, and its numbers `q`.
    pub(in crate::core) fn trajectories_of(
        &self,
        z: &[f64],
        p: &[f64],
    ) -> (Vec<Trajectory>, Vec<f64>) {
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
        (layout.segments.iter().enumerate().map(trajectory).collect(), q)
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
        let (known, q) = self.trajectories_of(z, p);
        let problem = self.problem();
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
