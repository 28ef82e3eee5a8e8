//! Defines the interface of zero problems `F(z, p) = 0` to continuation: residuals, derivatives,
//! solves.
//!
//! A **[`System`]** is the object-safe `f64` interface of a zero problem. Continuation, defining
//! systems and the location of events use only this interface, so a problem with structure
//! (condensed unknowns, collocation blocks) implements the trait directly; [`Dense`], [`Sparse`] and
//! [`MatrixFree`] implement the trait for any [`ZeroProblem`](crate::core::problem::ZeroProblem), by
//! dual numbers.
//!
//! Throughout this module, `x = (z, p)` is one vector: the `n` unknowns, then *all* parameters,
//! held or released, in the order of their names. A direction in which a derivative is taken is
//! also a vector of the length of `x`.
//!
//! ```
//! use tangency::core::system::{Dense, System};
//! use tangency::problems::classic::Hyperbola;
//! // `F = x² − μ² − ε²` at `x = 5`, `μ = 3`, `ε = 4`.
//! let (mut system, x) = (Dense::new(Hyperbola), [5.0, 3.0, 4.0]);
//! let mut value = [1.0];
//! system.residual(&x, &mut value)?;
//! assert_eq!(value, [0.0]);
//! // The derivative along `μ`, and the second derivative along `x`.
//! system.derivative(&x, &[&[0.0, 1.0, 0.0]], &mut value)?;
//! assert_eq!(value, [-6.0]);
//! let along_x: &[f64] = &[1.0, 0.0, 0.0];
//! system.derivative(&x, &[along_x, along_x], &mut value)?;
//! assert_eq!(value, [2.0]);
//! # Ok::<(), tangency::core::failure::Failure>(())
//! ```

mod dense;
mod eigenvalues;
mod expansion;
mod free_jacobian;
mod jacobian;
mod kind;
mod mixed;
mod orbit_events;
mod solution;
mod sparse_jacobian;
mod system_ref;
mod work;
mod zero_system;

pub use dense::{Dense, MatrixFree, Sparse};
pub(in crate::core) use expansion::Expansion;
pub use free_jacobian::Preconditioner;
pub use kind::Kind;
pub(in crate::core) use mixed::{mixed, moving, third};
pub use orbit_events::{Across, Emanating, Jump, Limit, OrbitEvents};
pub use solution::{Initial, Site, Solution, Start};
pub(crate) use system_ref::SystemRef;
pub use zero_system::Matrices;
pub(crate) use zero_system::ZeroSystem;

use crate::core::cancel::CancelToken;
use crate::core::failure::Failure;
use crate::core::linalg::{Border, Factors, Form, Spectrum, SpectrumRequest, dot};
use crate::core::problem::{Dynamics, Names, Profile};
use crate::core::scalar::Space;

/// A zero problem on a finer discretisation, and a point on that discretisation.
pub struct Refinement {
    /// The system on the finer discretisation; its parameters and monitors have the same names.
    pub system: Box<dyn System>,
    /// The point `x = (z, p)`, transferred to the finer discretisation.
    pub x: Vec<f64>,
}

/// A scalar function of `x` whose gradient a [`System`] computes.
#[derive(Clone, Copy, Debug)]
pub enum Functional<'a> {
    /// `wᵀ F_x[v]`, given `w` (one weight for each equation) and `v` (of the same length as `x`, or
    /// followed by rates as in [`derivative`](System::derivative)).
    First(&'a [f64], &'a [f64]),
    /// `wᵀ F_xx[v, v]`, given `w` (one weight for each equation) and `v` (of the same length as
    /// `x`).
    Second(&'a [f64], &'a [f64]),
    /// The monitor at this position among all monitors.
    Monitor(usize),
}

/// The object-safe interface of a zero problem to continuation, in `f64`.
///
/// Implementations own their buffers: after a first call, the residual, assembly, factorisation,
/// derivatives and gradients do not allocate memory, except for the vectors that a problem returns
/// (scales of its states).
pub trait System: Send {
    /// The names of the unknowns, parameters and monitors of the system.
    fn names(&self) -> &Names;

    /// Computes the residual `F(x)` and writes it into `r`.
    ///
    /// # Errors
    /// [`Failure`] if the equations are undefined at `x` or a component of the residual is not
    /// finite.
    fn residual(&mut self, x: &[f64], r: &mut [f64]) -> Result<(), Failure>;

