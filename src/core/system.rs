//! Zero problems `F(z, p) = 0` as continuation sees them.
//!
//! A **[`System`]** is the object-safe `f64` face of a zero problem. Continuation, the conditions
//! of bifurcations and the locator of events see nothing else, so a problem with structure
//! (condensed unknowns, collocation blocks) implements it by itself, while an ordinary problem gets
//! it from [`Dense`], by forward-mode dual numbers.
//!
//! Throughout, `x = (z, p)` is one vector: the `n` unknowns, then *all* parameters, held or
//! released, in the order of their names. A direction in which a derivative is taken is such a
//! vector as well.

mod dense;
mod kind;
mod solution;
mod system_ref;

pub use dense::Dense;
pub use kind::Kind;
pub use solution::{Cycles, Initial, Site, Solution, Start};
pub(crate) use system_ref::SystemRef;

use crate::core::cancel::CancelToken;
use crate::core::failure::Failure;
use crate::core::linalg::{Border, Factors, Form, Spectrum};
use crate::core::problem::{Dynamics, Names, Profile};

/// The same zero problem on a finer discretisation, and a point of it.
pub struct Refinement {
    /// The finer system; its parameters and monitors have the same names.
    pub system: Box<dyn System>,
    /// `x = (z, p)` carried over.
    pub x: Vec<f64>,
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

    /// The gradient of a form `(w, v, order)`, `∇ₓ (wᵀ F_x[v])` for the order 1 or
    /// `∇ₓ (wᵀ F_xx[v, v])` for 2, into `out` (as long as `x`): all components of the unknowns, and
    /// those of the parameters listed in `released`; other parameters' components are unspecified.
    ///
    /// # Errors
    /// [`Failure`] as for [`derivative`](System::derivative), or for another order.
    fn gradient(
        &mut self,
        x: &[f64],
        form: (&[f64], &[f64], usize),
        released: &[usize],
        out: &mut [f64],
    ) -> Result<(), Failure>;

    /// What the residual says about motion.
    fn dynamics(&self) -> Dynamics;

    /// The eigenvalues that decide stability, from the assembled `F_z`; `None` if
    /// no motion is meant. At least all unstable ones are returned, and the rightmost stable one.
    ///
    /// # Errors
    /// [`Failure::Undetermined`] where the equations do not determine them: the point is marked,
    /// and no test function that depends on them acts. [`Failure::Eigenvalues`] if they are not
    /// found.
    fn spectrum(&mut self, x: &[f64]) -> Result<Option<Spectrum>, Failure>;

    /// The sign of the leading coefficient of the polynomial whose zeros are the multipliers that
    /// [`spectrum`](System::spectrum) has given last. Where a multiplier passes through infinity,
    /// as at a grazing, it changes with the multiplier's sign, so that test functions keep theirs.
    fn orientation(&self) -> f64 {
        1.0
    }

    /// The values of the monitors at a solution, in the order of their names.
    ///
    /// # Errors
    /// [`Failure`] if a monitor has no meaning at `x`.
    fn monitors(&mut self, x: &[f64], values: &mut [f64]) -> Result<(), Failure>;

    /// The value of one monitor. `values` is room for all of them, of which the others come out as
    /// they may.
    ///
    /// # Errors
    /// [`Failure`] if the monitor has no meaning at `x`.
    fn monitor(&mut self, monitor: usize, x: &[f64], values: &mut [f64]) -> Result<f64, Failure> {
        self.monitors(x, values)?;
        Ok(values[monitor])
    }

    /// Typical sizes of the groups of unknowns at parameters `p`; empty if all are 1.
    fn unknown_scales(&self, _p: &[f64]) -> Vec<f64> {
        Vec::new()
    }

    /// What is known of periodic solutions as closed curves; `None` if solutions are none.
    fn cycles(&mut self) -> Option<&mut dyn Cycles> {
        None
    }

