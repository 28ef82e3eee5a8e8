//! The problems and scenes of this library, as a [`Catalogue`].

use super::catalogue::Catalogue;
use super::discretisation::ProblemSettings;
use super::error::{ProblemError, SceneError};
use super::kinds::with_defaults;
use super::notation::written;
use super::problem::{Configured, Model, Parameters};
use crate::core::system::System;
use crate::problems::classic::{Bratu, ImpactOscillator, Isothermal, Lure};
use crate::problems::mita::{Actuator, Block};
use crate::problems::plate::{self, PlateSettings};

impl Catalogue {
    /// Returns the catalogue of the problems and scenes of this library.
    pub fn built_in() -> Self {
        let problems = Catalogue::empty()
            .model::<_, PlateSettings>("Plate", Plate)
            .hybrid("Mita", Actuator)
            .field("Block", Block)
            .hybrid("ImpactOscillator", ImpactOscillator)
            .field("Lure", Lure)
            .field("Isothermal", Isothermal)
            .boundary("Bratu", Bratu);
        let all = BUILT_IN.iter().chain(LIBRARY);
        all.fold(problems, |catalogue, scene| catalogue.scene(scene.name, scene.text))
    }
}

/// The problem of an electrically actuated microplate.
#[derive(Clone)]
struct Plate;

impl Model for Configured<Plate, PlateSettings> {
    fn kind(&self) -> &'static str {
        "a plate with static equations"
    }

    fn parameters(&self) -> Parameters {
        let units = self.settings.units;
        let names = units.names().iter().map(|name| name.to_string());
        with_defaults(names.collect(), units.defaults())
    }

    fn ladder(&self, p: &[f64], reach: &[f64]) -> Result<Vec<Box<dyn Model>>, SceneError> {
        Ok(self.on(self.settings.ladder(p, reach).map_err(ProblemError::new)?))
    }

    fn system(&self, p: &[f64], reach: &[f64]) -> Result<Box<dyn System>, SceneError> {
        Ok(self.settings.system(p, reach).map_err(ProblemError::new)?)
    }
}

impl ProblemSettings for PlateSettings {
    fn define_equations() -> bool {
        true
    }

    fn without_effect(&self, name: &str) -> Option<(&'static str, String)> {
        let others: &[&str] = match self.model {
            plate::Model::Ritz => &["modes", "projection"],
            plate::Model::Modal | plate::Model::Sine => &["orders"],
        };
        others.contains(&name).then(|| ("model", written(&self.model)))
    }
}

/// A built-in scene of the program.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BuiltIn {
    /// The name under which the command line and the library find the scene.
    pub name: &'static str,
    /// The text of the scene, as RON.
    pub text: &'static str,
}

// `BUILT_IN` holds the devices and examples in `scenes`, and `LIBRARY` the models of the literature
// in `scenes/library`, both sorted by name: the build script lists the folders.
include!(concat!(env!("OUT_DIR"), "/scenes.rs"));
