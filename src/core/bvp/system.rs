//! A discretised boundary-value problem as a [`System`].

mod approach;
mod assembly;
mod carry;
mod closed;
mod derivatives;
mod discretisation;
mod duration_bound;
mod emanating;
mod equal_pairs;
mod events;
mod extremes;
mod face;
mod factorisation;
mod factors;
mod fitting;
mod floquet;
mod halved;
mod homoclinic;
mod joined;
mod joints;
mod layout;
mod leading_multipliers;
mod least_size;
mod liouville;
mod local;
mod mesh_error;
mod meshed;
mod monitors;
mod oscillation;
mod phase;
mod phase_response;
mod profiles;
mod refinement;
mod residual;
mod rest;
mod rotated_sparse;
mod solutions;
mod sparse_factors;
mod sparse_orbit;
mod start;
mod takens;
mod work;

use super::erased::{ErasedProblem, IntoEquations};
use super::error::BoundaryError;
use super::itineraries::Guess;
use super::mesh::Mesh;
use super::method::Method;
use crate::core::failure::Failure;
use crate::core::linalg::Spectrum;
pub use discretisation::DiscretisedProblem;
use meshed::Meshed;
pub use phase_response::phase_response;
use std::ops::Deref;

/// A boundary-value problem that is discretised by a method on one mesh for each segment.
///
/// The unknowns `z` are, for each segment and each state, a group of values at the segment's nodes
/// (`N·m + 1` values for `N` intervals with `m` nodes beyond the first), then one scalar group for
/// each extra unknown. The equations of the system are, in this order, the equations of all
/// intervals, the boundary conditions, the integral conditions, and the phase condition. The full
/// Jacobian is never formed: chains of intervals are condensed to their ends at a cost linear in
/// the number of intervals.
///
/// The monitors are the problem's own monitors and, for a method with mesh error, the monitor
/// `mesh_error`, which estimates this error.
///
/// ```
/// use tangency::core::bvp::{BoundarySystem, Collocation, Mesh};
/// use tangency::core::continuation::Continuation;
/// use tangency::core::system::Kind;
/// use tangency::problems::classic::Bratu;
/// let mut bratu = BoundarySystem::new(Bratu, Collocation::new(4)?, vec![Mesh::uniform(10)])?;
/// let branch = Continuation::new(&mut bratu)
///     .at("lambda", 0.5)
///     .along("lambda", 0.0..=4.0)
///     .bound("max_u", ..=3.0)
///     .trace()?;
/// let fold = branch.of_kind(Kind::LP).next().unwrap();
/// assert!((fold.parameters[0] - 3.51383071912516).abs() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct BoundarySystem(Meshed);

/// Properties of the system that are known before any equations are solved.
impl Deref for BoundarySystem {
    type Target = DiscretisedProblem;

    fn deref(&self) -> &DiscretisedProblem {
        &self.0.solutions.equations
    }
}

impl BoundarySystem {
    /// Creates the system of a problem on one mesh for each segment.
    ///
    /// # Errors
    /// [`BoundaryError`] if the numbers of segments, states, conditions and unknowns of the problem
    /// do not fit together.
    pub fn new(
        problem: impl IntoEquations,
        method: impl Into<Method>,
        meshes: Vec<Mesh>,
    ) -> Result<Self, BoundaryError> {
        let equations = DiscretisedProblem::new(problem.into_equations(), method.into(), meshes)?;
        Ok(BoundarySystem(Meshed::new(equations)))
    }

    /// Makes a solution the reference solution of the phase condition. By default, the reference of
    /// the phase condition is the first point at which the equations are evaluated.
    ///
    /// # Errors
    /// [`Failure::OutOfDomain`] if the vector field is undefined at a node.
    pub fn set_reference(&mut self, x: &[f64]) -> Result<(), Failure> {
        self.0.set_reference(x)
    }

