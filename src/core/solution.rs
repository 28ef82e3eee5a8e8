//! Solutions from which branches start, and periodic ones as closed curves, which are the same from
//! any of their points.

use super::kind::Kind;

/// A solution from which a branch is to start, as it was saved: not always of the same
/// discretisation, nor even of the same system.
#[derive(Clone, Debug, PartialEq)]
pub struct Solution {
    /// What kind of special point it is.
    pub kind: Kind,
    /// What it goes through, where solutions can differ in that.
    pub itinerary: String,
    /// The method of its discretisation, as [`Branch::method`](super::continuation::Branch::method).
    pub method: String,
    /// The mesh that its unknowns are values on, if there is one.
    pub mesh: Vec<f64>,
    /// The unknowns.
    pub state: Vec<f64>,
    /// All parameters, in the order of the system that it is to start.
    pub parameters: Vec<f64>,
    /// The direction of its branch, where it is known: by the unknowns (as long as `state`) and by
    /// the parameters (as long as `parameters`).
    pub tangent: Option<(Vec<f64>, Vec<f64>)>,
    /// The other branch to follow, counted from 0; `None` to stay on this one.
    pub switch: Option<usize>,
}

/// A [`Solution`] taken over by a system.
#[derive(Clone, Debug, PartialEq)]
pub struct Adopted {
    /// The unknowns `z`.
    pub z: Vec<f64>,
    /// How a branch starts there.
    pub start: Start,
}

/// How a branch starts. Directions are `(z, p)`.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Start {
    /// At a point of the curve, or a guess of one.
    Point {
        /// The direction of the curve, where it is known.
        tangent: Option<Vec<f64>>,
    },
    /// Where the curve is born, at a level that defines its birth.
    Birth {
        /// Its direction, to that side only, where the equations are singular there.
        along: Option<Vec<f64>>,
    },
    /// At a branch point, whose tangents solve the algebraic bifurcation equations.
    BranchPoint {
        /// The direction of the branch that leads to it, where it is known.
        along: Option<Vec<f64>>,
        /// Whether both sides of the other branch are the same.
        one_sided: bool,
    },
    /// In this direction, though the equations are singular there, and to that side only.
    Direction(Vec<f64>),
}

impl Start {
    /// The direction that is known, as one of the curve that begins: where solutions are born it is
    /// one of `solutions`, not of a curve of special points, and elsewhere one of the curve on
    /// which the start was found.
    pub(crate) fn direction(&self, same_curve: bool, solutions: bool) -> Option<&Vec<f64>> {
        match self {
            Start::Point { tangent: known } | Start::BranchPoint { along: known, .. } => {
                known.as_ref().filter(|_| same_curve)
            }
            Start::Direction(known) => Some(known),
            Start::Birth { along } => along.as_ref().filter(|_| solutions),
        }
    }
}

/// Periodic solutions as closed curves: their phase, how often they repeat themselves, their
/// amplitude.
pub trait Cycles {
    /// Whether a solution goes through everything twice, so that it has half the period.
    fn repeats(&mut self, x: &[f64]) -> bool;

    /// The oscillation of a cycle about its mean, as a share of that of the cycle accepted last: it
    /// changes sign where a family of cycles passes through an equilibrium. `None` if cycles cannot
    /// shrink to equilibria.
    fn amplitude(&mut self, x: &[f64]) -> Option<f64>;

    /// The period, if it is free: not one that a forcing prescribes.
    fn free_period(&mut self, x: &[f64]) -> Option<f64>;
}
