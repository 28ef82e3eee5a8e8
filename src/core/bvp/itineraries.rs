//! What problems know of solutions that go through an itinerary: orbits with events, and cycles of
//! maps.

use super::terms::Ends;
use super::trajectory::Trajectory;
use crate::core::failure::Failure;
use crate::core::system::{Jump, Limit};

/// A problem whose solutions follow an itinerary: the events of an orbit, in their order. Solutions
/// with another itinerary solve another problem `P` of the same family.
///
/// At a *limit* a monitor vanishes that is positive on admissible solutions, and solutions with
/// another itinerary emanate. A solution is given by its trajectory on each segment and its numbers
/// `q`.
pub trait Itineraries<P> {
    /// The itinerary in words, which are saved with branches.
    fn words(&self) -> String;

    /// The problem whose solutions go through a saved itinerary.
    ///
    /// # Errors
    /// [`Failure::Mismatch`] if it has no meaning for this problem.
    fn with_words(&self, words: &str) -> Result<P, Failure>;

    /// The problem of the doubled itinerary: all segments with their extras twice, the extras
    /// before them once. `None` if a mesh twice as long represents a solution of two periods.
    fn doubled(&self) -> Option<P>;

    /// The problem of half the itinerary, where that goes through everything twice. `None` if it
    /// does not.
    fn halved(&self) -> Option<P> {
        None
    }

    /// The problem one duration of which spans several durations of this problem, and the numbers
    /// of a solution there. `None` if no such problem exists.
    fn spanning(&self, _durations: f64, _q: &[f64]) -> Option<(P, Vec<f64>)> {
        None
    }

    /// The extras of the same solution if it begins with a later segment, at a time near that of
    /// the extras `near`. `None` if the rotated solution does not solve this problem.
    fn rotated(&self, _segments: usize, _q: &[f64], _near: &[f64]) -> Option<Vec<f64>> {
        None
    }

    /// Refuses a solution whose segments do not lead from one to the next as its itinerary says.
    ///
    /// # Errors
    /// [`Failure`] with the segment's end, its time, and where it leads.
    fn check_ends(&self, _ends: Ends<f64>, _q: &[f64]) -> Result<(), Failure> {
        Ok(())
    }

    /// Where an event leads elsewhere at once on the way from one solution to another, both given by
    /// their ends and numbers `q`; `None` where none does.
    fn jump_between(&self, _solutions: [(Ends<f64>, &[f64]); 2]) -> Option<Jump> {
        None
    }

    /// The limits at parameters `p`.
    fn limits(&self, _p: &[f64]) -> Vec<Limit> {
        Vec::new()
    }

    /// The standard name of the solution at which a limit vanishes; `None` if it has none.
    fn name_of_limit(
        &self,
        _monitor: usize,
        _known: &[Trajectory],
        _q: &[f64],
    ) -> Option<&'static str> {
        None
    }

    /// One of the branches that emanate at a limit, counted from 0.
    ///
    /// # Errors
    /// [`Failure`] if none is known, and [`Failure::no_branch`] for a number that does not exist.
    fn emanating(&self, known: &[Trajectory], q: &[f64], which: usize)
    -> Result<Guess<P>, Failure>;

    /// The solution on the other side of a limit: without the vanishing event if the solution
    /// `passes` that event, otherwise with the event. `None` if none is known, or if the event
    /// changes nothing at the limit and is not `wanted`.
    ///
    /// # Errors
    /// [`Failure`] if it cannot be found.
    fn across(
        &self,
        known: &[Trajectory],
        q: &[f64],
        passes: bool,
        wanted: bool,
    ) -> Result<Option<Guess<P>>, Failure>;
}

/// A guess of a solution, by its trajectories: where a branch of a problem starts.
pub struct Guess<P> {
    /// The problem that it solves.
    pub problem: P,
    /// The trajectory on each segment.
    pub trajectories: Vec<Trajectory>,
    /// The extras.
    pub extras: Vec<f64>,
    /// Trajectories and extras of a neighbour to first order, which gives the direction of the
    /// branch where the equations are singular; `None` where they determine it.
    pub beside: Option<(Vec<Trajectory>, Vec<f64>)>,
}
