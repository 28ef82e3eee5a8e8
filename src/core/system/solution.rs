//! Solutions from which branches start.

use super::kind::Kind;

/// A solution from which a branch is to start, as it was saved: not always of the same
/// discretisation, nor even of the same system.
#[derive(Clone, Debug, PartialEq)]
pub struct Solution {
    /// What kind of special point it is.
    pub kind: Kind,
    /// What is held along its branch; `None` on a branch of solutions.
    pub condition: Option<Kind>,
    /// What it goes through, where solutions can differ in that.
    pub itinerary: String,
    /// The method of its discretisation, as
    /// [`Branch::method`](crate::core::continuation::Branch::method).
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
    /// How many eigenvalues, or pairs, are critical at a special point; 0 where that is not known.
    pub multiplicity: usize,
    /// The frequency of a Hopf point, where it is known.
    pub frequency: Option<f64>,
    /// The estimated error of the continued parameter.
    pub error: f64,
    /// The other branch to follow, counted from 0; `None` to stay on this one.
    pub switch: Option<usize>,
    /// At a point of codimension two, the amplitude of the cycle or doubled orbit with which a curve of
    /// special orbits starts, as a part of the size of the equilibrium or orbit; `None` for other starts.
    pub beside: Option<f64>,
}

/// What a curve starts from.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub enum Initial<'s> {
    /// Unknowns, or a guess of them.
    Unknowns(&'s [f64]),
    /// A solution with its parameters.
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

/// The start of a branch, in the unknowns of the system that has taken over a [`Solution`].
#[derive(Clone, Debug, PartialEq)]
pub struct Start {
    /// The unknowns `z`.
    pub z: Vec<f64>,
    /// A direction `(z, p)`, where one is known: of the curve, or at a branch point of the branch
    /// that leads to it.
    pub direction: Option<Vec<f64>>,
    /// Where on a branch the start is.
    pub site: Site,
    /// Whether the branch is traced to one side only: both are the same.
    pub one_sided: bool,
    /// The angle of the multipliers that are critical, where it is known.
    pub angle: Option<f64>,
}

/// Where on a branch a start is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Site {
    /// At a point of the curve, or a guess of one.
    Point,
    /// At a point of the branch to which the solution leads and on which it is regular, as the orbit
    /// of half the period where a branch of doubled orbits ends.
    OtherBranch,
    /// At a branch point, whose tangents solve the algebraic bifurcation equations.
    BranchPoint,
    /// At a point where the equations are singular, as at a Hopf point: the branch emanates in the
    /// direction that is known.
    Singular,
    /// Beside a point at which the equations are singular, at a guess: it is corrected across the
    /// direction that is known, in which the curve goes.
    Beside,
    /// At a limit of admissible solutions, where the branch emanates; in the direction that is
    /// known, to that side only, if the equations are singular there.
    Limit,
}

impl Start {
    /// At a point of the curve.
    pub fn point(z: Vec<f64>, direction: Option<Vec<f64>>) -> Self {
        Start { z, direction, site: Site::Point, one_sided: false, angle: None }
    }

    /// The direction that is known, as one of the curve that begins: where solutions emanate it is
    /// one of `solutions`, not of a curve of special points, and elsewhere one of the curve on
    /// which the start was found.
    pub(crate) fn direction(&self, same_curve: bool, solutions: bool) -> Option<&Vec<f64>> {
        let known = match self.site {
            Site::Point | Site::OtherBranch | Site::BranchPoint => same_curve,
            Site::Singular | Site::Beside => true,
            Site::Limit => solutions,
        };
        self.direction.as_ref().filter(|_| known)
    }
}
