//! Orbits with events: the facet of boundary-value systems whose problem has itineraries.

use super::BoundarySystem;
use super::layout::Segment;
use super::work::{Work, gather_ends};
use crate::core::bvp::{Ends, Equations, Guess, Itineraries, Number, Trajectory};
use crate::core::failure::Failure;
use crate::core::zero::{Across, Emanating, OrbitEvents, System};
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
        let itineraries = self.problem().itineraries().filter(|_| end != 1.0);
        let spanning = itineraries.and_then(|itineraries| itineraries.spanning(end, &q));
        let (problem, q) = spanning.unwrap_or_else(|| (self.problem().clone(), q));
        Known { problem, trajectories, q }
    }

    /// The system of another problem by the same method, on as many intervals a segment as the
    /// segment with most has here, and a solution of it that is guessed by its trajectories.
    fn discretised_alike(&self, guess: Guess, p: &[f64]) -> Result<(Self, Vec<f64>), Failure> {
        guess.discretised(p, self.equations.method.clone(), self.most_intervals())
    }

    fn beside_found(&mut self, x: &[f64]) -> Result<Option<Beside>, Failure> {
        let passes = (self as &mut dyn System).passes_limit(x)?;
        let (z, p) = x.split_at(self.equations.layout.dimension);
        let Known { problem, trajectories: known, q } = self.trajectories_of(z, p);
        // What holds at the start of a curve holds along it.
        let wanted = self.beside.is_some();
        let Some(itineraries) = problem.itineraries() else { return Ok(None) };
        let Some(other) = itineraries.across(&known, &q, passes, wanted)? else { return Ok(None) };
        let (system, mut x_there) = self.discretised_alike(other, p)?;
        x_there.extend_from_slice(p);
        Ok(Some(Beside { at: x.to_vec(), system: Box::new(system), x: x_there }))
    }
}

/// What is known of a problem's itineraries.
///
/// # Errors
/// [`Failure::Unsupported`] if all solutions go through the same.
pub(super) fn itineraries_of(problem: &dyn Equations) -> Result<&dyn Itineraries, Failure> {
    let reason = "all solutions of this problem go through the same: it has no itineraries";
    problem.itineraries().ok_or_else(|| Failure::Unsupported(reason.into()))
}

impl OrbitEvents for BoundarySystem {
    fn words(&self) -> String {
        self.problem().itineraries().map_or_else(String::new, Itineraries::words)
    }

    fn check(&self, x: &[f64]) -> Result<(), Failure> {
        let layout = &self.equations.layout;
        let mut work: Work<f64> = Work::new(layout);
        work.load(layout, |i| x[i]);
        gather_ends(layout, &work.nodes, &mut work.ends);
        let (start, end) = work.ends.split_at(layout.states);
        itineraries_of(&**self.problem())?.check_ends(Ends { start, end }, &work.q)
    }

    fn limits(&self) -> &[usize] {
        &self.limits
    }

    fn limit_scale(&self, monitor: usize, p: &[f64]) -> f64 {
        self.problem()
            .itineraries()
            .map_or(1.0, |itineraries| itineraries.grazing_scale(monitor, p))
    }

    fn name_of_limit(&self, monitor: usize, x: &[f64]) -> Option<&'static str> {
        let (z, p) = x.split_at(self.equations.layout.dimension);
        let Known { problem, trajectories, q } = self.trajectories_of(z, p);
        problem.itineraries()?.name_of_grazing(monitor, &trajectories, &q)
    }

    fn passes(&self, monitor: usize) -> bool {
        self.problem().itineraries().is_some_and(|itineraries| itineraries.passes(monitor))
    }

    /// Computed once for each solution.
    fn across(&mut self, x: &[f64]) -> Result<Option<Across<'_>>, Failure> {
        if self.beside.as_ref().is_none_or(|beside| beside.at != x) {
            self.beside = self.beside_found(x)?;
        }
        let Some(Beside { system, x, .. }) = &mut self.beside else { return Ok(None) };
        Ok(Some(Across { system: &mut **system, x }))
    }

    fn emanating(&self, x: &[f64], which: usize) -> Result<Emanating, Failure> {
        let (z, p) = x.split_at(self.equations.layout.dimension);
        let Known { problem, trajectories, q } = self.trajectories_of(z, p);
        let guess = itineraries_of(&*problem)?.emanating(&trajectories, &q, which)?;
        let beside = guess.beside.clone();
        let (system, z) = self.discretised_alike(guess, p)?;
        let near = beside.map(|(near, extras)| system.filled(&near, &extras, p)).transpose()?;
        let along = near.map(|near| {
            let across = near.iter().zip(&z).map(|(near, z)| near - z);
            across.chain(p.iter().map(|_| 0.0)).collect()
        });
        Ok(Emanating { system: Box::new(system), z, along })
    }
}
