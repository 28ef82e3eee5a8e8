//! Zero problems, vector fields, boundary-value problems and hybrid systems as problems of scenes.

use super::discretisation::{
    BoundarySettings, FieldSettings, HybridOrbitSettings, Solution, Started, ZeroSettings,
};
use super::problem::{Model, Swept};
use super::{Local, SceneError};
use crate::core::attractor::{PeriodMap, StroboscopicError, StroboscopicMap};
use crate::core::bvp::{Birth, BoundaryProblem, Equations, IntoEquations};
use crate::core::continuation::{Branch, SpecialPoint};
use crate::core::dense::Dense;
use crate::core::field::{Equilibria, VectorField};
use crate::core::flow::{Scheme, Settings};
use crate::core::grazing::LocalMap;
use crate::core::hybrid::{HybridEquations, HybridSettings};
use crate::core::orbit::{HybridOrbit, Itinerary, Smooth};
use crate::core::zero::{System, ZeroProblem};
use std::sync::Arc;

/// Names with their defaults; without a default where the problem states fewer of them.
pub(super) fn with_defaults(names: Vec<String>, defaults: &[f64]) -> Vec<(String, Option<f64>)> {
    let defaults = defaults.iter().copied().map(Some).chain(std::iter::repeat(None));
    names.into_iter().zip(defaults).collect()
}

/// A zero problem, solved as it is.
pub(super) struct Zero<P>(pub P);

impl<P: ZeroProblem + Clone + 'static> Model for Zero<P> {
    type Settings = ZeroSettings;
    const KIND: &'static str = "a zero problem";

    fn parameters(&self, _settings: &ZeroSettings) -> Vec<(String, Option<f64>)> {
        with_defaults(self.0.names().parameters, &self.0.defaults())
    }

    fn system(
        &self,
        _settings: &ZeroSettings,
        _p: &[f64],
        _reach: &[f64],
    ) -> Result<Box<dyn System>, SceneError> {
        Ok(Box::new(Dense::new(self.0.clone())))
    }
}

/// The periodic orbits or the equilibria of a smooth field.
pub(super) struct Field<F>(pub F);

impl<F: VectorField + Clone + 'static> Model for Field<F> {
    type Settings = FieldSettings;
    const KIND: &'static str = "a smooth vector field";

    fn parameters(&self, _settings: &FieldSettings) -> Vec<(String, Option<f64>)> {
        with_defaults(self.0.names().parameters, &self.0.defaults())
    }

    fn ladder(
        &self,
        settings: &FieldSettings,
        _p: &[f64],
        _reach: &[f64],
    ) -> Result<Vec<FieldSettings>, SceneError> {
        Ok(match settings.solution {
            Solution::Orbit => settings.ladder(),
            Solution::Equilibrium => Vec::new(),
        })
    }

    fn system(
        &self,
        settings: &FieldSettings,
        _p: &[f64],
        _reach: &[f64],
    ) -> Result<Box<dyn System>, SceneError> {
        let field = self.0.clone();
        match settings.solution {
            Solution::Orbit => settings.discretisation().system(HybridOrbit::smooth_of(field, 1)),
            Solution::Equilibrium if field.forcing().is_periodic() => Err(SceneError::Value {
                name: "solution".into(),
                value: "equilibrium".into(),
                reason: "a field that is forced in time has none; take `orbit`".into(),
            }),
            Solution::Equilibrium => Ok(Box::new(Dense::new(Equilibria(field)))),
        }
    }

    fn motion(&self) -> Result<Arc<dyn HybridEquations>, SceneError> {
        Ok(Arc::new(Smooth(self.0.clone())))
    }

    fn started(
        &self,
        settings: &FieldSettings,
        simulated: Birth<HybridOrbit>,
        p: &[f64],
    ) -> Result<Started, SceneError> {
        match settings.solution {
            Solution::Orbit => settings.discretisation().start(simulated, p),
            Solution::Equilibrium => Err(SceneError::Value {
                name: "solution".into(),
                value: "equilibrium".into(),
                reason: "a run that starts from a simulation follows orbits; take `orbit`".into(),
            }),
        }
    }
}

