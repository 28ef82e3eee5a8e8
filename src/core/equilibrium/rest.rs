//! The zero problem whose solutions are the equilibria of one mode of a hybrid system.

use super::error::EquilibriumError;
use crate::core::failure::{Failure, OutOfDomain};
use crate::core::hybrid::{
    EventNumber, GuardNumber, GuardOf, HybridEquations, MeasureNumber, Mode, time_scale,
};
use crate::core::problem::{
    Dynamics, Group, Measure, Names, Observable, Profile, ZeroEquations, ZeroFunctions,
    ZeroMonitors,
};
use crate::core::scalar::Scalar;
use std::sync::Arc;

/// The name of the monitor that is positive at admissible equilibria; the corresponding monitor of
/// orbits has the same name.
const DISTANCE: &str = "distance";

/// Heuristic: a state lies on the surface of its mode if its distance from the surface, in units of
/// the sizes of the states, is no larger than this threshold.
const ON_SURFACE: f64 = 1e-8;

/// The zero problem whose solutions are the equilibria of one mode `m`:
///
/// ```text
///     f_m(Π x, p) − (x − Π x)/τ = 0
/// ```
///
/// `Π` projects states onto the surface to which the motion of the mode is constrained
/// ([`constrain`](crate::core::hybrid::HybridSystem::constrain)), and `τ` is the time scale. On the
/// surface, the left side equals the vector field of the mode. The eigenvalues of the linearised
/// left side are the eigenvalues of motion along the surface and an artificial eigenvalue `−1/τ`
/// across the surface. In modes without such a surface, `Π x = x`.
pub(super) struct RestInMode {
    pub system: Arc<dyn HybridEquations>,
    pub mode: usize,
    /// The indices of the guards that end the mode.
    pub guards: Vec<usize>,
    names: Names,
    /// Whether the motion of the mode is constrained to a surface.
    pub constrained: bool,
    /// The measures of the system that are defined at rest.
    measures: Vec<Measure<Observable>>,
}

impl RestInMode {
    pub fn new(system: Arc<dyn HybridEquations>, mode: usize) -> Result<Self, EquilibriumError> {
        if system.forcing().is_periodic() {
            return Err(EquilibriumError::Forced);
        }
        let (modes, all) = (system.modes(), system.guards());
        let Some(Mode { states, name, on_surface: constrained }) = modes.get(mode).cloned() else {
            return Err(EquilibriumError::NoMode { number: mode, count: modes.len() });
        };
        if states.is_empty() {
            return Err(EquilibriumError::NoStates(name));
        }
        let guards: Vec<usize> = (0..all.len()).filter(|guard| all[*guard].ends(mode)).collect();
        let known = |name: &str| system.scalars(&modes, name)[mode];
        let at_rest = |(name, measure): (String, Measure)| {
            let scalars = measure.scalars().into_iter().all(|name| known(name).is_some());
            let observed = || measure.map(|name| known(name).unwrap_or(Observable::State(0)));
            scalars.then(|| (name, observed()))
        };
        let (recorded, measures): (Vec<String>, _) =
            Measure::of_rest(system.measures()).into_iter().filter_map(at_rest).unzip();
        let distance = (!guards.is_empty()).then(|| DISTANCE.to_string());
        let names = Names::new(Group::of_states(&states), system.parameters())
            .with_monitors(distance.into_iter().chain(recorded));
        Ok(RestInMode { system, mode, guards, names, constrained, measures })
    }

    pub fn system(&self) -> &dyn HybridEquations {
        &*self.system
    }

    /// Returns the name of the mode.
    pub fn name(&self) -> String {
        self.system.modes().swap_remove(self.mode).name
    }

    /// Projects a state onto the surface of this mode.
    fn on_surface<T: EventNumber>(&self, z: &[T], p: &[T]) -> Vec<T> {
        on_surface(self.system(), self.mode, z, p)
    }

    /// Returns the scales of the guards, evaluated at states of half their typical sizes.
    pub fn scales_of_guards(&self, p: &[f64]) -> Vec<f64> {
        let scale = |guard: &usize| GuardOf::typical(self.system(), *guard, self.mode, p).scale;
        self.guards.iter().map(scale).collect()
    }

