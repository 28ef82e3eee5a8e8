//! Solutions from which branches start.

use super::kind::Kind;

/// A saved solution from which a branch is to start. The new branch can use another discretisation
/// than the saved solution, and even another system.
#[derive(Clone, Debug, PartialEq)]
pub struct Solution {
    /// The kind of special point of the saved solution.
    pub kind: Kind,
    /// The kind of bifurcation, if the saved solution lies on a curve of bifurcation points; `None`
    /// if it lies on a branch of ordinary solutions.
    pub condition: Option<Kind>,
    /// The itinerary of the solution, if solutions of its system can have different itineraries.
    pub itinerary: String,
    /// The discretisation method, as in [`Branch::method`](crate::core::continuation::Branch::method).
    pub method: String,
    /// The mesh on which the unknowns are given; empty if the solution has no mesh.
    pub mesh: Vec<f64>,
    /// The unknowns.
    pub state: Vec<f64>,
    /// The values of all parameters, in the order of the system of the new branch.
    pub parameters: Vec<f64>,
    /// The direction of the solution's branch, if known: a component for each unknown (of the same
    /// length as `state`), and a component for each parameter (of the same length as `parameters`).
    pub tangent: Option<(Vec<f64>, Vec<f64>)>,
    /// The parameter values at which `state` solves the equations on its own mesh, minus
    /// `parameters`, whose values were refined on finer meshes (a component for each parameter);
    /// `None` if the difference is zero.
    pub mesh_shift: Option<Vec<f64>>,
    /// The number of critical eigenvalues, or of critical pairs, at a special point; 0 if unknown.
    pub multiplicity: usize,
    /// The frequency of a Hopf point, if known.
    pub frequency: Option<f64>,
    /// The estimated error of the continuation parameter at the solution.
    pub error: f64,
    /// The index, counted from 0, of the other branch at this solution on which the new branch
    /// continues; `None` to stay on the branch of the saved solution.
    pub switch: Option<usize>,
    /// At a point of codimension two, the amplitude of the cycle or doubled orbit with which a curve of
    /// special orbits starts, as a fraction of the size of the equilibrium or orbit; `None` for other
    /// starts.
    pub beside: Option<f64>,
}

/// The initial data from which a curve is computed.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub enum Initial<'s> {
    /// The unknowns of a solution, or a guess of the unknowns.
    Unknowns(&'s [f64]),
    /// A saved solution with its parameters.
    Solution(&'s Solution),
}

impl<'s> From<&'s [f64]> for Initial<'s> {
    fn from(z: &'s [f64]) -> Self {
        Initial::Unknowns(z)
    }
}

impl<'s, const N: usize> From<&'s [f64; N]> for Initial<'s> {
    fn from(z: &'s [f64; N]) -> Self {
        Initial::Unknowns(z)
    }
}

impl<'s> From<&'s Vec<f64>> for Initial<'s> {
    fn from(z: &'s Vec<f64>) -> Self {
        Initial::Unknowns(z)
    }
}

impl<'s> From<&'s Solution> for Initial<'s> {
    fn from(solution: &'s Solution) -> Self {
        Initial::Solution(solution)
    }
}

/// The start of a branch, in the unknowns of the system to which a [`Solution`] was converted.
#[derive(Clone, Debug, PartialEq)]
pub struct Start {
    /// The unknowns `z`.
    pub z: Vec<f64>,
    /// A direction `(z, p)` of the start, if known: the direction of the curve, or at a branch
    /// point the direction of the incoming branch.
    pub direction: Option<Vec<f64>>,
    /// The relation of the start to the new branch, such as a point on it or a branch point.
    pub site: Site,
    /// Whether the branch is traced to one side only, because both sides consist of the same
    /// solutions.
    pub one_sided: bool,
    /// The angle of the critical Floquet multipliers at the start, if known.
    pub angle: Option<f64>,
}

/// The relation of the start to the new branch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Site {
    /// A point of the curve, or a guess of a point.
    Point,
    /// A regular point of another branch, to which the saved solution leads: for example, the orbit
    /// of half the period at the end of a branch of doubled orbits.
    OtherBranch,
    /// A branch point, whose tangents solve the algebraic bifurcation equations.
    BranchPoint,
    /// A point at which the equations are singular, such as a Hopf point: the branch emanates in the
    /// known direction.
    Singular,
    /// A guess near a point at which the equations are singular: the guess is corrected perpendicular to
    /// the known direction, which is the direction of the curve.
    Beside,
    /// A solution at the boundary of the admissible solutions, from which the branch emanates; if
    /// the equations are singular at this solution, the branch emanates only to one side, in the
    /// known direction.
    Limit,
}

impl Start {
    /// Creates a start at a point of the curve.
    pub fn point(z: Vec<f64>, direction: Option<Vec<f64>>) -> Self {
        Start { z, direction, site: Site::Point, one_sided: false, angle: None }
    }

    /// Returns the known direction of the start, if it is a direction of the new curve: always at a
    /// `Site::Singular` or `Site::Beside`; at a `Site::Limit`, only if the curve consists of
    /// `solutions`; at any other site, only if the start was found on the same curve.
    pub(crate) fn direction(&self, same_curve: bool, solutions: bool) -> Option<&Vec<f64>> {
        let known = match self.site {
            Site::Point | Site::OtherBranch | Site::BranchPoint => same_curve,
            Site::Singular | Site::Beside => true,
            Site::Limit => solutions,
        };
        self.direction.as_ref().filter(|_| known)
    }
}