/// The solutions of a boundary-value problem.
pub(super) struct Boundary {
    problem: Arc<dyn Equations>,
    defaults: Vec<f64>,
}

impl Boundary {
    pub fn of(problem: impl BoundaryProblem + 'static) -> Self {
        let defaults = problem.defaults();
        Boundary { problem: problem.into_equations(), defaults }
    }
}

impl Model for Boundary {
    type Settings = BoundarySettings;
    const KIND: &'static str = "a boundary-value problem";

    fn parameters(&self, _settings: &BoundarySettings) -> Vec<(String, Option<f64>)> {
        with_defaults(self.problem.parameters(), &self.defaults)
    }

    fn ladder(
        &self,
        settings: &BoundarySettings,
        _p: &[f64],
        _reach: &[f64],
    ) -> Result<Vec<BoundarySettings>, SceneError> {
        Ok(settings.ladder())
    }

    fn system(
        &self,
        settings: &BoundarySettings,
        _p: &[f64],
        _reach: &[f64],
    ) -> Result<Box<dyn System>, SceneError> {
        settings.discretisation().system(self.problem.clone())
    }
}

/// The periodic orbits of a hybrid system, its simulations, its local maps, and its motions in sweeps.
pub(super) struct Hybrid(pub Arc<dyn HybridEquations>);

/// Orbits with all monitors that the settings ask for.
fn watched(settings: &HybridOrbitSettings, orbit: HybridOrbit) -> HybridOrbit {
    if settings.penetration { orbit.with_penetration() } else { orbit }
}

impl Model for Hybrid {
    type Settings = HybridOrbitSettings;
    const KIND: &'static str = "a hybrid system";

    fn parameters(&self, _settings: &HybridOrbitSettings) -> Vec<(String, Option<f64>)> {
        with_defaults(self.0.parameters(), &self.0.defaults())
    }

    fn ladder(
        &self,
        settings: &HybridOrbitSettings,
        _p: &[f64],
        _reach: &[f64],
    ) -> Result<Vec<HybridOrbitSettings>, SceneError> {
        Ok(settings.ladder())
    }

    fn system(
        &self,
        settings: &HybridOrbitSettings,
        _p: &[f64],
        _reach: &[f64],
    ) -> Result<Box<dyn System>, SceneError> {
        let itinerary = match settings.itinerary.as_str() {
            "" => Itinerary::smooth(0, 1),
            words => Itinerary::read(words, &*self.0).map_err(|cause| SceneError::Value {
                name: "itinerary".into(),
                value: words.into(),
                reason: cause.to_string(),
            })?,
        };
        let orbits = watched(settings, HybridOrbit::of(self.0.clone(), itinerary));
        settings.discretisation().system(orbits)
    }

    fn motion(&self) -> Result<Arc<dyn HybridEquations>, SceneError> {
        Ok(self.0.clone())
    }

    fn started(
        &self,
        settings: &HybridOrbitSettings,
        Birth { problem, starts, extras }: Birth<HybridOrbit>,
        p: &[f64],
    ) -> Result<Started, SceneError> {
        let simulated = Birth { problem: watched(settings, problem), starts, extras };
        settings.discretisation().start(simulated, p)
    }

    fn local_map(
        &self,
        settings: &HybridOrbitSettings,
        run: &str,
        local: &Local,
        at: (&Branch, &SpecialPoint),
    ) -> Result<LocalMap, SceneError> {
        local
            .map(&self.0, settings.discretisation(), settings.order, at)
            .map_err(|cause| SceneError::Local { run: run.into(), cause: Box::new(cause) })
    }

    fn swept(&self) -> Result<&dyn Swept, SceneError> {
        Ok(self)
    }
}

impl Swept for Hybrid {
    fn strobed(
        &self,
        measures: &[String],
        tolerance: f64,
    ) -> Result<Box<dyn StroboscopicMap + '_>, StroboscopicError> {
        let flow = Settings::new(Scheme::DormandPrince8, tolerance);
        let settings = HybridSettings { flow, ..HybridSettings::default() };
        Ok(Box::new(PeriodMap::of(&*self.0, settings, measures)?))
    }
}
