//! Electrically actuated rectangular microplates: von Kármán's theory, several models.

mod assembly;
pub mod basis;
mod edges;
mod error;
mod frequency;
mod membrane_form;
mod model;
mod orders;
mod parameters;
mod plane;
mod residual;
mod ritz;
mod settings;
mod shape;
pub mod sine;
pub mod strip;
mod system;
pub mod tensor;

pub use edges::{InPlane, Support, Supports};
pub use error::PlateError;
pub use frequency::{Modes, signed_root};
pub use membrane_form::{Field, MembraneForm};
pub use model::{RitzSettings, Theory};
pub use orders::Orders;
pub use parameters::{Parameters, Units};
pub use ritz::Ritz;
pub use settings::{Model, PlateSettings, Projection, SettingsError};
