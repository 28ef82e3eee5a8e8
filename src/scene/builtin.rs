//! The problems and scenes of this library.

use super::catalogue::{Catalogue, NamedScene};
use super::discretisation::ProblemSettings;
use super::error::{ProblemError, SceneError};
use super::kinds::with_defaults;
use super::problem::{Configured, Model, Parameters};
use super::slot::{Slots, slots, written};
use crate::core::system::System;
use crate::problems::classic::{Bratu, ImpactOscillator, Isothermal, Lure};
use crate::problems::mita::{Actuator, Block};
use crate::problems::plate::{self, PlateSettings};

impl Catalogue {
    /// The problems and scenes of this library.
    pub fn built_in() -> Self {
        let problems = Catalogue::empty()
            .model::<_, PlateSettings>("Plate", Plate)
            .hybrid("Mita", Actuator)
            .field("Block", Block)
            .hybrid("ImpactOscillator", ImpactOscillator)
            .field("Lure", Lure)
            .field("Isothermal", Isothermal)
            .boundary("Bratu", Bratu);
        BUILT_IN.iter().fold(problems, |catalogue, scene| {
            let (name, text) = (scene.name.into(), scene.text.into());
            catalogue.listed(NamedScene { name, text, summary: Some(scene.summary.into()) })
        })
    }
}

/// An electrically actuated microplate.
#[derive(Clone)]
struct Plate;

impl Model for Configured<Plate, PlateSettings> {
    fn kind(&self) -> &'static str {
        "a plate, whose equations are static"
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
    fn slots(&mut self) -> Slots<'_> {
        slots!(self => PlateSettings {
            supports: Capitals,
            in_plane: Usual,
            theory: Plain,
            model: Plain,
            modes: Plain,
            projection: Plain,
            orders: Usual,
            units: Plain,
            symmetric: Usual,
        })
    }

    fn without_effect(&self, name: &str) -> Option<(&'static str, String)> {
        let others: &[&str] = match self.model {
            plate::Model::Ritz => &["modes", "projection"],
            plate::Model::Modal | plate::Model::Sine => &["orders"],
        };
        others.contains(&name).then(|| ("model", written(&self.model)))
    }
}

/// A scene that comes with the program.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BuiltIn {
    /// Its name.
    pub name: &'static str,
    /// The summary in one line.
    pub summary: &'static str,
    /// Its text, as RON.
    pub text: &'static str,
}

macro_rules! built_in {
    ($($name:literal: $summary:literal,)*) => {
        &[$(BuiltIn {
            name: $name,
            summary: $summary,
            text: include_str!(concat!("../../scenes/", $name, ".ron")),
        }),*]
    };
}

/// All scenes that come with the program, in the order in which they are listed.
pub const BUILT_IN: &[BuiltIn] = built_in![
    "plate-supported": "a supported plate through pull-in, and its mode shapes (figures 3.12, 3.13)",
    "plate-clamped": "a clamped plate through pull-in, and its mode shapes (3.14, 3.22, 3.23)",
    "plate-aspect": "load against deflection for several aspect ratios (3.10)",
    "plate-frequency": "frequency against load for several gap ratios (3.11, 3.21)",
    "plate-pull-in-gap": "pull-in against gap ratio for each in-plane edge model (3.6, 3.7, 3.15, 3.16, 3.18, 3.19)",
    "plate-pull-in-edges": "pull-in of supported and clamped plates side by side (3.20)",
    "plate-pull-in-aspect": "pull-in against aspect ratio for several gap ratios (3.8, 3.9)",
    "plate-modes": "models of few modes against the full one (3.3, 3.4, 3.5)",
    "plate-modes-clamped": "few modes of a clamped plate against the full model (3.17)",
    "plate-buckling": "a plate compressed at its edges: a branch point, and the buckled branches",
    "plate-device": "a plate in SI units: volts to pull-in, frequency in hertz",
    "mita-nonimpacting": "Mita's actuator below its impacts: voltage against amplitude, folds and grazing",
    "mita-nonimpacting-folds": "the curve of these folds in frequency and voltage, and its cusp",
    "mita-type-1": "Mita's actuator at ω = 0.5: impacting orbits from their grazing through fold and period doubling (4.5, 4.6, 6.1, 6.2)",
    "mita-type-2": "the same at ω = 0.485 (4.7)",
    "mita-type-3": "the same at ω = 0.45 (4.8)",
    "mita-voltage": "how far the frame goes in a period, against voltage (4.10)",
    "mita-frequency": "frequency responses with impacts and without (4.11, 6.10, 6.11)",
    "mita-grazing-curve": "the curve of grazings in frequency and voltage, and its codimension-two points",
    "mita-switching": "switch-on and switch-off in frequency and voltage (4.9, 5.5)",
    "mita-near-grazing-1": "flow and local map near the grazing of type I: virtual points, multipliers (5.10, 5.11)",
    "mita-near-grazing-2": "the same for type II (5.12)",
    "mita-near-grazing-3": "the same for type III (5.14, 5.15)",
    "mita-local-curves": "folds, doublings and grazings of flow and local maps near both points of codimension two (5.13, 5.16)",
    "mita-s-curve": "orbits with three impacts a period, between two folds (6.6)",
    "mita-ladder": "the ladder of chatter c₄, c₅, …: period doublings of orbits with n impacts (6.9)",
    "mita-histories": "simulated histories: slow drive, settled motions, chatter (4.3, 4.4, 6.1, 6.4, 6.7)",
    "mita-diagram": "bifurcation diagram by brute force, over the branches that explain it (6.3, 6.5)",
    "mita-chatter": "the route of chatter to sticking by brute force, and its histories (6.8, 6.9)",
    "mita-band": "the chaotic bands beyond grazing, and the crisis that ends one (4.7, 4.8)",
    "mita-basins": "basins of attraction of the orbits with impacts and without, over initial states",
    "mita-lyapunov": "the largest Lyapunov exponent beyond grazing (5.17)",
    "impact-oscillator": "the forced linear impact oscillator: grazing, fold, period doubling",
    "dry-friction": "a forced oscillator that sticks: motion without stops, with two, and the boundary between them",
    "lure": "Lur'e's control system: a Hopf point, periodic orbits, and their period doublings",
    "isothermal": "Seydel's isothermal reaction: a Hopf point and a cascade of period doublings",
    "bratu": "Bratu's boundary-value problem through its fold",
];
