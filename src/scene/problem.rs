//! The problems that a scene can name.

use super::discretisation::{Discretisation, Discretised};
use super::simulate::{Simulation, simulate};
use super::slot::{Capitals, Plain, Slots, Usual};
use super::{Local, SceneError, Simulated, slot};
use crate::core::bvp::BoundaryProblem;
use crate::core::continuation::{Branch, SettingError, SpecialPoint};
use crate::core::field::VectorField;
use crate::core::grazing::LocalMap;
use crate::core::hybrid::{HybridState, HybridSystem};
use crate::core::zero::System;
use crate::problems::classic::{Bratu, ImpactOscillator, Isothermal, Lure};
use crate::problems::mita::{Actuator, Block};
use crate::problems::plate::PlateSettings;
use serde::{Deserialize, Serialize};

/// A problem with its terms.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Problem {
    /// An electrically actuated microplate.
    Plate(PlateSettings),
    /// Mita's impact microactuator.
    Mita(Discretisation),
    /// Its block alone, the frame at rest, without impacts.
    Block(Discretisation),
    /// The forced linear oscillator with a stop.
    ImpactOscillator(Discretisation),
    /// A feedback control system of Lur'e type.
    Lure(Discretisation),
    /// Seydel's isothermal reaction.
    Isothermal(Discretisation),
    /// Bratu's boundary-value problem.
    Bratu(Discretisation),
}

impl Problem {
    /// Names of the parameters and their default values.
    pub fn parameters(&self) -> Vec<(String, f64)> {
        let (names, defaults) = match self {
            Problem::Plate(plate) => {
                let names = plate.units.names().iter().map(|name| name.to_string());
                (names.collect(), plate.units.defaults())
            }
            Problem::Mita(_) => (Actuator.parameters(), &Actuator::DEFAULTS[..]),
            Problem::Block(_) => (Block.names().parameters, &Block::DEFAULTS[..]),
            Problem::ImpactOscillator(_) => {
                (ImpactOscillator.parameters(), &ImpactOscillator::DEFAULTS[..])
            }
            Problem::Lure(_) => (Lure.names().parameters, &Lure::DEFAULTS[..]),
            Problem::Isothermal(_) => (Isothermal.names().parameters, &Isothermal::DEFAULTS[..]),
            Problem::Bratu(_) => (Bratu.parameters(), &Bratu::DEFAULTS[..]),
        };
        names.into_iter().zip(defaults.iter().copied()).collect()
    }

    /// Names of the settings, and their values as they are written.
    pub fn settings(&self) -> Vec<(&'static str, String)> {
        let mut copy = self.clone();
        copy.slots().into_iter().map(|(name, slot)| (name, slot.written())).collect()
    }

    /// Sets one setting by name; false if there is none of this name.
    pub(super) fn set(&mut self, name: &str, value: &str) -> Result<bool, SceneError> {
        slot::assign(self.slots(), name, value)
    }

    /// The same problem by discretisations of growing accuracy and cost, for parameters that begin at `p` and go as far as
    /// `reach`; none if it has no discretisation.
    pub(super) fn ladder(&self, p: &[f64], reach: &[f64]) -> Result<Vec<Problem>, SceneError> {
        let of = |make: fn(Discretisation) -> Problem, settings: &Discretisation, usual| {
            settings.ladder(usual).into_iter().map(make).collect()
        };
        let (smooth, hybrid) = (Discretised::USUAL, Discretised::USUAL_HYBRID);
        Ok(match self {
            Problem::Plate(plate) => {
                plate.ladder(p, reach)?.into_iter().map(Problem::Plate).collect()
            }
            Problem::Mita(settings) => of(Problem::Mita, settings, hybrid),
            Problem::Block(settings) => of(Problem::Block, settings, smooth),
            Problem::ImpactOscillator(settings) => of(Problem::ImpactOscillator, settings, hybrid),
            Problem::Lure(settings) => of(Problem::Lure, settings, smooth),
            Problem::Isothermal(settings) => of(Problem::Isothermal, settings, smooth),
            Problem::Bratu(settings) => of(Problem::Bratu, settings, smooth),
        })
    }

    /// The same problem with default settings.
    pub(super) fn with_defaults(&self) -> Problem {
        match self {
            Problem::Plate(_) => Problem::Plate(PlateSettings::default()),
            Problem::Mita(_) => Problem::Mita(Discretisation::default()),
            Problem::Block(_) => Problem::Block(Discretisation::default()),
            Problem::ImpactOscillator(_) => Problem::ImpactOscillator(Discretisation::default()),
            Problem::Lure(_) => Problem::Lure(Discretisation::default()),
            Problem::Isothermal(_) => Problem::Isothermal(Discretisation::default()),
            Problem::Bratu(_) => Problem::Bratu(Discretisation::default()),
        }
    }