    /// The gradient of one monitor with respect to `x`, as [`gradient`](System::gradient).
    ///
    /// # Errors
    /// [`Failure`] as for the monitor, or where it is not differentiable.
    fn monitor_gradient(
        &mut self,
        monitor: usize,
        x: &[f64],
        released: &[usize],
        out: &mut [f64],
    ) -> Result<(), Failure>;

    /// Curves that are kept with special points and drawn for them.
    fn profiles(&mut self, _x: &[f64]) -> Vec<Profile> {
        Vec::new()
    }

    /// The system as a discretisation; `None` if the equations are exact as they stand.
    fn discretised(&mut self) -> Option<&mut dyn Discretised> {
        None
    }

    /// The facet of orbits with events; `None` if solutions have no events.
    fn events(&mut self) -> Option<&mut dyn OrbitEvents> {
        None
    }
}

/// A system that discretises something else: finer ones, and the mesh, which may follow a branch.
pub trait Discretised {
    /// The same problem on a finer discretisation: special points are finished on it, and the
    /// difference is the discretisation's share of their `error`. `None` where there is none finer.
    fn refined(&mut self, x: &[f64]) -> Option<Refinement>;

    /// The error (in units of the unknowns' sizes) tolerated from now on in residuals and matrices,
    /// and in monitors evaluated meanwhile, since a solution is only approached; 0 restores full
    /// accuracy.
    fn set_inexactness(&mut self, _error: f64) {}

    /// Cancels evaluations, assemblies and factorisations from now on with this token.
    fn set_cancel(&mut self, _cancel: &CancelToken) {}

    /// The factor by which rounding errors grow inside the discretisation, as deviations do over a
    /// segment of shooting, for what is assembled. Corrections of Newton's that are no larger than
    /// rounding times this are noise.
    fn growth(&self) -> f64 {
        1.0
    }

    /// The same system, to be changed without changing this one; `None` for systems that no branch
    /// changes.
    fn duplicate(&self) -> Option<Box<dyn System>> {
        None
    }

    /// The method, which is saved with branches: its name and what else the meaning of the unknowns
    /// depends on.
    fn method(&self) -> String {
        String::new()
    }

    /// The mesh that the unknowns are values on, to be saved with special points; empty without
    /// one.
    fn mesh(&self) -> Vec<f64> {
        Vec::new()
    }

    /// The estimated relative error of a solution that its mesh causes; 0 without one.
    fn mesh_error(&mut self, _x: &[f64]) -> f64 {
        0.0
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

    /// Prepares the start of a branch from a saved solution. The system may change its mesh, and
    /// with it the number of its unknowns. `None` if the solution is that of the present mesh as it
    /// is.
    ///
    /// # Errors
    /// [`Failure`] if this system cannot start there.
    fn resume_from(&mut self, _solution: &Solution) -> Result<Option<Start>, Failure> {
        Ok(None)
    }

    /// Lets a phase condition and a mesh follow the branch: called at its start, and at each point
    /// accepted. `x` and the `directions` (each as long as `z` or longer) are carried over to a new
    /// mesh with the same number of intervals.
    fn on_accepted(&mut self, _x: &mut [f64], _directions: &mut [&mut [f64]]) {}
}

/// Solutions that are orbits with events: which of them are admissible, and which others begin
/// where one ceases to be.
///
/// *Limits* are monitors that are positive on admissible solutions. Where one vanishes a branch
/// ends, unless it is to go on beyond, and branches of solutions with other events emanate.
pub trait OrbitEvents {
    /// Which events solutions pass, in words that are saved with branches.
    fn words(&self) -> String;

    /// Checks the order of events, which the equations do not determine: a branch must not start
    /// where another event would follow, and its points there are marked. Not called where a limit
    /// vanishes: there the order is undecided.
    ///
    /// # Errors
    /// [`Failure::Mismatch`] with the event that leads elsewhere, [`Failure::OutOfDomain`] where
    /// the solution has no meaning.
    fn check(&self, x: &[f64]) -> Result<(), Failure>;

