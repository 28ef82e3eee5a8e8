//! The equilibria of one mode of a hybrid system, as a system of equations for continuation.

use super::boundary::{neighbours, no_neighbour, stays_at_boundary, subkind};
use super::error::EquilibriumError;
use super::rest::RestInMode;
use crate::core::failure::{Failure, one_line};
use crate::core::hybrid::time_scale;
use crate::core::linalg::{Border, Factors, Form, Spectrum, SpectrumRequest};
use crate::core::orbit::IntoHybrid;
use crate::core::problem::{Dynamics, Names, position};
use crate::core::scalar::Space;
use crate::core::system::{
    Across, Emanating, Functional, Limit, OrbitEvents, Representation, Solution, Start, System,
    ZeroSystem,
};
use std::sync::Arc;

/// The equilibria of one mode of an autonomous hybrid system, `f_m(x, p) = 0`. An equilibrium is
/// admissible while the guards of the mode are positive. In a mode whose motion is constrained to a
/// surface ([`constrain`](crate::core::hybrid::HybridSystem::constrain)), the equilibria lie on the
/// surface; the pseudo-equilibria of a Filippov system are an example. The spectrum of an
/// equilibrium on a surface contains only the eigenvalues of motion along the surface.
///
/// The monitors are `distance`, which is the smallest guard, and the measures of the system that
/// are defined at rest. A branch ends at a boundary equilibrium (`G`) where `distance` vanishes. At
/// the boundary equilibrium, an equilibrium of the mode that follows the guard may coincide with
/// the equilibrium of this mode. The point is a *persistence* if the equilibria of the two modes
/// are admissible on opposite sides of the point, and a *nonsmooth fold* if they are admissible on
/// the same side. `switch()` continues along the branch of equilibria of the following mode, and
/// `hold(Kind::G)` continues the boundary equilibrium in one more parameter.
///
/// ```
/// use tangency::core::continuation::Continuation;
/// use tangency::core::equilibrium::HybridEquilibria;
/// use tangency::core::hybrid::filippov::{Filippov, FilippovSystem, Side};
/// use tangency::core::scalar::Scalar;
/// use tangency::core::system::Kind;
/// /// A leaking tank, `x' = q − x`, that leaks more above a threshold, `x' = q − x − 1`.
/// struct Level;
/// impl FilippovSystem for Level {
///     fn states(&self) -> Vec<String> {
///         vec!["x".into(), "s".into()]
///     }
///     fn parameters(&self) -> Vec<String> {
///         vec!["q".into()]
///     }
///     fn surface<T: Scalar>(&self, _t: T, x: &[T], _p: &[T]) -> T {
///         x[0] - 2.0
///     }
///     fn field<T: Scalar>(&self, side: Side, _t: T, x: &[T], p: &[T], f: &mut [T]) {
///         f[0] = p[0] - x[0] - if side == Side::Above { 1.0 } else { 0.0 };
///         f[1] = x[0] - x[1] * 3.0;
///     }
/// }
/// type Modes = Filippov<Level>;
/// let mut below = HybridEquilibria::new(Filippov(Level), Modes::BELOW)?;
/// let branch = Continuation::new(&mut below).at("q", 1.0).along("q", 0.0..=5.0).trace()?;
/// let point = branch.of_kind(Kind::G).next().unwrap();
/// assert!((point.parameters[0] - 2.0).abs() < 1e-12);
/// assert_eq!(point.subkind.as_deref(), Some("boundary equilibrium: persistence"));
/// // The sliding mode has equilibria on the surface from q = 2 to q = 3.
/// let mut below = HybridEquilibria::new(Filippov(Level), Modes::BELOW)?;
/// let curve = Continuation::new(&mut below).restart(&branch, point.label).switch();
/// let sliding = curve.along("q", 0.0..=5.0).trace()?;
/// assert_eq!(sliding.itinerary, "sliding");
/// assert!(sliding.of_kind(Kind::G).any(|point| (point.parameters[0] - 3.0).abs() < 1e-12));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct HybridEquilibria {
    rest: Arc<RestInMode>,
    matrix: ZeroSystem,
    beside: Option<Beside>,
}

