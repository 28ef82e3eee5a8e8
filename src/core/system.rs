//! Defines zero problems `F(z, p) = 0` as continuation uses them: residuals, derivatives, solves.
//!
//! A **[`System`]** is the object-safe `f64` interface of a zero problem. Continuation, defining
//! systems and the location of events use nothing else, so a problem with structure (condensed
//! unknowns, collocation blocks) implements the trait directly; [`Dense`] and [`Sparse`] implement
//! the trait for any [`ZeroProblem`](crate::core::problem::ZeroProblem), by forward-mode dual
//! numbers.
//!
//! Throughout, `x = (z, p)` is one vector: the `n` unknowns, then *all* parameters, held or
//! released, in the order of their names. A direction in which a derivative is taken is such a
//! vector as well.
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
mod expansion;
mod jacobian;
mod kind;
mod mixed;
mod solution;
mod sparse_jacobian;
mod system_ref;
mod work;
mod zero_system;

pub use dense::{Dense, Sparse};
pub(in crate::core) use expansion::Expansion;
pub use kind::Kind;
pub(in crate::core) use mixed::{mixed, moving, third};
pub use solution::{Initial, Site, Solution, Start};
pub(crate) use system_ref::SystemRef;
pub use zero_system::Matrices;
pub(crate) use zero_system::ZeroSystem;

use crate::core::cancel::CancelToken;
use crate::core::failure::Failure;
use crate::core::linalg::{Border, Factors, Form, Spectrum, SpectrumRequest, dot};
use crate::core::problem::{Dynamics, Names, Profile};
use crate::core::scalar::Space;

/// The same zero problem on a finer discretisation, and a point of it.
pub struct Refinement {
    /// The finer system; its parameters and monitors have the same names.
    pub system: Box<dyn System>,
    /// `x = (z, p)` carried over.
    pub x: Vec<f64>,
}

/// A function of `x` whose gradient a [`System`] has.
#[derive(Clone, Copy, Debug)]
pub enum Functional<'a> {
    /// `wᵀ F_x[v]`, given `w` (one weight for each equation) and `v` (as long as `x`).
    First(&'a [f64], &'a [f64]),
    /// `wᵀ F_xx[v, v]`, given `w` and `v`.
    Second(&'a [f64], &'a [f64]),
    /// The monitor at this position.
    Monitor(usize),
}

/// A zero problem as continuation sees it: object-safe, in `f64`.
///
/// Implementations own their buffers: after a first call, residual, assembly, factorisation,
/// derivatives and gradients allocate nothing but for what a problem returns (scales of its states).
pub trait System: Send {
    /// The names of unknowns, parameters and monitors.
    fn names(&self) -> &Names;

    /// `F(x)` into `r`.
    ///
    /// # Errors
    /// [`Failure`] where the equations have no meaning at `x` or a component is not finite.
    fn residual(&mut self, x: &[f64], r: &mut [f64]) -> Result<(), Failure>;

    /// Evaluates `F_z` at `x` and keeps it for [`factor`](System::factor) and
    /// [`spectrum`](System::spectrum). Conditions, monitors and Newton's iteration each ask for it
    /// at the same `x`: a second call there should cost no more than the comparison with the `x` of
    /// the first.
    ///
    /// # Errors
    /// [`Failure`] as for the residual.
    fn assemble(&mut self, x: &[f64]) -> Result<(), Failure>;

    /// Factors a form of the assembled `F_z` within a border (of width 0 or more) and puts the
    /// factors into `into`.
    ///
    /// # Errors
    /// [`Failure::Singular`] if the bordered matrix is, to working accuracy, and
    /// [`Failure::Unsupported`] for a form that the system does not have.
    fn factor(&mut self, form: Form, border: Border, into: &mut Factors) -> Result<(), Failure>;

    /// The derivative `F_x[d]`, `F_xx[d, e]` or `F_xxx[d, e, f]` at `x` along one to three
    /// directions (each as long as `x`), into `out`.
    ///
    /// # Errors
    /// [`Failure`] outside the domain, where the derivative is not finite, or for another number of
    /// directions.
    fn derivative(
        &mut self,
        x: &[f64],
        directions: &[&[f64]],
        out: &mut [f64],
    ) -> Result<(), Failure>;