    /// Computes the Floquet multipliers of the periodic solution that was assembled last: the
    /// eigenvalues `μ` of `P v + μ Q v = 0`, in descending order of their size. The matrices `P`
    /// and `Q` condense all intervals without any product of transfer matrices (T. F. Fairgrieve
    /// and A. D. Jepson, *SIAM J. Numer. Anal.* 28 (1991)). The result includes the trivial
    /// multiplier 1 of an autonomous orbit.
    ///
    /// ```
    /// use tangency::core::bvp::Collocation;
    /// use tangency::core::orbit::periodic_orbits;
    /// use tangency::core::system::System;
    /// use tangency::problems::mita::Block;
    /// // At rest without a voltage: |μ|² = exp(−c T) with a damping c = 0.04 and the period T = π/ω.
    /// let mut orbits = periodic_orbits(Block, 20, Collocation::new(4)?)?;
    /// let z = orbits.sampled(&[], |_, _, x| x.fill(0.0));
    /// orbits.assemble(&[&z[..], &[0.0, 0.5, 0.04]].concat())?;
    /// let exact = -0.04 * std::f64::consts::PI / 0.5;
    /// for (re, im) in orbits.multipliers()? {
    ///     assert!(((re * re + im * im).ln() - exact).abs() < 1e-9);
    /// }
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`Failure::Singular`] if the equations of some interval do not determine the unknowns inside
    /// it, [`Failure::Mismatch`] if no point is assembled, [`Failure::Unsupported`] for orbits with
    /// sparse matrices, and the errors of [`multipliers`](crate::core::linalg::multipliers).
    pub fn multipliers(&mut self) -> Result<Spectrum, Failure> {
        let (floquet, orbit) = self.0.multipliers();
        floquet.all(&orbit)
    }

    /// Estimates the error of a solution due to its mesh: the largest error of any state, in units of
    /// the state's largest value; 0 for a method without mesh error. The monitor `mesh_error` records
    /// the same estimate.
    ///
    /// A solution is more accurate at the nodes than this estimate, and even more accurate at the
    /// ends of intervals.
    pub fn mesh_error(&mut self, x: &[f64]) -> f64 {
        self.0.solutions.mesh_error(x)
    }

    /// Redistributes the mesh so that every interval has the same share of the error; the number of
    /// intervals is unchanged. The solution `x = (z, p)`, the given directions and the reference of
    /// the phase condition are transferred by interpolation; afterwards `x` must be corrected by
    /// Newton's iteration. Components of directions that follow the values at nodes are unchanged.
    /// The mesh of a method without mesh error is unchanged.
    ///
    /// # Errors
    /// [`Failure::OutOfDomain`] if the trajectory leaves the domain of the field; the system is then
    /// unchanged.
    ///
    /// ```
    /// # use tangency::core::bvp::*;
    /// # use tangency::core::system::System;
    /// # use tangency::problems::classic::Decay;
    /// // x' = −rate·x, x(0) = 1.
    /// let mut system = BoundarySystem::new(Decay, Collocation::new(3)?, vec![Mesh::uniform(4)])?;
    /// // A solution that decays within a tenth.
    /// let mut x = system.sampled(&[], |_, tau, x| x[0] = (-10.0 * tau).exp());
    /// x.push(10.0);
    /// system.adapt(&mut x, &mut [])?;
    /// let points = system.meshes()[0].points();
    /// assert!(points.len() == 5 && points[1] < 0.2);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn adapt(&mut self, x: &mut [f64], directions: &mut [&mut [f64]]) -> Result<(), Failure> {
        self.0.adapt(x, directions)
    }

    /// Creates the system on a mesh with an estimated error below a tolerance, and transfers `x` to
    /// this mesh; afterwards `x` must be corrected by Newton's iteration. Each segment gets the
    /// necessary number of intervals, on which the error is equidistributed. The estimate from a
    /// coarse mesh can be too small: check the estimate of the corrected solution on the new mesh.
    ///
    /// # Errors
    /// [`BoundaryError::TooFine`] if more than 4096 intervals are necessary, and
    /// [`BoundaryError::Evaluation`] if an evaluation fails.
    ///
    /// ```
    /// # use tangency::core::bvp::*;
    /// # use tangency::core::system::System;
    /// # use tangency::problems::classic::Decay;
    /// // x' = −rate·x, x(0) = 1.
    /// let mut system = BoundarySystem::new(Decay, Collocation::new(3)?, vec![Mesh::uniform(4)])?;
    /// let mut x = system.sampled(&[], |_, tau, x| x[0] = (-tau).exp());
    /// x.push(1.0);
    /// // A cubic on each of four intervals.
    /// let error = system.mesh_error(&x);
    /// assert!(error > 1e-6 && error < 1e-4);
    /// let (mut fine, x) = system.with_error(&x, 1e-6)?;
    /// assert!(fine.meshes()[0].intervals() > 4);
    /// assert!(fine.mesh_error(&x) < 1e-4);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn with_error(self, x: &[f64], tolerance: f64) -> Result<(Self, Vec<f64>), BoundaryError> {
        let (finer, x) = self.0.with_error(x, tolerance)?;
        Ok((BoundarySystem(finer), x))
    }
}

