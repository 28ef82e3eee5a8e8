//! Components of boundary-value problems: shapes, ends, monitors.

use crate::core::problem::{Measure, Observable};
use crate::core::scalar::Scalar;

/// The states at the two ends of all segments, one segment after the other.
#[derive(Clone, Copy, Debug)]
pub struct Ends<'a, T> {
    /// The states at the starts of the segments.
    pub start: &'a [T],
    /// The states at the ends of the segments, at the mesh end 1 or the number of periods.
    pub end: &'a [T],
}

impl<T: Scalar> Ends<'_, T> {
    /// Writes `x(0) − x(1)` into `b`.
    pub(in crate::core) fn close(&self, b: &mut [T]) {
        let ends = self.start.iter().zip(self.end);
        b.iter_mut().zip(ends).for_each(|(b, (start, end))| *b = *start - *end);
    }
}

/// A monitored scalar along a segment.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Watched {
    /// The segment.
    pub segment: usize,
    /// The scalar; a function refers to
    /// [`BoundaryProblem::watch`](super::problem::BoundaryProblem::watch).
    pub observable: Observable,
    /// Whether the scalar vanishes by construction in the events that begin and end the segment, so
    /// that it does not count as a distance there ([`Measure::Distance`]).
    pub vanishes: [bool; 2],
}

impl Watched {
    /// A scalar on a segment.
    pub fn new(segment: usize, observable: Observable) -> Self {
        Watched { segment, observable, vanishes: [false; 2] }
    }

    /// A state on a segment.
    pub fn state(segment: usize, state: usize) -> Self {
        Watched::new(segment, Observable::State(state))
    }

    /// A function that the problem defines on a segment.
    pub fn function(segment: usize, function: usize) -> Self {
        Watched::new(segment, Observable::Function(function))
    }

    /// Sets whether the scalar vanishes in the events that begin and end the segment.
    pub fn vanishing(self, vanishes: [bool; 2]) -> Self {
        Watched { vanishes, ..self }
    }
}

/// A number that is recorded along a branch: a measure of scalars on segments. Extremes are taken
/// along the whole solution, not only at mesh points.
pub type Monitor = Measure<Vec<Watched>, Vec<Watched>>;

impl Monitor {
    /// The largest value of a state on a segment.
    pub fn maximum(segment: usize, state: usize) -> Self {
        Measure::Maximum(vec![Watched::state(segment, state)])
    }

    /// The smallest value of a state on a segment.
    pub fn minimum(segment: usize, state: usize) -> Self {
        Measure::Minimum(vec![Watched::state(segment, state)])
    }

    /// All scalars and distances of the measure.
    pub(super) fn watched(&self) -> impl Iterator<Item = &Watched> {
        let all = match self {
            Measure::Distance(surfaces) | Measure::Penetration(surfaces) => vec![surfaces],
            of_scalars => of_scalars.scalars(),
        };
        all.into_iter().flatten()
    }

    /// The scalars, or distances, whose extremes determine the measure; empty for other measures.
    pub(super) fn of_extremes(&self) -> &[Watched] {
        match self {
            Measure::Maximum(all)
            | Measure::Minimum(all)
            | Measure::Range(all)
            | Measure::Distance(all)
            | Measure::Penetration(all) => all,
            _ => &[],
        }
    }
}

/// The meaning of a problem's boundary conditions: whether solutions are periodic, and how one period
/// leads to the next.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Shape {
    /// Boundary values: solutions are not periodic and have no Floquet multipliers.
    #[default]
    BoundaryValues,
    /// Periodic orbits: one segment with exactly the boundary conditions `x(0) − x(1) = 0`.
    Periodic {
        /// Whether the problem is invariant under shifts of time; a phase condition is then needed,
        /// and the period is a further unknown.
        phase: bool,
    },
    /// Periodic orbits of consecutive segments, each up to an event that leads to the next segment,
    /// the last one to the first. Only problems within this crate can define their conditions, by
    /// `segment_end_in`: the initial states of segments, the functions that vanish at their ends, and
    /// under forcing `cycle − Σ durations`.
    ///
    /// The extra unknowns are the start time (under forcing) and the durations. A segment depends
    /// on the parameters, its start time and its duration: these are the numbers `q` at which its
    /// equations are evaluated.
    Cycle {
        /// Whether the start time is unknown.
        forced: bool,
    },
    /// Cycles of a map: there is no motion along segments, and the first boundary conditions
    /// `x(0) − f = 0` lead back to the initial states of the first segment.
    MapCycle,
}

impl Shape {
    /// Whether the problem is invariant under shifts of time.
    pub(super) fn phase(self) -> bool {
        self == Shape::Periodic { phase: true }
    }

    /// Whether there is motion along segments.
    pub(super) fn moves(self) -> bool {
        self != Shape::MapCycle
    }

    /// For segments of a cycle, whether the start time is unknown.
    pub(super) fn cycle(self) -> Option<bool> {
        if let Shape::Cycle { forced } = self { Some(forced) } else { None }
    }

    /// The return conditions for segments with these numbers of states: the first segment's states
    /// return and, under forcing, so does the start time, modulo the forcing's period.
    pub(super) fn returns(self, states: &[usize]) -> Vec<Return> {
        let of_states = |i| Return { condition: i, unknown: Unknown::Start(i) };
        let mut returns: Vec<Return> = (0..states[0]).map(of_states).collect();
        match self {
            Shape::BoundaryValues => returns.clear(),
            Shape::Cycle { forced: true } => {
                let condition = states.iter().sum::<usize>() + states.len();
                returns.push(Return { condition, unknown: Unknown::Extra(0) });
            }
            _ => {}
        }
        returns
    }
}

/// A return condition, `y − Y = 0`: an unknown `y` at the start of a period equals its value `Y` a
/// period later. Perturbations of a solution with `μ y = Y` belong to the Floquet multiplier `μ`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::core) struct Return {
    /// The index of the boundary condition.
    pub condition: usize,
    /// The unknown `y`, which has the coefficient 1 in the condition (apart from terms in `Y`).
    pub unknown: Unknown,
}

/// An unknown of a boundary-value problem.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::core) enum Unknown {
    /// A state at the start of its segment, counted over all segments as in [`Ends::start`].
    Start(usize),
    /// A further unknown number, as in
    /// [`BoundaryProblem::extras`](super::problem::BoundaryProblem::extras).
    Extra(usize),
}