    /// Evaluates `F_z` at `x` and stores the matrix for [`factor`](System::factor) and
    /// [`spectrum`](System::spectrum). Defining systems, monitors and Newton's method each request
    /// `F_z` at the same `x`: a second call at the same `x` should cost no more than the comparison
    /// of the two vectors.
    ///
    /// # Errors
    /// [`Failure`] as for [`residual`](System::residual).
    fn assemble(&mut self, x: &[f64]) -> Result<(), Failure>;

    /// Factors the assembled `F_z`, or the variant of `F_z` that `form` selects, with a border of
    /// width 0 or more, and writes the factors into `into`.
    ///
    /// # Errors
    /// [`Failure::Singular`] if the bordered matrix is singular to working accuracy, and
    /// [`Failure::Unsupported`] for a `form` that the system does not support.
    fn factor(&mut self, form: Form, border: Border, into: &mut Factors) -> Result<(), Failure>;

    /// Computes the derivative `F_x[d]`, `F_xx[d, e]` or `F_xxx[d, e, f]` at `x` along one to three
    /// directions (each of the same length as `x`) and writes it into `out`. For a flow with a mass
    /// matrix ([`Dynamics::Implicit`]), each direction can also contain, after its other components,
    /// the derivatives of the rates `z'`; `F − M z'` then replaces `F`, at `z' = 0`.
    ///
    /// # Errors
    /// [`Failure`] if `x` is outside the domain, the derivative is not finite, or the number of
    /// directions is not 1, 2 or 3.
    fn derivative(
        &mut self,
        x: &[f64],
        directions: &[&[f64]],
        out: &mut [f64],
    ) -> Result<(), Failure>;

    /// Computes the gradient of a functional with respect to `x` and writes it into `out` (of the
    /// same length as `x`): the derivatives with respect to all unknowns, and with respect to the
    /// parameters listed in `released`. In `out`, the components of parameters that are not
    /// released are unspecified.
    ///
    /// # Errors
    /// The errors of [`derivative`](System::derivative) and [`monitors`](System::monitors), and
    /// [`Failure`] if the functional is not differentiable at `x`.
    fn gradient(
        &mut self,
        x: &[f64],
        of: Functional,
        released: &[usize],
        out: &mut [f64],
    ) -> Result<(), Failure>;

    /// Writes the derivatives of monitors at `x` along a direction of the length of `x` into `out`,
    /// beginning with monitor number `first`. The derivative of a monitor that is not
    /// differentiable is NaN.
    fn slopes(&mut self, x: &[f64], first: usize, direction: &[f64], out: &mut [f64]) {
        let others = match self.discretised() {
            Some(own) => own.slopes(x, first, direction, out),
            None => (0..out.len()).collect(),
        };
        for k in others {
            out[k] = slope_of(self, x, first + k, direction).unwrap_or(f64::NAN);
        }
    }

    /// The type of dynamics that the residual describes.
    fn dynamics(&self) -> Dynamics;

    /// Returns at least the requested number of the eigenvalues that decide stability, computed
    /// from the assembled `F_z`. `None` if the residual does not describe dynamics.
    ///
    /// # Errors
    /// [`Failure::Undetermined`] if the equations do not determine the eigenvalues: the point is
    /// marked, and test functions that depend on eigenvalues are inactive. [`Failure::Eigenvalues`]
    /// if the computation of the eigenvalues fails.
    fn spectrum(
        &mut self,
        x: &[f64],
        request: SpectrumRequest,
    ) -> Result<Option<Spectrum>, Failure>;

    /// Computes consecutive monitors at a solution, from the monitor at the position `first`, one
    /// for each element of `values`.
    ///
    /// # Errors
    /// [`Failure`] if one of the requested monitors is undefined at `x`.
    fn monitors(&mut self, x: &[f64], first: usize, values: &mut [f64]) -> Result<(), Failure>;