/// Heuristic: the largest estimated error of a mesh that resolves a trajectory well enough for the
/// start of a branch.
const RESOLVED: f64 = 1e-2;

/// Heuristic: the target error of a mesh that is adapted to a trajectory, equal to a branch's
/// default target.
const DISTRIBUTED: f64 = 1e-4;

/// Heuristic: the first mesh is adapted to a solution on this number times as many equal intervals
/// as requested; each later mesh is adapted to the solution on the mesh before it, so that the mesh
/// is adapted `DISTRIBUTIONS` times in all.
const FINER: usize = 64;
const DISTRIBUTIONS: usize = 3;

impl<P: IntoEquations> Guess<P> {
    /// Creates the system of the problem, with a given number of intervals for each segment, and
    /// computes its unknowns `z` at the parameters `p`; between the nodes of the known trajectories,
    /// the states are computed by integration from each node to the next. If equal intervals do not
    /// resolve a trajectory, the mesh is adapted to the trajectory, with more intervals if necessary.
    ///
    /// # Errors
    /// [`Failure`] if the number of intervals is zero, or if a trajectory leaves the domain of its
    /// vector field.
    pub fn discretised(
        self,
        p: &[f64],
        method: impl Into<Method>,
        intervals: usize,
    ) -> Result<(BoundarySystem, Vec<f64>), Failure> {
        let guess = self.erased();
        let (method, segments) = (method.into(), guess.problem.segments().len());
        let (mut system, z) = guess.on((&method, vec![Mesh::uniform(intervals); segments]), p)?;
        if system.mesh_error(&[&z[..], p].concat()) <= RESOLVED {
            return Ok((system, z));
        }
        guess.distributed(p, &method, intervals)
    }
}

/// Returns the equations of the first segment at the point that was assembled last, condensed to
/// the segment's ends: `P δx(0) + Q δx(1) = 0` with `n × n` matrices `P` and `Q`, stored row by
/// row. The Floquet multipliers of a periodic solution are the eigenvalues of the pencil `P + μ Q`.
///
/// # Errors
/// [`Failure::Singular`] if the equations of some interval do not determine the unknowns inside it,
/// [`Failure::Mismatch`] if no point is assembled.
///
/// ```
/// # use tangency::core::bvp::*;
/// # use tangency::core::system::System;
/// # use tangency::problems::classic::Decay;
/// // x' = −rate·x, x(0) = 1.
/// let mut system = BoundarySystem::new(Decay, Collocation::new(3)?, vec![Mesh::uniform(4)])?;
/// let mut x = system.sampled(&[], |_, tau, x| x[0] = (-tau).exp());
/// x.push(1.0);
/// system.assemble(&x)?;
/// let (p, q) = reduced_pencil(&mut system)?;
/// assert!((-p[0] / q[0] - (-1.0_f64).exp()).abs() < 1e-8);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn reduced_pencil(system: &mut BoundarySystem) -> Result<(&[f64], &[f64]), Failure> {
    let (floquet, orbit) = system.0.multipliers();
    floquet.reduced_pencil(&orbit)
}

impl Guess<ErasedProblem> {
    /// Creates the system on given meshes, and its unknowns.
    fn on(
        &self,
        (method, meshes): (&Method, Vec<Mesh>),
        p: &[f64],
    ) -> Result<(BoundarySystem, Vec<f64>), Failure> {
        let system = BoundarySystem::new(self.problem.clone(), method.clone(), meshes)?;
        let z = system.filled(&self.trajectories, &self.extras, p)?;
        Ok((system, z))
    }

    /// Creates the system, and its unknowns, on a mesh adapted to the trajectories; if the
    /// adaptation fails, the mesh is uniform.
    pub(in crate::core) fn distributed(
        &self,
        p: &[f64],
        method: &Method,
        intervals: usize,
    ) -> Result<(BoundarySystem, Vec<f64>), Failure> {
        let uniform = vec![Mesh::uniform(FINER * intervals); self.problem.segments().len()];
        let (mut system, mut z) = self.on((method, uniform), p)?;
        for _ in 0..DISTRIBUTIONS {
            let x = [&z[..], p].concat();
            let meshes = system.0.solutions.meshes_for(&x, DISTRIBUTED, intervals);
            let meshes = match meshes {
                Ok(meshes) => meshes,
                Err(_) => vec![Mesh::uniform(intervals); self.problem.segments().len()],
            };
            (system, z) = self.on((method, meshes), p)?;
        }
        Ok((system, z))
    }
}
