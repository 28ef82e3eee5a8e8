//! Zero problems, vector fields, boundary-value problems and hybrid systems as problems of scenes.

use super::discretisation::{
    BoundarySettings, FieldSettings, HybridOrbitSettings, MapSettings, ProblemSettings, Settled,
    Solution, Started, ZeroSettings, no_start,
};
use super::error::SceneError;
use super::local::Local;
use super::plane::PlaneMap;
use super::problem::{Configured, LUMPED, Model, Parameters, Profiles, SIMULATED};
use super::simulate::{Simulated, rested, stated};
use crate::core::bvp::{ErasedProblem, Guess};
use crate::core::cancel::CancelToken;
use crate::core::continuation::{Branch, SpecialPoint};
use crate::core::equilibrium::{EquilibriumError, HybridEquilibria};
use crate::core::hybrid::{HybridEquations, Mode};
use crate::core::local_map::{self, LocalMap};
use crate::core::manifold::{Manifold, ManifoldError, ManifoldSettings, Side, manifold};
use crate::core::orbit::{HybridOrbit, Itinerary, ItineraryError, MapCycle, PeriodicOrbit, Smooth};
use crate::core::problem::DiscreteMap;
use crate::core::problem::{Dynamics, Equilibria, VectorField, ZeroProblem};
use crate::core::system::{Matrices, System, ZeroSystem};
use std::sync::Arc;

/// Pairs the names of parameters with their default values; names without a default value come
/// last.
pub(super) fn with_defaults(names: Vec<String>, defaults: &[f64]) -> Parameters {
    let defaults = defaults.iter().copied().map(Some).chain(std::iter::repeat(None));
    names.into_iter().zip(defaults).collect()
}

/// Returns an error if the dense matrices of the equations do not fit into memory.
fn refuse_large(unknowns: usize) -> Result<(), SceneError> {
    if unknowns <= Matrices::LARGEST_DENSE {
        return Ok(());
    }
    Err(SceneError::invalid(format!(
        "the equations have {unknowns} unknowns, but simulations, and orbits with dense matrices, are \
         limited to {} unknowns; for orbits by collocation, set `matrices: sparse`",
        Matrices::LARGEST_DENSE
    )))
}

/// The remedy for flows with a mass matrix, which cannot be simulated.
const EXPLICIT: &str = "branches of equilibria and of Hopf points support a mass matrix; for a simulation \
                        or a periodic orbit, solve the algebraic equations by hand and write the rates \
                        as formulas, as in `Equations(states: [(\"x\", \"-x + y\"), …])`";

/// A zero problem in a scene; it needs no discretisation.
impl<P: ZeroProblem + 'static> Model for Configured<Arc<P>, ZeroSettings> {
    fn kind(&self) -> &'static str {
        match self.problem.dynamics() {
            Dynamics::Implicit => "a flow with a mass matrix",
            _ => "a zero problem",
        }
    }

    fn parameters(&self) -> Parameters {
        with_defaults(self.problem.names().parameters, &self.problem.defaults())
    }

    fn system(&self, _p: &[f64], _reach: &[f64]) -> Result<Box<dyn System>, SceneError> {
        Ok(Box::new(ZeroSystem::structured(self.problem.clone(), self.settings.matrices)))
    }

    fn motion(&self) -> Result<Arc<dyn HybridEquations>, SceneError> {
        Err(match self.problem.dynamics() {
            Dynamics::Implicit => self.lacks(SIMULATED, EXPLICIT),
            _ => self.lacks(SIMULATED, LUMPED),
        })
    }
}

