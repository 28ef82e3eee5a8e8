//! Solutions from which branches start.

use super::kind::Kind;

/// A solution from which a branch is to start, as it was saved: not always of the same discretisation,
/// nor even of the same system.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Solution {
    /// What kind of special point it is.
    pub kind: Option<Kind>,
    /// The mesh that its unknowns are values on, if there is one.
    pub mesh: Vec<f64>,
    /// The unknowns.
    pub state: Vec<f64>,
    /// All parameters, in the order of the system that it is to start.
    pub parameters: Vec<f64>,
    /// The direction of its branch by the unknowns (as long as `state`), where it is known.
    pub tangent: Option<Vec<f64>>,
    /// Whether the branch is to be left for another one.
    pub switch: bool,
}

/// How a branch starts from a [`Solution`].
#[derive(Clone, Debug, PartialEq)]
pub struct Adopted {
    /// The unknowns `z`.
    pub z: Vec<f64>,
    /// The direction of the branch by the unknowns, where it is known.
    pub tangent: Option<Vec<f64>>,
    /// How the solution is left.
    pub leaving: Leaving,
}

/// How a branch leaves the solution it starts from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Leaving {
    /// Along the curve through it.
    Along,
    /// It is a branch point, whose tangents solve the algebraic bifurcation equation.
    BranchPoint,
    /// In the direction given, though the equations are singular there.
    Direction,
}
