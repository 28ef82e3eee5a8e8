//! Itineraries of solutions: orbits with events, and cycles of maps.

use super::terms::Ends;
use super::trajectory::Trajectory;
use crate::core::failure::Failure;
use crate::core::system::{Jump, Limit};

/// A problem whose solutions follow an itinerary: the ordered events of an orbit. Solutions with
/// another itinerary solve another problem `P` of the same family.
///
/// At a *limit*, a monitor that is positive on admissible solutions vanishes, and solutions with
/// another itinerary emanate. A solution is given by its trajectory on each segment and its numbers
/// `q`.
pub trait Itineraries<P> {
    /// The itinerary in words, as saved with branches.
    fn words(&self) -> String;

    /// Creates the problem with a saved itinerary.
    ///
    /// # Errors
    /// [`Failure::Mismatch`] if this problem has no such itinerary.
    fn with_words(&self, words: &str) -> Result<P, Failure>;

    /// Creates the problem of the doubled itinerary: all segments with their extra unknowns twice,
    /// the extra unknowns before them once. `None` if a mesh of twice the length represents a
    /// solution of two periods.
    fn doubled(&self) -> Option<P>;

    /// Creates the problem of half the itinerary, if the itinerary repeats itself; otherwise `None`.
    fn halved(&self) -> Option<P> {
        None
    }

    /// Creates the problem whose duration spans several durations of this problem, and the numbers of
    /// a solution there. `None` if no such problem exists.
    fn spanning(&self, _durations: f64, _q: &[f64]) -> Option<(P, Vec<f64>)> {
        None
    }

    /// The extra unknowns of the same solution when it begins with a later segment; the time of its
    /// start is chosen nearest to the extra unknowns `near`. `None` if the rotated solution does
    /// not solve this problem.
    fn rotated(&self, _segments: usize, _q: &[f64], _near: &[f64]) -> Option<Vec<f64>> {
        None
    }

    /// Returns an error for a solution whose segments do not follow each other as in its itinerary.
    ///
    /// # Errors
    /// [`Failure`] with the segment's end, its time, and the mode to which it leads.
    fn check_ends(&self, _ends: Ends<f64>, _q: &[f64]) -> Result<(), Failure> {
        Ok(())
    }

    /// A sudden change of an event's next mode on the way from one solution to another, both given by
    /// their ends and numbers `q`; `None` if there is no such change.
    fn jump_between(&self, _solutions: [(Ends<f64>, &[f64]); 2]) -> Option<Jump> {
        None
    }

    /// The limits at parameters `p`.
    fn limits(&self, _p: &[f64]) -> Vec<Limit> {
        Vec::new()
    }

    /// The standard name of the solution at which a limit vanishes; `None` if it does not have one.
    fn name_of_limit(
        &self,
        _monitor: usize,
        _known: &[Trajectory],
        _q: &[f64],
    ) -> Option<&'static str> {
        None
    }

    /// A guess of one of the branches that emanate at a limit, counted from 0.
    ///
    /// # Errors
    /// [`Failure`] if no branch is known, and [`Failure::no_branch`] for an index that is too large.
    fn emanating(&self, known: &[Trajectory], q: &[f64], which: usize)
    -> Result<Guess<P>, Failure>;

    /// A guess of the solution on the other side of a limit: without the vanishing event if the
    /// solution `passes` that event, otherwise with the event. `None` if no guess is known, or if the
    /// event changes nothing at the limit and is not `wanted`.
    ///
    /// # Errors
    /// [`Failure`] if the computation of the guess fails.
    fn across(
        &self,
        known: &[Trajectory],
        q: &[f64],
        passes: bool,
        wanted: bool,
    ) -> Result<Option<Guess<P>>, Failure>;
}

/// A guess of a solution by its trajectories, used as the start of a branch.
pub struct Guess<P> {
    /// The problem of the solution.
    pub problem: P,
    /// The trajectory on each segment.
    pub trajectories: Vec<Trajectory>,
    /// The extra unknowns.
    pub extras: Vec<f64>,
    /// Trajectories and extra unknowns of a neighbour to first order, which determine the direction
    /// of the branch if the equations are singular; otherwise `None`.
    pub beside: Option<(Vec<Trajectory>, Vec<f64>)>,
}
