//! Itineraries of solutions: orbits with events, and cycles of maps.

use super::terms::Ends;
use super::trajectory::Trajectory;
use crate::core::failure::Failure;
use crate::core::system::{Jump, Limit};

/// A problem whose solutions follow an itinerary, which is the ordered list of an orbit's events.
/// Solutions with another itinerary solve another problem of the same type `P`.
///
/// At a *limit*, a monitor that is positive on admissible solutions vanishes, and branches of
/// solutions with other itineraries emanate. A solution is given by its trajectory on each segment,
/// and by its vector `q` of parameters and extra unknowns.
pub trait Itineraries<P> {
    /// Returns the itinerary in the form of the text that is saved with branches.
    fn words(&self) -> String;

    /// Creates the problem whose itinerary is given as saved text.
    ///
    /// # Errors
    /// [`Failure::Mismatch`] if the text does not describe an itinerary of this family of problems.
    fn with_words(&self, words: &str) -> Result<P, Failure>;

    /// Creates the problem of the doubled itinerary: all segments occur twice, each with its extra
    /// unknowns; extra unknowns that belong to no segment occur once, before the extra unknowns of
    /// the segments. Returns `None` if a doubled solution has the same segments on a mesh of twice
    /// the length.
    fn doubled(&self) -> Option<P>;

    /// Creates the problem of half the itinerary if the itinerary consists of two equal halves;
    /// otherwise returns `None`.
    fn halved(&self) -> Option<P> {
        None
    }

    /// Creates the problem of solutions that last several times as long as a solution of this
    /// problem, and returns it with the vector `q` of the corresponding solution. Returns `None` if
    /// no problem describes solutions that last several times as long.
    fn spanning(&self, _durations: f64, _q: &[f64]) -> Option<(P, Vec<f64>)> {
        None
    }

    /// Returns the extra unknowns of a solution that is rewritten to begin with a later segment;
    /// the start time is chosen so that the extra unknowns are nearest to `near`. Returns `None` if
    /// the solution that begins with the later segment does not solve this problem.
    fn rotated(&self, _segments: usize, _q: &[f64], _near: &[f64]) -> Option<Vec<f64>> {
        None
    }

    /// Checks that each segment of a solution leads to the next segment that the solution's
    /// itinerary prescribes.
    ///
    /// # Errors
    /// [`Failure`] that states where the offending segment ends, the time of this end, and the mode
    /// to which it leads.
    fn check_ends(&self, _ends: Ends<f64>, _q: &[f64]) -> Result<(), Failure> {
        Ok(())
    }

    /// Compares two solutions, each given by the states at the ends of its segments and by its
    /// vector `q`, and returns an event that leads to different modes in the two solutions; `None`
    /// if all events lead to the same modes.
    fn jump_between(&self, _solutions: [(Ends<f64>, &[f64]); 2]) -> Option<Jump> {
        None
    }

    /// Returns the limits at which the admissible solutions with this itinerary end, at the
    /// parameters `p`.
    fn limits(&self, _p: &[f64]) -> Vec<Limit> {
        Vec::new()
    }

    /// Returns the standard name of the bifurcation at a limit of admissible solutions, where the
    /// monitor of the limit vanishes; `None` if the bifurcation has no standard name.
    fn name_of_limit(
        &self,
        _monitor: usize,
        _known: &[Trajectory],
        _q: &[f64],
    ) -> Option<&'static str> {
        None
    }

    /// Returns a guess of a branch that emanates at a limit of admissible solutions; the branches
    /// are counted from 0.
    ///
    /// # Errors
    /// [`Failure`] if no emanating branch is known, and [`Failure::no_branch`] for an index that is
    /// too large.
    fn emanating(&self, known: &[Trajectory], q: &[f64], which: usize)
    -> Result<Guess<P>, Failure>;

    /// Returns a guess of the solution on the other side of a limit of admissible solutions. If the
    /// known solution `passes` the event that vanishes at the limit, the guess does not include
    /// this event; otherwise the guess includes it. Returns `None` if no guess is known, or if the
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

/// A guess of a solution, given by its trajectories and used as the start of a branch.
pub struct Guess<P> {
    /// The boundary-value problem that the guessed solution solves.
    pub problem: P,
    /// The guessed trajectory on each segment.
    pub trajectories: Vec<Trajectory>,
    /// The extra unknowns.
    pub extras: Vec<f64>,
    /// The trajectories and extra unknowns of a neighbouring solution to first order, which
    /// determine the direction of the branch if the equations are singular; otherwise `None`.
    pub beside: Option<(Vec<Trajectory>, Vec<f64>)>,
}