    /// Returns the Taylor coefficients of `F(z + W(ξ), p)` for a polynomial `W` with the
    /// coefficients `terms` (each of the same length as `z`); the coefficients are in the order of
    /// the monomials in `ξ`. The constant term of the polynomial `W` is zero. For a flow with a mass
    /// matrix, the coefficients can also contain, after the coefficients of `W`, the coefficients of
    /// the rates `z'`; `F − M z'` then replaces `F`. The default
    /// implementation uses [`derivative`](System::derivative), so the order is at most 3.
    ///
    /// # Errors
    /// [`Failure::Unsupported`] for a higher order, and as for [`derivative`](System::derivative).
    fn expand(
        &mut self,
        x: &[f64],
        space: &'static Space,
        terms: &[Vec<f64>],
    ) -> Result<Vec<Vec<f64>>, Failure> {
        expansion::by_derivatives(self, x, space, terms)
    }

    /// Returns the size of a deviation `d` from a solution (`d` has the length of `x`), the period
    /// of the solution, and the derivative of the period along `d`. The default implementation is
    /// valid for equilibria.
    ///
    /// # Errors
    /// [`Failure`] if the equations are undefined at the solution.
    fn deviation(&mut self, _x: &[f64], d: &[f64]) -> Result<Deviation, Failure> {
        let square = d[..self.names().dimension()].iter().map(|d| d * d).sum();
        Ok(Deviation { square, ..Deviation::default() })
    }

    /// Returns typical sizes of the groups of unknowns at parameters `p`; empty if all sizes are 1.
    fn unknown_scales(&self, _p: &[f64]) -> Vec<f64> {
        Vec::new()
    }

    /// Returns the curves that are saved and drawn for special points.
    fn profiles(&mut self, _x: &[f64]) -> Vec<Profile> {
        Vec::new()
    }

    /// The description of the unknowns (such as their mesh), which is saved with solutions.
    fn representation(&self) -> Representation {
        Representation::default()
    }

    /// Returns the properties of a solution that its unknowns do not contain.
    fn traits(&mut self, _x: &[f64]) -> Traits {
        Traits::default()
    }

    /// Whether [`spectrum`](System::spectrum) itself factors the last assembled matrix, which is
    /// possible even if the factors from the last call of `factor` belong to another point. By
    /// default false.
    fn factors_for_eigenvalues(&self) -> bool {
        false
    }

    /// Describes the uncertainties of the results so far, in a text that is saved with the branch;
    /// `None` if all results are certain.
    fn doubts(&self) -> Option<String> {
        None
    }

    /// Prepares the start of a branch from a saved solution; in the default implementation, the
    /// saved solution must have the same unknowns as the system. A discretisation can change its
    /// mesh for the start, and thereby the number of its unknowns.
    ///
    /// # Errors
    /// [`Failure`] if this system cannot start a branch from the saved solution.
    fn resume_from(&mut self, solution: &Solution) -> Result<Start, Failure> {
        let n = self.names().dimension();
        if solution.state.len() != n {
            return Err(Failure::Mismatch(format!(
                "the start has {} unknowns, but the problem has {n} unknowns: was the start \
                 computed with other settings?",
                solution.state.len()
            )));
        }
        let z = solution.state.clone();
        let tangent = solution.tangent.as_ref().map(|(z, p)| [&z[..], &p[..]].concat());
        Ok(Start::point(z, tangent))
    }

    /// The system as a discretisation; `None` if its equations are exact.
    fn discretised(&mut self) -> Option<&mut dyn Discretised> {
        None
    }

    /// The interface of the system for solutions with events; `None` if solutions have no events.
    fn events(&mut self) -> Option<&mut dyn OrbitEvents> {
        None
    }
}

/// Returns the derivative of a monitor at `x` along a direction, computed from its gradient.
///
/// # Errors
/// [`Failure`] as for [`gradient`](System::gradient).
fn slope_of(
    system: &mut (impl System + ?Sized),
    x: &[f64],
    monitor: usize,
    direction: &[f64],
) -> Result<f64, Failure> {
    let n = system.names().dimension();
    let moves: Vec<usize> =
        (0..x.len() - n).filter(|parameter| direction[n + parameter] != 0.0).collect();
    let mut gradient = vec![0.0; x.len()];
    system.gradient(x, Functional::Monitor(monitor), &moves, &mut gradient)?;
    let released = moves.iter().map(|parameter| gradient[n + parameter] * direction[n + parameter]);
    Ok(dot(&gradient[..n], &direction[..n]) + released.sum::<f64>())
}