    /// Returns an error if a state does not lie on the surface of the mode, or if the vector field
    /// is not tangent to the surface.
    pub fn check(&self, z: &[f64], p: &[f64]) -> Result<(), Failure> {
        let (sizes, surface) = (self.system().sizes_of(self.mode, p), self.on_surface(z, p));
        let parts = z.iter().zip(&surface).zip(&sizes).map(|((z, on), size)| (z - on).abs() / size);
        let off = parts.fold(0.0, f64::max);
        if off > ON_SURFACE {
            return Err(OutOfDomain::new(
                "the distance of the state from the surface of its mode, in units of the states' sizes",
                off,
                "start closer to an equilibrium that lies on the surface along which the mode slides",
            )
            .into());
        }
        Ok(self.system.domain_at_ends(self.mode, 0.0, z, p)?)
    }
}

/// Returns the real parts of generalised (dual) numbers.
fn real<T: Scalar>(p: &[T]) -> Vec<f64> {
    p.iter().map(T::real).collect()
}

/// Projects a state of a mode onto the surface of the mode.
fn on_surface<T: EventNumber>(
    system: &dyn HybridEquations,
    mode: usize,
    z: &[T],
    p: &[T],
) -> Vec<T> {
    let mut moved = z.to_vec();
    T::fields(system).constrain_of(mode, T::zero(), &mut moved, p);
    moved
}

/// Computes the left sides of the equilibrium equations and writes them into `r`.
pub(super) fn left_sides<T: EventNumber>(
    (system, mode): (&dyn HybridEquations, usize),
    z: &[T],
    p: &[T],
    r: &mut [T],
) {
    let (surface, time) = (on_surface(system, mode, z, p), time_scale(system, &real(p)));
    system.field(mode, T::zero(), &surface, p, r);
    for ((r, z), on) in r.iter_mut().zip(z).zip(&surface) {
        *r -= (*z - *on) / time;
    }
}

impl<T: EventNumber> ZeroFunctions<T> for RestInMode {
    fn residual_in(&self, z: &[T], p: &[T], r: &mut [T]) {
        left_sides((self.system(), self.mode), z, p, r);
    }

    fn mass_product_in(&self, _z: &[T], _p: &[T], rates: &[T], products: &mut [T]) {
        products.copy_from_slice(rates);
    }
}

impl<T: GuardNumber + MeasureNumber> ZeroMonitors<T> for RestInMode {
    /// Computes the measures of the system and the monitor `distance`, which is the smallest guard,
    /// in units in which all guards have the same scale.
    fn monitors_in(&self, z: &[T], p: &[T], values: &mut [T]) {
        let scales = self.scales_of_guards(&real(p));
        let least = scales.iter().copied().fold(f64::INFINITY, f64::min);
        let guards = self.guards.iter().zip(&scales).map(|(guard, scale)| {
            self.system().guard(*guard, self.mode, T::zero(), z, p) * (least / scale)
        });
        let distance = guards.reduce(|a, b| if b.real() < a.real() { b } else { a });
        let measured = self.measures.iter().map(|measure| {
            let scalar = |of: &Observable| self.system().observe(*of, self.mode, T::zero(), z, p);
            measure.at_rest(scalar).unwrap_or_else(T::zero)
        });
        let all = distance.into_iter().chain(measured);
        values.iter_mut().zip(all).for_each(|(value, number)| *value = number);
    }
}

impl ZeroEquations for RestInMode {
    fn names(&self) -> Names {
        self.names.clone()
    }

    fn defaults(&self) -> Vec<f64> {
        self.system.defaults()
    }

    fn domain(&self, z: &[f64], p: &[f64]) -> Result<(), OutOfDomain> {
        self.system.domain_of(self.mode, z, p)
    }

    fn dynamics(&self) -> Dynamics {
        Dynamics::Flow
    }

    fn scales(&self, p: &[f64]) -> Vec<f64> {
        self.names.sizes_of_groups(&self.system.scales_of(self.mode, p))
    }

    fn profiles(&self, _z: &[f64], _p: &[f64]) -> Vec<Profile> {
        Vec::new()
    }
}