    /// The gradient of a functional by `x`, into `out` (as long as `x`): all components of the
    /// unknowns, and those of the parameters listed in `released`; other parameters' components are
    /// unspecified.
    ///
    /// # Errors
    /// [`Failure`] as for [`derivative`](System::derivative) and [`monitors`](System::monitors), or
    /// where the functional is not differentiable.
    fn gradient(
        &mut self,
        x: &[f64],
        of: Functional,
        released: &[usize],
        out: &mut [f64],
    ) -> Result<(), Failure>;

    /// The derivative of a monitor at `x` along a direction, which is as long as `x`.
    ///
    /// # Errors
    /// [`Failure`] as for [`gradient`](System::gradient).
    fn slope(&mut self, x: &[f64], monitor: usize, direction: &[f64]) -> Result<f64, Failure> {
        let n = self.names().dimension();
        let moves: Vec<usize> =
            (0..x.len() - n).filter(|parameter| direction[n + parameter] != 0.0).collect();
        let mut gradient = vec![0.0; x.len()];
        self.gradient(x, Functional::Monitor(monitor), &moves, &mut gradient)?;
        let released =
            moves.iter().map(|parameter| gradient[n + parameter] * direction[n + parameter]);
        Ok(dot(&gradient[..n], &direction[..n]) + released.sum::<f64>())
    }

    /// What the residual says about motion.
    fn dynamics(&self) -> Dynamics;

    /// The eigenvalues that decide stability, from the assembled `F_z`; `None` if no motion is
    /// meant. At least those requested are returned.
    ///
    /// # Errors
    /// [`Failure::Undetermined`] where the equations do not determine them: the point is marked,
    /// and no test function that depends on them acts. [`Failure::Eigenvalues`] if they are not
    /// found.
    fn spectrum(
        &mut self,
        x: &[f64],
        request: SpectrumRequest,
    ) -> Result<Option<Spectrum>, Failure>;

    /// The values of monitors at a solution, from the one at the position `first` on, as many as
    /// `values` has room for.
    ///
    /// # Errors
    /// [`Failure`] if one of these monitors has no meaning at `x`.
    fn monitors(&mut self, x: &[f64], first: usize, values: &mut [f64]) -> Result<(), Failure>;

    /// The Taylor coefficients of `F(z + W(ξ), p)` for a polynomial `W` with these coefficients (each
    /// as long as `z`; none of degree 0), by the monomials of a space. The default follows from
    /// [`derivative`](System::derivative), so the order is at most 3.
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

    /// The size of a deviation `d` (as long as `x`), the period of the solution, and the derivative
    /// of the period along `d`. The default is for equilibria.
    ///
    /// # Errors
    /// [`Failure`] where the solution has no meaning.
    fn deviation(&mut self, _x: &[f64], d: &[f64]) -> Result<Deviation, Failure> {
        let square = d[..self.names().dimension()].iter().map(|d| d * d).sum();
        Ok(Deviation { square, ..Deviation::default() })
    }

    /// Typical sizes of the groups of unknowns at parameters `p`; empty if all are 1.
    fn unknown_scales(&self, _p: &[f64]) -> Vec<f64> {
        Vec::new()
    }

    /// Curves that are kept with special points and drawn for them.
    fn profiles(&mut self, _x: &[f64]) -> Vec<Profile> {
        Vec::new()
    }

    /// What the unknowns mean, which is saved with them.
    fn representation(&self) -> Representation {
        Representation::default()
    }

    /// What is known of a solution beside its unknowns.
    fn traits(&mut self, _x: &[f64]) -> Traits {
        Traits::default()
    }

    /// Whether the spectrum factors the matrix assembled last by itself, so that the matrix factored before
    /// may belong to another point: by default not.
    fn factors_for_eigenvalues(&self) -> bool {
        false
    }

    /// Which results so far are not certain, in words, to be saved with the branch.
    fn doubts(&self) -> Option<String> {
        None
    }

    /// Prepares the start of a branch from a saved solution: by default one of the same unknowns. A
    /// discretisation may change its mesh, and with it the number of its unknowns.
    ///
    /// # Errors
    /// [`Failure`] if this system cannot start there.
    fn resume_from(&mut self, solution: &Solution) -> Result<Start, Failure> {
        let n = self.names().dimension();
        if solution.state.len() != n {
            return Err(Failure::Mismatch(format!(
                "the start has {} unknowns, the problem {n}: was it made with other settings?",
                solution.state.len()
            )));
        }
        let z = solution.state.clone();
        let tangent = solution.tangent.as_ref().map(|(z, p)| [&z[..], &p[..]].concat());
        Ok(Start::point(z, tangent))
    }

