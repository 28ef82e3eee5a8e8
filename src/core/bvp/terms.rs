//! Components of boundary-value problems: shapes, ends of segments, and monitors.

use crate::core::problem::{Measure, Observable};
use crate::core::scalar::Scalar;

/// The states at the two ends of all segments, segment by segment.
#[derive(Clone, Copy, Debug)]
pub struct Ends<'a, T> {
    /// The states at the starts of the segments.
    pub start: &'a [T],
    /// The states at the ends of the segments; the end of a segment has the mesh coordinate 1, or
    /// the number of periods if the solution spans several periods.
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
    /// The scalar: a state of the segment, or a function that the problem defines on the segment,
    /// numbered as in [`BoundaryProblem::watch`](super::problem::BoundaryProblem::watch).
    pub observable: Observable,
    /// For the start and for the end of the segment, whether the scalar vanishes by construction in
    /// the event there; if it does, its value there does not count as a distance
    /// ([`Measure::Distance`]).
    pub vanishes: [bool; 2],
    /// For the start and for the end of the segment, whether the scalar can have any value there: at the
    /// start after an event that moves the state at a given time, at the end before the event of another
    /// guard. If the flag is set, the value there can count as a distance.
    pub free: [bool; 2],
}

impl Watched {
    /// Creates a monitored scalar on a segment.
    pub fn new(segment: usize, observable: Observable) -> Self {
        Watched { segment, observable, vanishes: [false; 2], free: [false; 2] }
    }

    /// Creates the monitored scalar for a state on a segment.
    pub fn state(segment: usize, state: usize) -> Self {
        Watched::new(segment, Observable::State(state))
    }

    /// Creates the monitored scalar for a function that the problem defines on a segment.
    pub fn function(segment: usize, function: usize) -> Self {
        Watched::new(segment, Observable::Function(function))
    }

    /// Sets whether the monitored scalar vanishes by construction in the events at the start and at
    /// the end of the segment.
    pub fn vanishing(self, vanishes: [bool; 2]) -> Self {
        Watched { vanishes, ..self }
    }

    /// Sets whether the scalar can have any value at the start and at the end of the segment.
    pub fn with_free_ends(self, free: [bool; 2]) -> Self {
        Watched { free, ..self }
    }
}

/// A quantity that is recorded along a branch: a measure of scalars on segments. The extrema of the
/// scalars are taken along the whole solution, not only at mesh points.
pub type Monitor = Measure<Vec<Watched>, Vec<Watched>>;

impl Monitor {
    /// The monitor for the largest value of a state on a segment.
    pub fn maximum(segment: usize, state: usize) -> Self {
        Measure::Maximum(vec![Watched::state(segment, state)])
    }

    /// The monitor for the smallest value of a state on a segment.
    pub fn minimum(segment: usize, state: usize) -> Self {
        Measure::Minimum(vec![Watched::state(segment, state)])
    }

    /// Returns all monitored scalars, including distances, from which the measure is computed.
    pub(super) fn watched(&self) -> impl Iterator<Item = &Watched> {
        let all = match self {
            Measure::Distance(surfaces) | Measure::Penetration(surfaces) => vec![surfaces],
            of_scalars => of_scalars.scalars(),
        };
        all.into_iter().flatten()
    }

    /// Returns the scalars or distances whose extrema determine the measure; empty for measures
    /// without extrema.
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
    /// Boundary values: solutions are not periodic and do not have Floquet multipliers.
    #[default]
    BoundaryValues,
    /// Periodic orbits: one segment with exactly the boundary conditions `x(0) − x(1) = 0`.
    Periodic {
        /// Whether the problem is invariant under shifts of time; an invariant problem needs a
        /// phase condition, and its period is an extra unknown.
        phase: bool,
    },
    /// Periodic orbits of consecutive segments: each segment ends at an event that leads to the
    /// next segment; the event of the last segment leads to the first segment. Only problems within
    /// this crate can define boundary conditions for consecutive segments, with the method
    /// `segment_end_in`: conditions for the initial states of the segments, functions that vanish
    /// at the ends of the segments, and, under forcing, `cycle − Σ durations`.
    ///
    /// For periodic orbits of consecutive segments, the extra unknowns are the durations of the
    /// segments and, under forcing, the start time of the cycle. The equations of a segment are
    /// evaluated at a vector `q` that consists of the parameters, the segment's start time and the
    /// segment's duration.
    Cycle {
        /// Whether the start time of the cycle is an unknown, as under forcing.
        forced: bool,
    },
    /// Cycles of a map: time does not pass along segments, and the first boundary conditions `x(0)
    /// − f = 0` lead back to the initial states of the first segment.
    MapCycle,
}

impl Shape {
    /// Whether the problem is invariant under shifts of time.
    pub(super) fn phase(self) -> bool {
        self == Shape::Periodic { phase: true }
    }

    /// Whether time passes along segments, which is false only for cycles of maps.
    pub(super) fn moves(self) -> bool {
        self != Shape::MapCycle
    }

    /// For segments of a cycle, whether the start time of the cycle is an unknown; `None` for other
    /// shapes.
    pub(super) fn cycle(self) -> Option<bool> {
        if let Shape::Cycle { forced } = self { Some(forced) } else { None }
    }

    /// Returns the return conditions for segments with given numbers of states: the first segment's
    /// states return and, under forcing, the start time also returns, modulo the forcing's period.
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

/// A return condition `y − Y = 0`, which says that an unknown `y` at the start of a period equals
/// its value `Y` a period later. Perturbations of a solution with `μ y = Y` belong to the Floquet
/// multiplier `μ`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::core) struct Return {
    /// The index of the return condition among the boundary conditions.
    pub condition: usize,
    /// The unknown `y` at the start of a period, whose coefficient in the return condition `y − Y =
    /// 0` is 1 (apart from terms in `Y`).
    pub unknown: Unknown,
}

/// An unknown of a boundary-value problem, given by its index.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::core) enum Unknown {
    /// A state at the start of its segment, counted over all segments as in [`Ends::start`].
    Start(usize),
    /// An extra unknown, numbered as in
    /// [`BoundaryProblem::extras`](super::problem::BoundaryProblem::extras).
    Extra(usize),
}
