//! Orbits with events: the methods of boundary-value systems whose problems have itineraries.

use super::BoundarySystem;
use super::discretisation::{DiscretisedProblem, Known};
use super::layout::UnknownLayout;
use super::solutions::{Beside, Solutions};
use super::start::{itineraries_of, most_intervals};
use super::work::{Work, gather_ends};
use crate::core::bvp::erased::ErasedProblem;
use crate::core::bvp::itineraries::Guess;
use crate::core::bvp::terms::Ends;
use crate::core::failure::Failure;
use crate::core::system::{Across, Emanating, Jump, Limit, OrbitEvents};

/// Loads a solution, including the states at the ends of its segments.
fn gathered(layout: &UnknownLayout, x: &[f64]) -> Work<f64> {
    let mut work = Work::new(layout);
    work.load(layout, |i| x[i]);
    gather_ends(layout, &work.nodes, &mut work.ends);
    work
}

fn ends_in<'w>(layout: &UnknownLayout, work: &'w Work<f64>) -> Ends<'w, f64> {
    let (start, end) = work.ends.split_at(layout.states);
    Ends { start, end }
}

/// Computes the solution on the other side of a limit of admissible solutions, and the system that
/// this solution solves.
fn beside(solutions: &Solutions, x: &[f64], passes: bool) -> Result<Option<Beside>, Failure> {
    let equations = &solutions.equations;
    let (z, p) = x.split_at(equations.layout.dimension);
    let Known { problem, trajectories: known, q } = equations.trajectories_of(z, p);
    // A property of the start of a curve holds along the curve.
    let wanted = solutions.beside.as_ref().is_some_and(|beside| !beside.passes);
    let Some(itineraries) = problem.itineraries() else { return Ok(None) };
    let Some(other) = itineraries.across(&known, &q, passes, wanted)? else { return Ok(None) };
    let (system, mut x_there) = discretised_alike(equations, other, p)?;
    x_there.extend_from_slice(p);
    Ok(Some(Beside { at: x.to_vec(), system: Box::new(system), x: x_there, passes }))
}

/// Creates the system of another problem, and guesses its solution from trajectories; the method is
/// unchanged, and every segment has as many intervals as the present segment with the most
/// intervals.
fn discretised_alike(
    like: &DiscretisedProblem,
    guess: Guess<ErasedProblem>,
    p: &[f64],
) -> Result<(BoundarySystem, Vec<f64>), Failure> {
    guess.discretised(p, like.method.clone(), most_intervals(like))
}

impl OrbitEvents for Solutions {
    fn limits(&self, p: &[f64]) -> Vec<Limit> {
        self.equations.problem.itineraries().map_or_else(Vec::new, |it| it.limits(p))
    }

    fn check(&self, x: &[f64]) -> Result<(), Failure> {
        let layout = &*self.equations.layout;
        let work = gathered(layout, x);
        itineraries_of(&*self.equations.problem)?.check_ends(ends_in(layout, &work), &work.q)
    }

    fn jump_between(&self, solutions: [&[f64]; 2]) -> Option<Jump> {
        let layout = &*self.equations.layout;
        let works = solutions.map(|x| gathered(layout, x));
        let ends = works.each_ref().map(|work| (ends_in(layout, work), &work.q[..]));
        self.equations.problem.itineraries()?.jump_between(ends)
    }

    fn name_of_limit(&self, monitor: usize, x: &[f64]) -> Option<&'static str> {
        let (z, p) = x.split_at(self.equations.layout.dimension);
        let Known { problem, trajectories, q } = self.equations.trajectories_of(z, p);
        problem.itineraries()?.name_of_limit(monitor, &trajectories, &q)
    }

    /// The solution on the other side of a limit of admissible solutions is computed once, and kept
    /// for later calls with the same solution.
    fn across(&mut self, x: &[f64], passes: bool) -> Result<Option<Across<'_>>, Failure> {
        let known = |beside: &Beside| beside.at == x && beside.passes == passes;
        if !self.beside.as_ref().is_some_and(known) {
            self.beside = beside(self, x, passes)?;
        }
        let Some(Beside { system, x, .. }) = &mut self.beside else { return Ok(None) };
        Ok(Some(Across { system: &mut **system, x }))
    }

    fn emanating(&self, x: &[f64], which: usize) -> Result<Emanating, Failure> {
        let (z, p) = x.split_at(self.equations.layout.dimension);
        let Known { problem, trajectories, q } = self.equations.trajectories_of(z, p);
        let guess = itineraries_of(&*problem)?.emanating(&trajectories, &q, which)?;
        let beside = guess.beside.clone();
        let (system, z) = discretised_alike(&self.equations, guess, p)?;
        let near = beside.map(|(near, extras)| system.filled(&near, &extras, p)).transpose()?;
        let along = near.map(|near| {
            let across = near.iter().zip(&z).map(|(near, z)| near - z);
            across.chain(p.iter().map(|_| 0.0)).collect()
        });
        Ok(Emanating { system: Box::new(system), z, along })
    }
}