    /// The system as a discretisation; `None` if the equations are exact as they stand.
    fn discretised(&mut self) -> Option<&mut dyn Discretised> {
        None
    }

    /// The facet of solutions with events; `None` if they have none.
    fn events(&mut self) -> Option<&mut dyn OrbitEvents> {
        None
    }
}

/// A system that discretises something else: finer ones, and the mesh, which may follow a branch.
pub trait Discretised {
    /// The same problem on a finer discretisation: special points are finished on it, and the
    /// difference is the discretisation's share of their `error`. `None` where there is none finer.
    fn refined(&mut self, x: &[f64]) -> Option<Refinement>;

    /// How evaluations, assemblies and factorisations are carried out from now on.
    fn set_effort(&mut self, _effort: Effort) {}

    /// The same system, to be changed without changing this one; `None` for systems that no branch
    /// changes.
    fn duplicate(&self) -> Option<Box<dyn System>> {
        None
    }

    /// Whether a periodic solution goes through everything twice, so that it has half the period,
    /// and the solution `beside` it does not.
    fn repeats(&mut self, _x: &[f64], _beside: &[f64]) -> bool {
        false
    }

    /// The unknowns, on the present mesh, of a saved solution. Of a periodic solution, which may
    /// begin anywhere, those in the phase of the solution accepted last, or one for each period of
    /// the forcing that it lasts, at times near those of the solution `near`.
    ///
    /// # Errors
    /// [`Failure`] if the saved solution is not one of this problem.
    fn images(&mut self, _solution: &Solution, _near: &[f64]) -> Result<Vec<Vec<f64>>, Failure> {
        Ok(Vec::new())
    }

    /// Lets a phase condition and a mesh follow the branch: called at its start, and at each point
    /// accepted. `x` and the `directions` (each as long as `z` or longer) are carried over to a new
    /// mesh with the same number of intervals.
    fn on_accepted(&mut self, _x: &mut [f64], _directions: &mut [&mut [f64]]) {}

    /// The phase response of a cycle, as profiles over time.
    ///
    /// # Errors
    /// [`Failure`] for solutions without a phase, and where the response is not determined.
    fn phase_response(&mut self, _x: &[f64]) -> Result<Vec<Profile>, Failure> {
        Err(Failure::Unsupported("only cycles have a phase, and these solutions are none".into()))
    }

    /// How near a cycle whose period is free comes to an equilibrium; `None` for other solutions.
    fn approach(&mut self, _x: &[f64]) -> Option<Approach> {
        None
    }

    /// The system of the homoclinic orbits near a cycle that was saved, or with which a saved curve
    /// of homoclinic orbits goes on, and the orbit there. Beside a cycle the orbit begins and ends at
    /// a distance from the equilibrium, the `radius`, in units of its extents; a saved one keeps its
    /// distances. Where the monitor `homoclinic_gap` vanishes the orbit is homoclinic.
    ///
    /// # Errors
    /// [`Failure`] if no homoclinic orbit is near.
    fn homoclinic(&self, _solution: &Solution, _radius: f64) -> Result<Emanating, Failure> {
        Err(Failure::Unsupported("homoclinic orbits start from a cycle near one".into()))
    }

    /// A long cycle near the homoclinic orbit with which a curve of such orbits leaves a
    /// Bogdanov–Takens point, with two released parameters changed; the amplitude is a part of the size
    /// of the equilibrium, or less where the normal form bounds it, times a factor.
    ///
    /// # Errors
    /// [`Failure`] if the normal form is degenerate, or the parameters do not unfold it.
    fn beside_takens(
        &self,
        _point: &Solution,
        (_released, _size): (&[usize], [f64; 2]),
    ) -> Result<Solution, Failure> {
        Err(Failure::Unsupported("homoclinic orbits are solutions of a flow".into()))
    }

    /// Goes back to the mesh of a solution of this system that was computed earlier, whatever number
    /// of intervals a branch began with.
    ///
    /// # Errors
    /// [`Failure`] if the solution is not one of this problem.
    fn return_to(&mut self, _solution: &Solution) -> Result<(), Failure> {
        Ok(())
    }

    /// Whether a solution needs another number of intervals to keep the error of the mesh below
    /// `target`, or far fewer would do.
    fn needs_fit(&mut self, _x: &[f64], _target: f64) -> bool {
        false
    }

