//! The settings of a plate in a scene: the plate itself, and the model that discretises it.

use super::discretisation::RitzSettings;
use super::edges::{InPlane, Support, Supports};
use super::error::PlateError;
use super::modal::{Modal, ModalSettings};
use super::orders::Orders;
use super::parameters::Units;
use super::ritz::Ritz;
use super::sine::{SinePlate, SineSettings};
use super::terms::{Projection, Theory};
use crate::core::system::{Dense, System};
use serde::{Deserialize, Deserializer, Serialize};

/// The model that discretises the plate.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Model {
    /// The full Ritz model, in beam modes expanded in integrated Legendre functions.
    #[default]
    Ritz,
    /// A reduced-order model in the lowest modes of the flat plate.
    Modal,
    /// The stress-function model in sines of a simply supported plate (section 3.2).
    Sine,
}

/// The settings of a plate and of its model.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct PlateSettings {
    /// The supports of the edges in the order x = 0, y = 0, x = 1, y = 1: `S` simply supported, `C`
    /// clamped, `F` free.
    #[serde(deserialize_with = "capitals")]
    pub supports: String,
    /// The in-plane supports; by default `slide` for four simply supported edges, otherwise
    /// `immovable`.
    pub in_plane: Option<InPlane>,
    /// The theory of the plate: linear theory, or von Kármán's theory.
    pub theory: Theory,
    /// The discretisation.
    pub model: Model,
    /// The number of modes that the models `modal` and `sine` use.
    pub modes: usize,
    /// The projection of the equation of motion that the models `modal` and `sine` use.
    pub projection: Projection,
    /// The numbers of basis functions of the model `ritz`; by default the numbers that the accuracy
    /// requires.
    pub orders: Option<Orders>,
    /// The units and the meaning of the parameters.
    pub units: Units,
    /// Whether to use the symmetry of a plate in directions in which the two opposite edges have
    /// the same support. By default, the symmetry is used unless edge forces act: a compressed
    /// plate may first buckle into two half waves, which are not symmetric.
    pub symmetric: Option<bool>,
}

/// Deserializes the letters of the supports, in upper or lower case.
fn capitals<'de, D: Deserializer<'de>>(deserializer: D) -> Result<String, D::Error> {
    Ok(String::deserialize(deserializer)?.to_uppercase())
}

impl Default for PlateSettings {
    fn default() -> Self {
        PlateSettings {
            supports: "SSSS".into(),
            in_plane: None,
            theory: Theory::VonKarman,
            model: Model::Ritz,
            modes: 15,
            projection: Projection::Direct,
            orders: None,
            units: Units::Dimensionless,
            symmetric: None,
        }
    }
}

/// A sequence of increasing numbers of modes; each number is about a third larger than the previous
/// number.
const MODES: [usize; 11] = [1, 2, 3, 4, 6, 8, 11, 15, 20, 27, 36];

impl PlateSettings {
    /// Returns the system of equations of a plate; its parameters start at the values `p`, in the
    /// order of [`Units::names`], and vary up to the values `reach`.
    ///
    /// # Errors
    /// A [`PlateError`] that names the invalid setting and the remedy.
    ///
    /// ```
    /// use tangency::problems::plate::{PlateSettings, Units};
    /// let settings = PlateSettings { supports: "CCCC".into(), ..PlateSettings::default() };
    /// let system = settings.system(Units::Dimensionless.defaults(), Units::Dimensionless.defaults())?;
    /// assert_eq!(system.names().parameters[0], "load");
    /// # Ok::<(), tangency::problems::plate::PlateError>(())
    /// ```
    pub fn system(&self, p: &[f64], reach: &[f64]) -> Result<Box<dyn System>, PlateError> {
        let plate = self.plate(p, reach)?;
        let parameters = self.units.parameters(p);
        match self.model {
            Model::Ritz => Ok(Box::new(Ritz::new(plate)?)),
            Model::Modal => {
                let aspect = parameters.aspect;
                self.modal(RitzSettings { aspect, ..plate }, parameters.nu)
            }
            Model::Sine => self.sine(plate),
        }
    }

    /// Returns the full model of the plate.
    fn plate(&self, p: &[f64], reach: &[f64]) -> Result<RitzSettings, PlateError> {
        let supports: Supports = self.supports.parse()?;
        let [parameters, farthest] = [p, reach].map(|p| self.units.parameters(p));
        let compressed = [parameters, farthest]
            .iter()
            .any(|plate| [plate.compression_x, plate.compression_y, plate.shear] != [0.0; 3]);
        Ok(RitzSettings {
            supports,
            in_plane: self.in_plane.unwrap_or(supports.usual_in_plane()),
            theory: self.theory,
            orders: self.orders,
            aspect: farthest.aspect,
            units: self.units,
            symmetric: self.symmetric.unwrap_or(!compressed),
        })
    }

    /// Returns copies of the settings with growing accuracy and cost, which differ in the numbers
    /// of basis functions of the full model, or in the numbers of modes of the other models. The
    /// arguments have the same meaning as for [`system`](Self::system).
    ///
    /// # Errors
    /// [`PlateError`] if the letters of the supports cannot be parsed.
    ///
    /// ```
    /// use tangency::problems::plate::{Orders, PlateSettings, Units};
    /// let p = Units::Dimensionless.defaults();
    /// let ladder = PlateSettings::default().ladder(p, p)?;
    /// assert_eq!(ladder[0].orders, Some(Orders { transverse: [2, 2], in_plane: [3, 3] }));
    /// // By default branches are traced with the fifth of these discretisations.
    /// assert_eq!(ladder[4].orders, Some(Orders::usual([true, true], 1.0)));
    /// # Ok::<(), tangency::problems::plate::PlateError>(())
    /// ```
    pub fn ladder(&self, p: &[f64], reach: &[f64]) -> Result<Vec<PlateSettings>, PlateError> {
        let with_modes = |modes| PlateSettings { modes, ..self.clone() };
        let with_orders = |orders| PlateSettings { orders: Some(orders), ..self.clone() };
        Ok(match self.model {
            Model::Ritz => {
                let plate = self.plate(p, reach)?;
                let orders = Orders::ladder(plate.symmetries(), plate.aspect);
                orders.into_iter().map(with_orders).collect()
            }
            Model::Modal | Model::Sine => MODES.map(with_modes).into(),
        })
    }

    fn modal(&self, plate: RitzSettings, nu: f64) -> Result<Box<dyn System>, PlateError> {
        let settings = ModalSettings {
            plate,
            nu,
            modes: self.modes,
            projection: self.projection,
            ..ModalSettings::new(plate.supports)
        };
        Ok(Box::new(Modal::new(settings)?.into_system()))
    }

    fn sine(&self, plate: RitzSettings) -> Result<Box<dyn System>, PlateError> {
        if plate.supports != Supports([Support::SimplySupported; 4]) {
            let supports = plate.supports.to_string();
            return Err(PlateError::SineSupports { supports });
        }
        let settings = SineSettings {
            modes: self.modes,
            in_plane: plate.in_plane,
            theory: plate.theory,
            projection: self.projection,
            units: self.units,
            quadrature_points: None,
        };
        Ok(Box::new(Dense::new(SinePlate::new(settings)?)))
    }
}