    fn slots(&mut self) -> Slots<'_> {
        match self {
            Problem::Plate(plate) => plate_slots(plate),
            Problem::Block(settings) | Problem::Lure(settings) | Problem::Isothermal(settings) => {
                settings.slots_but("itinerary order penetration")
            }
            Problem::Mita(settings) | Problem::ImpactOscillator(settings) => {
                settings.slots_but("solution")
            }
            Problem::Bratu(settings) => settings.slots_but("solution itinerary order penetration"),
        }
    }

    /// Checks the ranges of settings that do not depend on parameters.
    pub(super) fn check(&self) -> Result<(), SettingError> {
        match self {
            Problem::Plate(_) => Ok(()),
            Problem::Mita(settings)
            | Problem::Block(settings)
            | Problem::ImpactOscillator(settings)
            | Problem::Lure(settings)
            | Problem::Isothermal(settings)
            | Problem::Bratu(settings) => settings.check(),
        }
    }

    /// A simulated history.
    pub(super) fn history(
        &self,
        run: &str,
        simulated: &Simulated,
        p: &[f64],
        start: Option<HybridState<f64>>,
    ) -> Result<Simulation, SceneError> {
        match self {
            Problem::Mita(_) => simulate(&Actuator, run, simulated, p, start),
            Problem::ImpactOscillator(_) => simulate(&ImpactOscillator, run, simulated, p, start),
            _ => Err(not_hybrid("start", "Simulated")),
        }
    }

    /// The system of the orbits like the one on which a simulation settles, and that orbit.
    pub(super) fn settled(
        &self,
        run: &str,
        simulated: &Simulated,
        p: &[f64],
    ) -> Result<(Box<dyn System>, Vec<f64>), SceneError> {
        match self {
            Problem::Mita(settings) => settings.settled(Actuator, run, simulated, p),
            Problem::ImpactOscillator(settings) => {
                settings.settled(ImpactOscillator, run, simulated, p)
            }
            _ => Err(not_hybrid("start", "Simulated")),
        }
    }

    /// The local map at a grazing, for a run or a sweep.
    pub(super) fn local_map(
        &self,
        run: &str,
        local: &Local,
        at: (&Branch, &SpecialPoint),
    ) -> Result<LocalMap, SceneError> {
        let map = match self {
            Problem::Mita(settings) => settings.local_map(Actuator, local, at),
            Problem::ImpactOscillator(settings) => settings.local_map(ImpactOscillator, local, at),
            _ => {
                let reason = "only hybrid systems graze: `Mita`, `ImpactOscillator`";
                let (name, value) = ("local".into(), run.into());
                return Err(SceneError::Value { name, value, reason: reason.into() });
            }
        };
        map.map_err(|cause| SceneError::Local { run: run.into(), cause: Box::new(cause) })
    }

    /// The system for parameters that begin at `p`; `reach` lists for each of them how far it goes
    /// from there.
    pub(super) fn system(&self, p: &[f64], reach: &[f64]) -> Result<Box<dyn System>, SceneError> {
        match self {
            Problem::Plate(plate) => Ok(plate.system(p, reach)?),
            Problem::Mita(settings) => settings.of_hybrid(Actuator),
            Problem::Block(settings) => settings.of_field(Block),
            Problem::ImpactOscillator(settings) => settings.of_hybrid(ImpactOscillator),
            Problem::Lure(settings) => settings.of_field(Lure),
            Problem::Isothermal(settings) => settings.of_field(Isothermal),
            Problem::Bratu(settings) => settings.of_problem(Bratu),
        }
    }
}

/// What of a scene needs a hybrid system.
pub(super) fn not_hybrid(name: &str, value: &str) -> SceneError {
    let reason = "only hybrid systems are simulated by scenes: `Mita`, `ImpactOscillator`";
    SceneError::Value { name: name.into(), value: value.into(), reason: reason.into() }
}

fn plate_slots(plate: &mut PlateSettings) -> Slots<'_> {
    vec![
        ("supports", Box::new(Capitals(&mut plate.supports))),
        ("in_plane", Box::new(Usual(&mut plate.in_plane))),
        ("theory", Box::new(Plain(&mut plate.theory))),
        ("model", Box::new(Plain(&mut plate.model))),
        ("modes", Box::new(Plain(&mut plate.modes))),
        ("projection", Box::new(Plain(&mut plate.projection))),
        ("orders", Box::new(Usual(&mut plate.orders))),
        ("units", Box::new(Plain(&mut plate.units))),
        ("symmetric", Box::new(Usual(&mut plate.symmetric))),
    ]
}