    /// Lets the number of intervals follow a solution: the mesh gets more of them where its
    /// estimated error exceeds `target`, and fewer, but no fewer than it began with, where many
    /// fewer would do. Returns whether it did: then `x`, and the `directions` (each as long as `z`
    /// or longer), are carried over to as many unknowns as the system has now, and `x` needs to be
    /// corrected.
    fn fit(&mut self, _x: &mut Vec<f64>, _directions: &mut [&mut Vec<f64>], _target: f64) -> bool {
        false
    }
}

/// The monitor of orbits between invariant manifolds that vanishes where they are homoclinic.
pub(crate) const HOMOCLINIC_GAP: &str = "homoclinic_gap";

/// The monitors of such orbits that belong to the equilibrium: the real parts of the leading
/// eigenvalues, and their sum.
pub(crate) const HOMOCLINIC_RATES: [&str; 3] =
    ["leading_unstable", "leading_stable", "saddle_quantity"];

/// The monitors of such orbits that vanish at points of codimension two, with the kinds of these.
pub(crate) const HOMOCLINIC_TESTS: [(&str, Kind); 5] = [
    (HOMOCLINIC_RATES[2], Kind::NSS),
    ("stable_discriminant", Kind::DRS),
    ("unstable_discriminant", Kind::DRU),
    ("stable_share", Kind::OFS),
    ("unstable_share", Kind::OFU),
];

/// (D) The least distance from the equilibrium at which homoclinic orbits begin and end, in units of
/// their extents: the parameter errs by a power of at least 2 of the distance.
pub(crate) const HOMOCLINIC_RADIUS: f64 = 1e-5;

/// A deviation from a solution.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Deviation {
    /// The sum of the squares of its states: of an orbit integrated over the period, of a cycle of
    /// a map the mean over the iterates. States of orbits are compared at equal times since the
    /// orbit's start.
    pub square: f64,
    /// The products of its states with the velocity, and of the velocity with itself, integrated
    /// over the period, where the time of the start is free: of an autonomous orbit with events. 0
    /// elsewhere.
    pub along: f64,
    /// See `along`.
    pub motion: f64,
    /// The period of the solution; 1 for equilibria and maps.
    pub period: f64,
    /// How much the period changes with the deviation.
    pub lengthening: f64,
}

/// (R) A change of the period this small, compared with the period, as a solution changes by a
/// deviation is rounding.
const SAME_PERIOD: f64 = 1e-9;

impl Default for Deviation {
    /// No deviation from an equilibrium.
    fn default() -> Self {
        Deviation { square: 0.0, along: 0.0, motion: 0.0, period: 1.0, lengthening: 0.0 }
    }
}

impl Deviation {
    /// `square` of the same deviation if the orbit starts later by `shift`.
    pub fn square_after(&self, shift: f64) -> f64 {
        self.square - shift * (2.0 * self.along - shift * self.motion)
    }

    /// How much the period changes with the deviation; `None` if the change is rounding.
    pub(crate) fn changes_period(&self) -> Option<f64> {
        Some(self.lengthening).filter(|change| change.abs() > SAME_PERIOD * self.period)
    }
}

/// How near a cycle comes to an equilibrium.
#[derive(Clone, Debug, PartialEq)]
pub struct Approach {
    /// The estimated distance from the nearest one, relative to the extents.
    pub distance: f64,
    /// The largest minus the smallest value of each state of each segment.
    pub extents: Vec<f64>,
}

/// How a discretisation is evaluated.
#[derive(Clone, Copy, Debug)]
pub struct Effort<'a> {
    /// The error (in units of the unknowns' sizes) tolerated in residuals and matrices, and in
    /// monitors evaluated meanwhile, since a solution is only approached; 0 for full accuracy.
    pub error: f64,
    /// Whether gradients are as accurate as residuals: the speed of Newton's iteration does not ask
    /// for that, sensitivities do.
    pub exact_gradients: bool,
    /// Cancels evaluations, assemblies and factorisations.
    pub cancel: &'a CancelToken,
}

/// What the unknowns of a discretised solution mean: saved with branches and special points.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Representation {
    /// Which events solutions pass, in words; empty if that is the same for all.
    pub itinerary: String,
    /// The method: its name and what else the meaning of the unknowns depends on.
    pub method: String,
    /// The mesh that the unknowns are values on; empty without one.
    pub mesh: Vec<f64>,
    /// Whether solutions are interpolated between these values, as those of collocation are.
    pub interpolated: bool,
}

impl Representation {
    /// Whether solutions are known to the error of a mesh only.
    pub fn is_on_mesh(&self) -> bool {
        !self.mesh.is_empty()
    }
}