/// A system that discretises equations, with refinement and a mesh that can adapt along a branch.
pub trait Discretised {
    /// Returns the same problem on a finer discretisation, which is used for the final correction
    /// of special points; the change of a special point by this correction is the contribution of
    /// the discretisation to the `error` of the point. Returns `None` if the system has no finer
    /// discretisation.
    fn refined(&mut self, x: &[f64]) -> Option<Refinement>;

    /// Whether a finer discretisation exists.
    fn is_refinable(&self) -> bool {
        true
    }

    /// Returns the same problem on a coarser discretisation. If no finer discretisation exists, the
    /// distance of a special point from the same point on the coarser discretisation is the share
    /// of the discretisation in its `error`. Returns `None` if the system has no coarser
    /// discretisation.
    fn coarser(&mut self, _x: &[f64]) -> Option<Refinement> {
        None
    }

    /// Computes the derivatives of consecutive monitors along a direction, from the monitor at the
    /// position `first`, one for each element of `out`, accurately enough for the curve between two
    /// points; the derivative of a monitor that is not differentiable at `x` is NaN. Returns the
    /// positions in `out` of the derivatives that must be computed from gradients.
    fn slopes(
        &mut self,
        _x: &[f64],
        _first: usize,
        _direction: &[f64],
        out: &mut [f64],
    ) -> Vec<usize> {
        (0..out.len()).collect()
    }

    /// Sets the accuracy of subsequent evaluations, assemblies and factorisations.
    fn set_effort(&mut self, _effort: Effort) {}

    /// Returns an independent copy of the system; `None` for systems that do not change along
    /// branches.
    fn duplicate(&self) -> Option<Box<dyn System>> {
        None
    }

    /// Whether a periodic solution consists of two equal halves, so that its minimal period is half
    /// its period, but the neighbouring solution `beside` does not consist of two equal halves.
    fn repeats(&mut self, _x: &[f64], _beside: &[f64]) -> bool {
        false
    }

    /// Returns the difference between the two halves of a periodic solution, at some phases and in units
    /// of the states' scales; `None` if the solution cannot be divided into halves.
    fn difference_of_halves(&mut self, _x: &[f64]) -> Option<Vec<f64>> {
        None
    }

    /// Returns the unknowns of a saved solution, transferred to the present mesh. A periodic
    /// solution can begin at any phase. An autonomous solution is therefore shifted to the phase of
    /// the last accepted solution. For a solution that lasts several periods of a forcing, one
    /// shifted solution is returned for each period; its start time is chosen such that its times
    /// are close to the times of the solution `near`.
    ///
    /// # Errors
    /// [`Failure`] if the saved solution does not belong to this problem.
    fn images(&mut self, _solution: &Solution, _near: &[f64]) -> Result<Vec<Vec<f64>>, Failure> {
        Ok(Vec::new())
    }

    /// Updates a phase condition and a mesh along the branch; called at the start of the branch and
    /// at each accepted point. `x` and the `directions` (each of the length of `z` or longer) are
    /// transferred to a new mesh with the same number of intervals.
    fn on_accepted(&mut self, _x: &mut [f64], _directions: &mut [&mut [f64]]) {}

    /// Returns the phase response of a cycle, as functions of time.
    ///
    /// # Errors
    /// [`Failure`] if the solution does not have a phase, or the equations do not determine the
    /// response.
    fn phase_response(&mut self, _x: &[f64]) -> Result<Vec<Profile>, Failure> {
        Err(Failure::Unsupported(
            "only cycles have a phase response, but the solutions of this system are not cycles"
                .into(),
        ))
    }

    /// Measures how close a cycle with a free period is to an equilibrium; `None` for other
    /// solutions.
    fn approach(&mut self, _x: &[f64]) -> Option<Approach> {
        None
    }

    /// Returns the system of homoclinic orbits, and an initial orbit: an orbit near a saved cycle,
    /// or the saved homoclinic orbit of a curve that is continued. The orbit near a cycle begins
    /// and ends at the distance `radius` from the equilibrium, in units of the extents of the
    /// cycle; a saved orbit keeps its end distances. The returned orbit is homoclinic only if the
    /// monitor `homoclinic_gap` vanishes.
    ///
    /// # Errors
    /// [`Failure`] if no homoclinic orbit is found nearby.
    fn homoclinic(&self, _solution: &Solution, _radius: f64) -> Result<Emanating, Failure> {
        Err(Failure::Unsupported(
            "homoclinic orbits start from a cycle near a homoclinic orbit".into(),
        ))
    }