/// The problem of computing the periodic orbits or the equilibria of a smooth vector field.
impl<F: VectorField + 'static> Model for Configured<Arc<F>, FieldSettings> {
    fn kind(&self) -> &'static str {
        "a smooth vector field"
    }

    fn parameters(&self) -> Parameters {
        with_defaults(self.problem.names().parameters, &self.problem.defaults())
    }

    fn ladder(&self, _p: &[f64], _reach: &[f64]) -> Result<Vec<Box<dyn Model>>, SceneError> {
        Ok(match self.settings.solution {
            Solution::Orbit => self.on(self.settings.ladder()),
            Solution::Equilibrium => Vec::new(),
        })
    }

    fn system(&self, _p: &[f64], _reach: &[f64]) -> Result<Box<dyn System>, SceneError> {
        match self.settings.solution {
            Solution::Orbit => {
                if !self.settings.has_sparse_orbits() {
                    refuse_large(self.problem.names().dimension())?;
                }
                let orbits = PeriodicOrbit::new(self.problem.clone(), 1);
                self.settings.orbits()?.system(orbits)
            }
            Solution::Equilibrium if self.problem.forcing().is_periodic() => {
                Err(no_equilibrium(FORCED))
            }
            Solution::Equilibrium => {
                let rest = Arc::new(Equilibria::new(self.problem.clone()));
                Ok(Box::new(ZeroSystem::structured(rest, self.settings.matrices)))
            }
        }
    }

    fn motion(&self) -> Result<Arc<dyn HybridEquations>, SceneError> {
        refuse_large(self.problem.names().dimension())?;
        Ok(Arc::new(Smooth(self.problem.clone())))
    }

    fn started(&self, simulated: Guess<HybridOrbit>, p: &[f64]) -> Result<Started, SceneError> {
        let Guess { problem, trajectories, extras, beside } = simulated;
        let periods = problem.itinerary().periods;
        let problem = PeriodicOrbit::new(self.problem.clone(), periods);
        let simulated = Guess { problem, trajectories, extras, beside };
        self.settings.orbits()?.start(simulated, p)
    }

    fn settled(
        &self,
        run: &str,
        simulated: &Simulated,
        p: &[f64],
        cancel: &CancelToken,
    ) -> Result<Settled, SceneError> {
        let motion = self.motion()?;
        match self.settings.solution {
            Solution::Orbit => self.settled_on(motion, run, simulated, p, cancel),
            Solution::Equilibrium => {
                let system = self.system(p, p)?;
                Ok(((system, rested(&*motion, run, simulated, p, cancel)?.1), None))
            }
        }
    }
}

/// The reason why forced systems have no equilibria.
const FORCED: &str = "forced systems have no equilibria";

fn no_equilibrium(reason: &str) -> SceneError {
    SceneError::value("solution", "equilibrium", reason).with_help("set `solution` to `orbit`")
}

/// The remedy for maps, which cannot be simulated.
const ITERATED: &str = "find fixed points with `tangency find`, and trace them with `tangency trace`; `--settle 1000` \
                        starts a branch at the cycle to which 1000 iterations lead";

/// The problem of computing the cycles of a map.
impl<M: DiscreteMap + 'static> Model for Configured<Arc<M>, MapSettings> {
    fn kind(&self) -> &'static str {
        "a map"
    }

    fn parameters(&self) -> Parameters {
        with_defaults(self.problem.names().parameters, &self.problem.defaults())
    }

    fn system(&self, _p: &[f64], _reach: &[f64]) -> Result<Box<dyn System>, SceneError> {
        refuse_large(self.problem.names().dimension())?;
        Ok(Box::new(MapCycle::shared(self.problem.clone(), self.settings.iterates)))
    }

    fn motion(&self) -> Result<Arc<dyn HybridEquations>, SceneError> {
        Err(self.lacks(SIMULATED, ITERATED))
    }

    fn plane(&self) -> Result<&dyn PlaneMap, SceneError> {
        Ok(self)
    }

    fn settled(
        &self,
        _run: &str,
        simulated: &Simulated,
        p: &[f64],
        _cancel: &CancelToken,
    ) -> Result<Settled, SceneError> {
        let start = stated(&Mode::new("map", self.problem.names().elements()), &simulated.state)?.x;
        let transient = simulated.transient.round() as usize;
        let cycle = MapCycle::settled(self.problem.clone(), &start, transient, p);
        let (cycles, z) = cycle.map_err(no_start)?;
        Ok(((Box::new(cycles), z), None))
    }
}