/// The equilibrium of another mode that coincides with a boundary equilibrium.
struct Beside {
    /// The unknowns of the boundary equilibrium.
    at: Vec<f64>,
    system: Box<HybridEquilibria>,
    x: Vec<f64>,
}

impl HybridEquilibria {
    /// Creates the system of equations for the equilibria of the mode with the given number.
    ///
    /// # Errors
    /// [`EquilibriumError`] if the hybrid system depends on time, or if the mode does not exist.
    pub fn new(system: impl IntoHybrid, mode: usize) -> Result<Self, EquilibriumError> {
        let rest = Arc::new(RestInMode::new(system.into_hybrid(), mode)?);
        Ok(HybridEquilibria { matrix: ZeroSystem::new(rest.clone()), rest, beside: None })
    }

    /// Creates the system of equations for the equilibria of the mode with the given name.
    ///
    /// # Errors
    /// [`EquilibriumError`] if the hybrid system depends on time, or if no mode has the given name.
    pub fn in_mode(system: impl IntoHybrid, name: &str) -> Result<Self, EquilibriumError> {
        let system = system.into_hybrid();
        let mode = position("mode", name, system.modes().into_iter().map(|mode| mode.name))?;
        Self::new(system, mode)
    }

    /// Creates the system of equations for the equilibria of another mode of the same hybrid
    /// system.
    fn of(&self, mode: usize) -> Result<Self, Failure> {
        Self::new(self.rest.system.clone(), mode)
            .map_err(|error| Failure::Mismatch(one_line(&error)))
    }

    fn parts<'a>(&self, x: &'a [f64]) -> (&'a [f64], &'a [f64]) {
        x.split_at(self.names().dimension())
    }
}

impl System for HybridEquilibria {
    fn names(&self) -> &Names {
        self.matrix.names()
    }

    fn residual(&mut self, x: &[f64], r: &mut [f64]) -> Result<(), Failure> {
        self.matrix.residual(x, r)
    }

    fn assemble(&mut self, x: &[f64]) -> Result<(), Failure> {
        self.matrix.assemble(x)
    }

    fn factor(&mut self, form: Form, border: Border, into: &mut Factors) -> Result<(), Failure> {
        self.matrix.factor(form, border, into)
    }

    fn derivative(
        &mut self,
        x: &[f64],
        directions: &[&[f64]],
        out: &mut [f64],
    ) -> Result<(), Failure> {
        self.matrix.derivative(x, directions, out)
    }

    fn gradient(
        &mut self,
        x: &[f64],
        of: Functional,
        released: &[usize],
        out: &mut [f64],
    ) -> Result<(), Failure> {
        self.matrix.gradient(x, of, released, out)
    }

    fn slopes(&mut self, x: &[f64], first: usize, direction: &[f64], out: &mut [f64]) {
        self.matrix.slopes(x, first, direction, out);
    }

    fn expand(
        &mut self,
        x: &[f64],
        space: &'static Space,
        terms: &[Vec<f64>],
    ) -> Result<Vec<Vec<f64>>, Failure> {
        self.matrix.expand(x, space, terms)
    }

    fn dynamics(&self) -> Dynamics {
        self.matrix.dynamics()
    }

    /// Computes the eigenvalues of motion along the surface of the mode, without the artificial
    /// eigenvalue `−1/τ` across the surface.
    fn spectrum(
        &mut self,
        x: &[f64],
        request: SpectrumRequest,
    ) -> Result<Option<Spectrum>, Failure> {
        let (_, p) = self.parts(x);
        let rate = -1.0 / time_scale(self.rest.system(), p);
        let scale = self.rest.scales_of_guards(p).into_iter().reduce(f64::min);
        if scale.is_some_and(|scale| stays_at_boundary(&mut self.matrix, x, scale)) {
            return Err(Failure::Undetermined(format!(
                "the equilibrium lies on the boundary of mode `{}` for all parameter values: trace \
                 the equilibrium in another mode",
                self.rest.name()
            )));
        }
        let mut spectrum = self.matrix.spectrum(x, request)?;
        if let (true, Some(all)) = (self.rest.constrained, &mut spectrum) {
            let off = |k: &usize| f64::hypot(all[*k].0 - rate, all[*k].1);
            let across = (0..all.len()).min_by(|a, b| off(a).total_cmp(&off(b)));
            across.map(|k| all.remove(k));
        }
        Ok(spectrum)
    }