    /// Returns a long cycle near the homoclinic orbit with which a curve of homoclinic orbits
    /// begins at a Bogdanov–Takens point; the two released parameters are changed accordingly. The
    /// amplitude of the cycle is a given factor times a fraction of the size of the equilibrium;
    /// the fraction is smaller if the normal form limits the amplitude.
    ///
    /// # Errors
    /// [`Failure`] if the normal form is degenerate, or the released parameters do not unfold it.
    fn beside_takens(
        &self,
        _point: &Solution,
        (_released, _size): (&[usize], [f64; 2]),
    ) -> Result<Solution, Failure> {
        Err(Failure::Unsupported(
            "homoclinic orbits exist only in vector fields, but this system \
                                  has no vector field"
                .into(),
        ))
    }

    /// Restores the mesh of an earlier solution of this system, whatever number of intervals the
    /// branch began with.
    ///
    /// # Errors
    /// [`Failure`] if the solution does not belong to this problem.
    fn return_to(&mut self, _solution: &Solution) -> Result<(), Failure> {
        Ok(())
    }

    /// Whether a solution needs more mesh intervals to keep the mesh error below `target`, or far
    /// fewer intervals would suffice.
    fn needs_fit(&mut self, _x: &[f64], _target: f64) -> bool {
        false
    }

    /// Adapts the number of mesh intervals to a solution: more intervals if the estimated mesh
    /// error exceeds `target`; fewer, but not fewer than initially, if far fewer would suffice.
    /// Returns whether the mesh changed: if so, `x` and the `directions` (each of the length of `z`
    /// or longer) are transferred to the new unknowns, and `x` must be corrected.
    fn fit(&mut self, _x: &mut Vec<f64>, _directions: &mut [&mut Vec<f64>], _target: f64) -> bool {
        false
    }
}

/// The name of a monitor of orbits between invariant manifolds: the monitor vanishes at homoclinic
/// orbits.
pub(crate) const HOMOCLINIC_GAP: &str = "homoclinic_gap";

/// The names of the monitors of homoclinic orbits that describe the equilibrium: the real parts of
/// the leading eigenvalues, and their sum.
pub(crate) const HOMOCLINIC_RATES: [&str; 3] =
    ["leading_unstable", "leading_stable", "saddle_quantity"];

/// The monitors of homoclinic orbits that vanish at points of codimension two, with the kinds of
/// these points.
pub(crate) const HOMOCLINIC_TESTS: [(&str, Kind); 5] = [
    (HOMOCLINIC_RATES[2], Kind::NSS),
    ("stable_discriminant", Kind::DRS),
    ("unstable_discriminant", Kind::DRU),
    ("stable_share", Kind::OFS),
    ("unstable_share", Kind::OFU),
];

/// Discretisation: the smallest distance from the equilibrium at which homoclinic orbits begin and
/// end, in units of the extents of the orbit; the error of the computed parameter is proportional
/// to the square, or a higher power, of this distance.
pub(crate) const HOMOCLINIC_RADIUS: f64 = 1e-5;

/// A deviation from a solution.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Deviation {
    /// The sum of the squares of the components of the deviation, integrated over the period of an
    /// orbit, or averaged over the iterates of a cycle of a map. For this sum, the states of the
    /// two orbits are compared at equal times after the starts of the orbits.
    pub square: f64,
    /// The inner product of the deviation with the orbit's velocity, integrated over the period, if
    /// the start time of the orbit is free, as for an autonomous orbit with events; otherwise 0.
    pub along: f64,
    /// The square of the orbit's velocity, integrated over the period, if the start time of the
    /// orbit is free; otherwise 0.
    pub motion: f64,
    /// The period of the solution; 1 for equilibria and maps.
    pub period: f64,
    /// The derivative of the period of the solution along the deviation.
    pub lengthening: f64,
}

/// Rounding: the fraction of the period below which a change of the period along a deviation counts
/// as a rounding error.
const SAME_PERIOD: f64 = 1e-9;