/// What a discretisation knows of a solution.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Traits {
    /// The estimated relative error that the mesh causes; 0 without one.
    pub mesh_error: f64,
    /// The factor by which rounding errors grow inside the discretisation, as deviations do over a
    /// segment of shooting, for what is assembled. Corrections of Newton's that are no larger than
    /// rounding times this are noise.
    pub growth: f64,
    /// The amplitude of a cycle about its mean, relative to the amplitude of the last accepted cycle.
    /// The sign changes where a family of cycles passes through an equilibrium. `None` if cycles
    /// cannot shrink to equilibria.
    pub amplitude: Option<f64>,
    /// The period of a cycle, if it is free: not one that a forcing prescribes.
    pub free_period: Option<f64>,
    /// The largest state on the segment where that is least, in units of the states' scales:
    /// tolerances are relative to these. Segments without motion do not count; infinite without
    /// any.
    pub least_size: f64,
}

impl Default for Traits {
    fn default() -> Self {
        Traits {
            mesh_error: 0.0,
            growth: 1.0,
            amplitude: None,
            free_period: None,
            least_size: f64::INFINITY,
        }
    }
}

/// Solutions with events, orbits or equilibria of a mode: which of them are admissible, and which
/// others begin where one ceases to be.
///
/// *Limits* are monitors that are positive on admissible solutions. Where one vanishes a branch
/// ends, unless it is to go on beyond, and branches of solutions with other events emanate.
pub trait OrbitEvents {
    /// The limits at parameters `p`.
    fn limits(&self, p: &[f64]) -> Vec<Limit>;

    /// Checks the order of events, which the equations do not determine: a branch must not start
    /// where another event would follow, and its points there are marked. Not called where a limit
    /// vanishes: there the order is undecided.
    ///
    /// # Errors
    /// [`Failure::Mismatch`] with the event that leads elsewhere, [`Failure::OutOfDomain`] where
    /// the solution has no meaning.
    fn check(&self, x: &[f64]) -> Result<(), Failure>;

    /// Where an event leads elsewhere at once on the way from one solution to another; `None` where none
    /// does.
    fn jump_between(&self, _solutions: [&[f64]; 2]) -> Option<Jump> {
        None
    }

    /// The standard name of the solution `(z, p)` at which the limit with this monitor vanishes;
    /// `None` if it has none.
    fn name_of_limit(&self, monitor: usize, x: &[f64]) -> Option<&'static str>;

    /// At a limit: the same orbit in the system of orbits without the vanishing event if this
    /// system `passes` that event, otherwise with it. `None` if that system is not known.
    ///
    /// # Errors
    /// [`Failure`] where they cannot be found.
    fn across(&mut self, x: &[f64], passes: bool) -> Result<Option<Across<'_>>, Failure>;

    /// A branch that emanates at a limit, counted from 0.
    ///
    /// # Errors
    /// [`Failure`] where none is known.
    fn emanating(&self, x: &[f64], which: usize) -> Result<Emanating, Failure>;
}

/// Where an event begins to lead elsewhere at once, on the way from one solution to another.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error(
    "the reset of the event `{event}` jumps: behind the event {state} changes from {:.6e} to {:.6e} at once", states[0], states[1]
)]
pub struct Jump {
    /// The part of the way up to there.
    pub share: f64,
    /// The event.
    pub event: String,
    /// The state that jumps most.
    pub state: String,
    /// Its values after the event, before the jump and beyond it.
    pub states: [f64; 2],
}

/// A monitor that is positive on admissible solutions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limit {
    /// The position of the monitor.
    pub monitor: usize,
    /// Its typical size, which tolerances are relative to.
    pub scale: f64,
    /// Whether it belongs to an event that solutions pass, as the speed of an impact does. All
    /// other limits are distances to surfaces that solutions do not pass.
    pub passes: bool,
}

/// A solution at a limit, in the system of the orbits on the other side.
pub struct Across<'a> {
    /// Their system.
    pub system: &'a mut dyn System,
    /// The solution, as `x = (z, p)` of that system.
    pub x: &'a [f64],
}

/// The start of a branch that emanates at a limit.
pub struct Emanating {
    /// The system of its solutions.
    pub system: Box<dyn System>,
    /// The unknowns `z` of the solution at the limit in that system.
    pub z: Vec<f64>,
    /// The direction `(z, p)` of the branch, to that side only, where the equations are singular.
    pub along: Option<Vec<f64>>,
}
