//! Solutions from which branches start.

use super::kind::Kind;

/// A solution from which a branch is to start, as it was saved: not always of the same discretisation,
/// nor even of the same system.
#[derive(Clone, Debug, PartialEq)]
pub struct Solution {
    /// What kind of special point it is.
    pub kind: Kind,
    /// What it goes through, where solutions can differ in that.
    pub itinerary: String,
    /// The mesh that its unknowns are values on, if there is one.
    pub mesh: Vec<f64>,
    /// The unknowns.
    pub state: Vec<f64>,
    /// All parameters, in the order of the system that it is to start.
    pub parameters: Vec<f64>,
    /// The direction of its branch, where it is known: by the unknowns (as long as `state`) and by the
    /// parameters (as long as `parameters`).
    pub tangent: Option<(Vec<f64>, Vec<f64>)>,
    /// Whether the branch is to be left for another one.
    pub switch: bool,
}

/// How a branch starts from a [`Solution`].
#[derive(Clone, Debug, PartialEq)]
pub struct Adopted {
    /// The unknowns `z`.
    pub z: Vec<f64>,
    /// The direction `(z, p)` of the branch, where it is known.
    pub tangent: Option<Vec<f64>>,
    /// How the solution is left.
    pub leaving: Leaving,
}

/// How a branch leaves the solution it starts from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Leaving {
    /// Along the curve through it.
    Along,
    /// Along the curve through it, which is the other one already.
    Switched,
    /// It is a branch point, whose tangents solve the algebraic bifurcation equation, and both sides of the
    /// other branch are the same.
    BranchPoint,
    /// In the direction given, though the equations are singular there, and to that side only.
    Direction,
}
