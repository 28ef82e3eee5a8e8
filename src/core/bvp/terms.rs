//! What boundary-value problems are described with: shapes, ends, monitors.

use crate::core::problem::{Measure, Observable};
use crate::core::scalar::Scalar;

/// States at the two ends of all segments, one segment after the other.
#[derive(Clone, Copy, Debug)]
pub struct Ends<'a, T> {
    /// States where the segments begin.
    pub start: &'a [T],
    /// States where they end: where their meshes do, at 1 or at the number of periods.
    pub end: &'a [T],
}

impl<T: Scalar> Ends<'_, T> {
    /// `x(0) − x(1)`, written into `b`.
    pub(in crate::core) fn close(&self, b: &mut [T]) {
        let ends = self.start.iter().zip(self.end);
        b.iter_mut().zip(ends).for_each(|(b, (start, end))| *b = *start - *end);
    }
}

/// A scalar that is watched along a segment.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Watched {
    /// The segment.
    pub segment: usize,
    /// The scalar; functions are those of
    /// [`BoundaryProblem::watch`](super::problem::BoundaryProblem::watch).
    pub observable: Observable,
    /// Whether the scalar vanishes by construction in the events that begin and end the segment,
    /// so that it is no distance there ([`Measure::Distance`]).
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

    /// A function of the problem's own on a segment.
    pub fn function(segment: usize, function: usize) -> Self {
        Watched::new(segment, Observable::Function(function))
    }

    /// The same scalar with whether it vanishes in the events that begin and end the segment.
    pub fn vanishing(self, vanishes: [bool; 2]) -> Self {
        Watched { vanishes, ..self }
    }
}

/// A number of a solution that is recorded along a branch: a measure of scalars on segments.
/// Extremes are taken along the whole solution, not at mesh points only.
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

    /// The scalars, or distances, whose extremes make up the measure; none for other measures.
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

/// What the boundary conditions of a problem mean: whether solutions are periodic, and how a period
/// leads to the next.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Shape {
    /// Boundary values: solutions are not periodic, and have no multipliers.
    #[default]
    BoundaryValues,
    /// Periodic orbits: one segment with the boundary conditions `x(0) − x(1) = 0` and no others.
    Periodic {
        /// Whether a shift of time leaves the problem as it is, so that a phase condition is
        /// needed, which determines the period as a further unknown.
        phase: bool,
    },
    /// Periodic orbits in segments that follow one another in time, each up to an event that leads
    /// to the next one, the last to the first. Only problems within this crate can state their
    /// conditions, as `segment_end_in`: the states at which segments begin, what vanishes where
    /// they end, and under forcing `cycle − Σ durations`.
    ///
    /// Extras are the time of the start (under forcing) and the durations. A segment depends on
    /// parameters, the time at which it begins, and its duration: these are the numbers `q` with
    /// which its equations are evaluated.
    Cycle {
        /// Whether the time of the start is unknown.
        forced: bool,
    },
    /// Cycles of a map: nothing moves along segments, and the states that the first boundary
    /// conditions lead to, `x(0) − f = 0`, are those at which the first segment begins.
    MapCycle,
}

impl Shape {
    /// Whether a shift of time leaves the problem as it is.
    pub(super) fn phase(self) -> bool {
        self == Shape::Periodic { phase: true }
    }

    /// Whether anything moves along segments.
    pub(super) fn moves(self) -> bool {
        self != Shape::MapCycle
    }

    /// Of segments of a cycle, whether the time of the start is unknown.
    pub(super) fn cycle(self) -> Option<bool> {
        if let Shape::Cycle { forced } = self { Some(forced) } else { None }
    }

    /// The conditions by which a period leads to the next, for segments with these numbers of
    /// states: the first segment's states return and, under forcing, so does the starting
    /// time, modulo the forcing's period.
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

/// A condition by which a period leads to the next, `y − Y = 0`: an unknown `y` of the period's
/// start must be what the period leads to, `Y`. About the solution, perturbations `μ y = Y` belong
/// to the multiplier `μ`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::core) struct Return {
    /// Which boundary condition it is.
    pub condition: usize,
    /// The unknown `y`, which the condition contains with the coefficient 1 (less what is in `Y`).
    pub unknown: Unknown,
}

/// An unknown of a boundary-value problem.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::core) enum Unknown {
    /// A state where its segment begins, counted over all segments as in [`Ends::start`].
    Start(usize),
    /// A further unknown number, as in
    /// [`BoundaryProblem::extras`](super::problem::BoundaryProblem::extras).
    Extra(usize),
}