impl<M: DiscreteMap + 'static> PlaneMap for Configured<Arc<M>, MapSettings> {
    fn states(&self) -> Vec<String> {
        self.problem.names().elements().collect()
    }

    fn manifold(
        &self,
        states: &[f64],
        p: &[f64],
        side: Side,
        settings: &ManifoldSettings,
    ) -> Result<Vec<Manifold>, ManifoldError> {
        let n = self.problem.names().dimension();
        let mut cycle = states.to_vec();
        while states.len() == n && cycle.len() < n * self.settings.iterates {
            let mut next = vec![0.0; n];
            self.problem.next(&cycle[cycle.len() - n..], p, &mut next);
            cycle.extend(next);
        }
        manifold(&self.problem, &cycle, p, side, settings)
    }
}

/// A boundary-value problem with the default values of its parameters.
pub(super) type Boundary = (ErasedProblem, Vec<f64>);

/// The problem of computing the solutions of a boundary-value problem.
impl Model for Configured<Boundary, BoundarySettings> {
    fn kind(&self) -> &'static str {
        "a boundary-value problem"
    }

    fn parameters(&self) -> Parameters {
        with_defaults(self.problem.0.parameters(), &self.problem.1)
    }

    fn ladder(&self, _p: &[f64], _reach: &[f64]) -> Result<Vec<Box<dyn Model>>, SceneError> {
        Ok(self.on(self.settings.ladder()))
    }

    fn system(&self, _p: &[f64], _reach: &[f64]) -> Result<Box<dyn System>, SceneError> {
        refuse_large(self.problem.0.segments().concat().len())?;
        self.settings.method.method()?.system(self.problem.0.clone())
    }

    fn sampled(&self, profiles: Profiles) -> Result<Option<Vec<f64>>, SceneError> {
        let problem = &self.problem.0;
        let (segments, first) = (problem.segments(), profiles(0.0));
        let value = |name: &String| first.iter().find(|(known, _)| known == name).map(|it| it.1);
        let extras: Vec<f64> =
            problem.extras().iter().map(|name| value(name).unwrap_or(0.0)).collect();
        let system = self.settings.method.method()?.boundary(problem.clone())?;
        let z = system.sampled(&extras, |segment, tau, x| {
            let values = profiles(tau);
            for (x, state) in x.iter_mut().zip(&segments[segment]) {
                *x = values.iter().find(|(name, _)| name == state).map_or(0.0, |(_, value)| *value);
            }
        });
        Ok(Some(z))
    }
}

/// A hybrid system that is shared between threads.
pub(super) type Hybrid = Arc<dyn HybridEquations>;

impl Configured<Hybrid, HybridOrbitSettings> {
    /// Adds all monitors that the settings request to the equations of an orbit.
    fn watched(&self, orbit: HybridOrbit) -> HybridOrbit {
        if self.settings.penetration { orbit.with_penetration() } else { orbit }
    }

    fn refuse_large(&self) -> Result<(), SceneError> {
        let states = self.problem.modes().iter().map(|mode| mode.states.len()).max();
        refuse_large(states.unwrap_or(0))
    }

    /// Returns the system of equations for equilibria in the mode that the settings name, or in the
    /// first mode if the settings name no mode.
    fn equilibria(&self) -> Result<Box<dyn System>, SceneError> {
        self.refuse_large()?;
        let (system, mode) = (self.problem.clone(), self.settings.mode.as_str());
        let equilibria = match mode {
            "" => HybridEquilibria::new(system, 0),
            name => HybridEquilibria::in_mode(system, name),
        };
        let refused = |cause: EquilibriumError| match cause {
            EquilibriumError::Forced => no_equilibrium(FORCED),
            _ => SceneError::value("mode", mode, cause.to_string()).with_help_of(&cause),
        };
        Ok(Box::new(equilibria.map_err(refused)?))
    }

