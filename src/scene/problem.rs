//! The problems that a scene can name.

use super::SceneError;
use super::set::assign;
use crate::core::zero::System;
use crate::problems::plate::{PlateSettings, Units};
use serde::{Deserialize, Serialize};

/// A problem with its terms.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Problem {
    /// An electrically actuated microplate.
    Plate(PlateSettings),
}

impl Problem {
    /// Names of the parameters and their default values.
    pub fn parameters(&self) -> Vec<(&'static str, f64)> {
        match self {
            Problem::Plate(plate) => {
                let units: Units = plate.units;
                units.names().iter().copied().zip(units.defaults().iter().copied()).collect()
            }
        }
    }

    /// Names of the settings, and their values as they are written.
    pub fn settings(&self) -> Vec<(&'static str, String)> {
        match self {
            Problem::Plate(plate) => {
                let written = |value: &dyn erased::Written| value.written();
                vec![
                    ("supports", plate.supports.clone()),
                    ("in_plane", plate.in_plane.as_ref().map_or("usual".into(), |v| written(v))),
                    ("theory", written(&plate.theory)),
                    ("model", written(&plate.model)),
                    ("modes", plate.modes.to_string()),
                    ("projection", written(&plate.projection)),
                    ("orders", plate.orders.as_ref().map_or("usual".into(), |v| written(v))),
                    ("units", written(&plate.units)),
                    ("symmetric", plate.symmetric.map_or("usual".into(), |v| v.to_string())),
                ]
            }
        }
    }

    /// Sets one setting by name; false if there is none of this name.
    pub(super) fn set(&mut self, name: &str, value: &str) -> Result<bool, SceneError> {
        match self {
            Problem::Plate(plate) => {
                match name {
                    "supports" => plate.supports = value.to_uppercase(),
                    "in_plane" => plate.in_plane = usual_or(name, value)?,
                    "theory" => assign(&mut plate.theory, name, value)?,
                    "model" => assign(&mut plate.model, name, value)?,
                    "modes" => assign(&mut plate.modes, name, value)?,
                    "projection" => assign(&mut plate.projection, name, value)?,
                    "orders" => plate.orders = usual_or(name, value)?,
                    "units" => assign(&mut plate.units, name, value)?,
                    "symmetric" => plate.symmetric = usual_or(name, value)?,
                    _ => return Ok(false),
                }
                Ok(true)
            }
        }
    }

    /// The system for parameters that begin at `p`; `reach` lists for each of them how far it goes
    /// from there.
    pub(super) fn system(&self, p: &[f64], reach: &[f64]) -> Result<Box<dyn System>, SceneError> {
        match self {
            Problem::Plate(plate) => Ok(plate.system(p, reach)?),
        }
    }
}

/// `usual` stands for what the problem chooses by itself.
fn usual_or<T: for<'a> Deserialize<'a>>(name: &str, value: &str) -> Result<Option<T>, SceneError> {
    match value {
        "usual" => Ok(None),
        _ => super::set::read(name, value).map(Some),
    }
}

mod erased {
    /// A value as RON writes it.
    pub trait Written {
        fn written(&self) -> String;
    }

    impl<T: serde::Serialize> Written for T {
        fn written(&self) -> String {
            // Settings are plain enums, numbers and lists: they can always be written.
            ron::to_string(self).unwrap_or_default()
        }
    }
}
