//! The settings of a modal model of a plate.

use crate::problems::plate::discretisation::RitzSettings;
use crate::problems::plate::edges::Supports;
use crate::problems::plate::terms::Projection;

/// The largest number of modes; it is limited because the matrix `A` of the stretching energy
/// contains about N⁴/4 entries.
pub const MOST_MODES: usize = 40;

/// The settings of a [`Modal`](super::Modal) model of a plate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ModalSettings {
    /// The settings of the plate: supports against deflection, in-plane supports, theory, units,
    /// symmetry, and the fixed aspect ratio. By default, the setting `orders` contains as many
    /// basis functions as are necessary to resolve the modes.
    pub plate: RitzSettings,
    /// The fixed Poisson's ratio of the plate.
    pub nu: f64,
    /// The number of modes, from 1 to [`MOST_MODES`]; the model uses the lowest modes that have the
    /// symmetry of the plate.
    pub modes: usize,
    /// The projection.
    pub projection: Projection,
    /// The allowed relative error of the squared frequency `ω²` of each mode, from 1e-12 to 0.1.
    pub mode_accuracy: f64,
}

impl ModalSettings {
    /// Creates the settings for eight modes of a square plate with Poisson's ratio `ν = 0.3`, with
    /// the direct projection. The modes are accurate to 1e-8, or to 1e-4 if at least one edge is
    /// free: at a corner between a free edge and a clamped or another free edge, the modes have
    /// singularities that polynomials approximate slowly.
    pub fn new(supports: Supports) -> ModalSettings {
        ModalSettings {
            plate: RitzSettings::new(supports),
            nu: 0.3,
            modes: 8,
            projection: Projection::Direct,
            mode_accuracy: if supports.any_free() { 1e-4 } else { 1e-8 },
        }
    }
}