impl Default for Deviation {
    /// Returns the zero deviation from an equilibrium.
    fn default() -> Self {
        Deviation { square: 0.0, along: 0.0, motion: 0.0, period: 1.0, lengthening: 0.0 }
    }
}

impl Deviation {
    /// Returns the value that `square` has for the same deviation if the deviating orbit starts
    /// later by the time `shift`.
    pub fn square_after(&self, shift: f64) -> f64 {
        self.square - shift * (2.0 * self.along - shift * self.motion)
    }

    /// Returns the derivative of the period along the deviation; `None` if the derivative is a
    /// rounding error.
    pub(crate) fn changes_period(&self) -> Option<f64> {
        Some(self.lengthening).filter(|change| change.abs() > SAME_PERIOD * self.period)
    }
}

/// A measure of how close a cycle is to an equilibrium.
#[derive(Clone, Debug, PartialEq)]
pub struct Approach {
    /// The estimated distance of the cycle from the nearest equilibrium, relative to the extents of
    /// the cycle.
    pub distance: f64,
    /// The extents of the cycle: the largest minus the smallest value of each state on each
    /// segment.
    pub extents: Vec<f64>,
    /// Whether the nearest equilibrium is a saddle.
    pub is_saddle: bool,
}

/// The accuracy with which a discretisation is evaluated, and the token that cancels evaluations.
#[derive(Clone, Copy, Debug)]
pub struct Effort<'a> {
    /// The error, in units of the sizes of the unknowns, that is tolerated in residuals, matrices
    /// and monitors during iterations that only approach a solution; 0 for full accuracy.
    pub error: f64,
    /// Whether gradients are as accurate as residuals: sensitivities require accurate gradients,
    /// fast convergence of Newton's method does not.
    pub exact_gradients: bool,
    /// The token that cancels evaluations, assemblies and factorisations of the discretisation.
    pub cancel: &'a CancelToken,
}

/// The description of the unknowns of a discretised solution, saved with branches and special
/// points.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Representation {
    /// The sequence of events on solutions, in words; empty if the events of all solutions are the
    /// same.
    pub itinerary: String,
    /// The name of the discretisation method, with any settings on which the meaning of the
    /// unknowns depends.
    pub method: String,
    /// The mesh on which the unknowns are given; empty if the discretisation has no mesh.
    pub mesh: Vec<f64>,
    /// Whether the values of a solution between the mesh points are interpolated, as in
    /// collocation.
    pub interpolated: bool,
}

impl Representation {
    /// Whether the accuracy of solutions is limited by the error of a mesh.
    pub fn is_on_mesh(&self) -> bool {
        !self.mesh.is_empty()
    }
}

/// Properties of a solution that depend on its discretisation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Traits {
    /// The estimated relative error that the mesh causes; 0 if the discretisation has no mesh.
    pub mesh_error: f64,
    /// The factor by which rounding errors grow in the assembled discretisation, for example as
    /// deviations grow over a segment of shooting. Newton corrections below this factor times the
    /// rounding error are noise.
    pub growth: f64,
    /// The amplitude of a cycle about its mean, relative to the amplitude of the last accepted cycle.
    /// The sign of the relative amplitude changes where a family of cycles passes through an
    /// equilibrium. `None` if cycles of this system cannot shrink to equilibria.
    pub amplitude: Option<f64>,
    /// The period of a cycle, if the period is an unknown and not prescribed by a forcing.
    pub free_period: Option<f64>,
    /// The number of nontrivial Floquet multipliers of a smooth orbit; their product is positive,
    /// because the flow of a vector field preserves orientation. `None` for solutions other than
    /// smooth orbits.
    pub smooth_multipliers: Option<usize>,
    /// The minimum, over all segments, of the size of the largest state on the segment, in units of
    /// the states' scales. Tolerances are relative to the states' scales. Segments on which the
    /// states are constant are not included in this minimum; the minimum is infinite if no segment
    /// is included.
    pub least_size: f64,
}

impl Default for Traits {
    fn default() -> Self {
        Traits {
            mesh_error: 0.0,
            growth: 1.0,
            amplitude: None,
            free_period: None,
            smooth_multipliers: None,
            least_size: f64::INFINITY,
        }
    }
}