    fn monitors(&mut self, x: &[f64], first: usize, values: &mut [f64]) -> Result<(), Failure> {
        self.matrix.monitors(x, first, values)
    }

    fn unknown_scales(&self, p: &[f64]) -> Vec<f64> {
        self.matrix.unknown_scales(p)
    }

    /// Returns the representation of the equilibria, which contains the name of the mode as their
    /// itinerary.
    fn representation(&self) -> Representation {
        Representation { itinerary: self.rest.name(), ..Representation::default() }
    }

    /// Resumes from a saved equilibrium, which may belong to another mode.
    fn resume_from(&mut self, solution: &Solution) -> Result<Start, Failure> {
        if !solution.itinerary.is_empty() && solution.itinerary != self.rest.name() {
            let other = Self::in_mode(self.rest.system.clone(), &solution.itinerary);
            *self = other.map_err(|error| {
                let words = &solution.itinerary;
                Failure::Mismatch(format!(
                    "the start has the itinerary `{words}`, which is not the name of a mode: {}",
                    one_line(&error)
                ))
            })?;
        }
        let (n, found) = (self.names().dimension(), solution.state.len());
        if found != n {
            return Err(Failure::Mismatch(format!(
                "the start has {found} unknowns, but an equilibrium of mode `{}` has {n} unknowns: \
                 start from an equilibrium of this mode",
                self.rest.name()
            )));
        }
        let tangent = solution.tangent.as_ref().map(|(z, p)| [&z[..], &p[..]].concat());
        Ok(Start::point(solution.state.clone(), tangent))
    }

    fn events(&mut self) -> Option<&mut dyn OrbitEvents> {
        Some(self)
    }
}

impl OrbitEvents for HybridEquilibria {
    /// Returns the limit of admissible equilibria at which the monitor `distance` vanishes, if the
    /// mode has guards. For equilibria on a surface, the event at the limit of admissible
    /// equilibria counts as an event of the solutions ([`Limit::passes`]).
    fn limits(&self, p: &[f64]) -> Vec<Limit> {
        let scale = self.rest.scales_of_guards(p).into_iter().reduce(f64::min);
        let passes = self.rest.constrained;
        scale.into_iter().map(|scale| Limit { monitor: 0, scale, passes }).collect()
    }

    fn check(&self, x: &[f64]) -> Result<(), Failure> {
        let (z, p) = self.parts(x);
        self.rest.check(z, p)
    }

    fn name_of_limit(&self, _monitor: usize, x: &[f64]) -> Option<&'static str> {
        let (z, p) = self.parts(x);
        let other = neighbours(&self.rest, z, p).into_iter().next();
        let other = other.and_then(|(mode, z)| Some((self.of(mode).ok()?, [&z, p].concat())));
        Some(subkind((&mut self.of(self.rest.mode).ok()?, x), other))
    }

    fn across(&mut self, x: &[f64], _passes: bool) -> Result<Option<Across<'_>>, Failure> {
        if !self.beside.as_ref().is_some_and(|beside| beside.at == x) {
            let (z, p) = self.parts(x);
            let other = neighbours(&self.rest, z, p).into_iter().next();
            let beside = other.map(|(mode, z)| {
                let (at, system) = (x.to_vec(), Box::new(self.of(mode)?));
                Ok::<_, Failure>(Beside { at, system, x: [&z, p].concat() })
            });
            self.beside = beside.transpose()?;
        }
        let Some(Beside { system, x, .. }) = &mut self.beside else { return Ok(None) };
        Ok(Some(Across { system: &mut **system, x }))
    }

    fn emanating(&self, x: &[f64], which: usize) -> Result<Emanating, Failure> {
        let (z, p) = self.parts(x);
        let mut all = neighbours(&self.rest, z, p);
        if all.is_empty() {
            return Err(no_neighbour(&self.rest));
        }
        if which >= all.len() {
            return Err(Failure::no_branch(which, all.len()));
        }
        let (mode, z) = all.swap_remove(which);
        Ok(Emanating { system: Box::new(self.of(mode)?), z, along: None })
    }
}