    /// Returns the initial mode of a motion that starts with the given states of the first mode;
    /// states that are not given are 0.
    fn initial_mode(&self, start: &[(String, f64)], p: &[f64]) -> String {
        let mut modes = self.problem.modes();
        let value =
            |state: &String| start.iter().find(|(name, _)| name == state).map_or(0.0, |it| it.1);
        let x: Vec<f64> = modes[0].states.iter().map(value).collect();
        modes.swap_remove(self.problem.initial_mode(0, 0.0, &x, p)).name
    }
}

/// A hybrid system with its periodic orbits, its equilibria, its motions, and its local maps.
impl Model for Configured<Hybrid, HybridOrbitSettings> {
    fn kind(&self) -> &'static str {
        "a hybrid system"
    }

    fn parameters(&self) -> Parameters {
        with_defaults(self.problem.parameters(), &self.problem.defaults())
    }

    fn ladder(&self, _p: &[f64], _reach: &[f64]) -> Result<Vec<Box<dyn Model>>, SceneError> {
        Ok(match self.settings.solution {
            Solution::Orbit => self.on(self.settings.ladder()),
            Solution::Equilibrium => Vec::new(),
        })
    }

    fn begun_at(&self, start: &[(String, f64)], p: &[f64]) -> Option<Box<dyn Model>> {
        if self.settings.solution == Solution::Orbit || !self.settings.mode.is_empty() {
            return None;
        }
        let mut begun = self.clone();
        begun.settings.mode = self.initial_mode(start, p);
        Some(Box::new(begun))
    }

    fn system(&self, _p: &[f64], _reach: &[f64]) -> Result<Box<dyn System>, SceneError> {
        if self.settings.solution == Solution::Equilibrium {
            return self.equilibria();
        }
        self.refuse_large()?;
        let words = self.settings.itinerary.as_str();
        let unusable = |cause: ItineraryError| {
            SceneError::value("itinerary", words, cause.to_string()).with_help_of(&cause)
        };
        let itinerary = match words {
            "" => Itinerary::smooth(0, 1),
            words => Itinerary::read(words, &*self.problem).map_err(unusable)?,
        };
        let orbits = HybridOrbit::of(self.problem.clone(), itinerary).map_err(unusable)?;
        let orbits = self.watched(orbits);
        self.settings.method.method()?.system(orbits)
    }

    fn motion(&self) -> Result<Hybrid, SceneError> {
        self.refuse_large()?;
        Ok(self.problem.clone())
    }

    fn started(&self, simulated: Guess<HybridOrbit>, p: &[f64]) -> Result<Started, SceneError> {
        let problem = self.watched(simulated.problem);
        self.settings.method.method()?.start(Guess { problem, ..simulated }, p)
    }

    fn settled(
        &self,
        run: &str,
        simulated: &Simulated,
        p: &[f64],
        cancel: &CancelToken,
    ) -> Result<Settled, SceneError> {
        let HybridOrbitSettings { solution, mode: given, .. } = &self.settings;
        if *solution == Solution::Orbit {
            return self.settled_on(self.problem.clone(), run, simulated, p, cancel);
        }
        self.equilibria()?;
        let (mode, z) = rested(&*self.problem, run, simulated, p, cancel)?;
        let name = self.problem.modes().swap_remove(mode).name;
        if !given.is_empty() && *given != name {
            let reason = format!("the motion comes to rest in mode `{name}`");
            return Err(SceneError::value("mode", given, reason));
        }
        let found = HybridEquilibria::new(self.problem.clone(), mode);
        Ok(((Box::new(found.map_err(|_| no_equilibrium(FORCED))?), z), None))
    }

    fn local_map(
        &self,
        run: &str,
        local: &Local,
        at: (&Branch, &SpecialPoint),
        cancel: &CancelToken,
    ) -> Result<LocalMap, SceneError> {
        let (order, cancel) = (self.settings.order, cancel.clone());
        let settings = local_map::MapSettings { order, cancel, ..Default::default() };
        let map = local.map(&self.problem, self.settings.method, settings, at);
        map.map_err(|cause| SceneError::of_run(run, cause))
    }
}