    /// The limits, as positions of monitors.
    fn limits(&self) -> &[usize];

    /// The typical size of a limit, which tolerances are relative to.
    fn limit_scale(&self, limit: usize, p: &[f64]) -> f64;

    /// The standard name of the solution `(z, p)` at which a limit vanishes; `None` if it has none.
    fn name_of_limit(&self, limit: usize, x: &[f64]) -> Option<&'static str>;

    /// Whether a limit belongs to an event that solutions pass, as the speed of an impact does. All
    /// other limits are distances to surfaces that solutions do not pass.
    fn passes(&self, limit: usize) -> bool;

    /// At a limit: the same orbit in the system of orbits without the vanishing event if this
    /// system passes that event, otherwise with it. `None` if that system is not known.
    ///
    /// # Errors
    /// [`Failure`] where they cannot be found.
    fn across(&mut self, x: &[f64]) -> Result<Option<Across<'_>>, Failure>;

    /// A branch that emanates at a limit, counted from 0.
    ///
    /// # Errors
    /// [`Failure`] where none is known.
    fn emanating(&self, x: &[f64], which: usize) -> Result<Emanating, Failure>;
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

/// What holds of systems without a facet.
impl dyn System + '_ {
    /// The mesh; empty without one.
    pub(crate) fn mesh(&mut self) -> Vec<f64> {
        self.discretised().map_or_else(Vec::new, |system| system.mesh())
    }

    /// The method of the discretisation; empty without one.
    pub(crate) fn method(&mut self) -> String {
        self.discretised().map_or_else(String::new, |system| system.method())
    }

    /// The system as a discretisation on a mesh, whose solutions have an error of its own.
    pub(crate) fn approximation(&mut self) -> Option<&mut dyn Discretised> {
        self.discretised().filter(|system| !system.mesh().is_empty())
    }

    /// Prepares the start of a branch from a saved solution.
    pub(crate) fn resume_from(&mut self, solution: &Solution) -> Result<Start, Failure> {
        if let Some(system) = self.discretised()
            && let Some(start) = system.resume_from(solution)?
        {
            return Ok(start);
        }
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

    /// Which events solutions pass, in words; empty if that is the same for all.
    pub(crate) fn words(&mut self) -> String {
        self.events().map_or_else(String::new, |events| events.words())
    }

    /// The limits of admissible solutions, as positions of monitors.
    pub(crate) fn limits(&mut self) -> Vec<usize> {
        self.events().map_or_else(Vec::new, |events| events.limits().to_vec())
    }

    /// The typical size of a limit.
    pub(crate) fn limit_scale(&mut self, monitor: usize, p: &[f64]) -> f64 {
        self.events().map_or(1.0, |events| events.limit_scale(monitor, p))
    }

    /// Whether all limits are above a part of their scales.
    pub(crate) fn is_within(&mut self, monitors: &[f64], p: &[f64], part: f64) -> bool {
        let Some(events) = self.events() else { return true };
        let beyond = |&m: &usize| monitors[m] < part * events.limit_scale(m, p);
        !events.limits().iter().any(beyond)
    }

    /// The limit that a solution has reached: the least one, in units of their scales.
    pub(crate) fn limit_reached(&mut self, x: &[f64]) -> Result<Option<usize>, Failure> {
        let mut values = vec![0.0; self.names().monitors.len()];
        self.monitors(x, &mut values)?;
        let p = &x[self.names().dimension()..];
        let Some(events) = self.events() else { return Ok(None) };
        let size = |m: &usize| values[*m].abs() / events.limit_scale(*m, p);
        Ok(events.limits().iter().copied().min_by(|a, b| size(a).total_cmp(&size(b))))
    }

    /// Whether solutions pass the event whose limit one of them has reached.
    pub(crate) fn passes_limit(&mut self, x: &[f64]) -> Result<bool, Failure> {
        let reached = self.limit_reached(x)?;
        Ok(self.events().zip(reached).is_some_and(|(events, m)| events.passes(m)))
    }
}
