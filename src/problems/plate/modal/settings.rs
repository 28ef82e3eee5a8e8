//! What a modal model is made from.

use crate::problems::plate::discretisation::RitzSettings;
use crate::problems::plate::edges::Supports;
use crate::problems::plate::terms::Projection;

/// The largest number of modes: `A` has some N⁴/4 entries.
pub const MOST_MODES: usize = 40;

/// The settings of a [`Modal`](super::Modal).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ModalSettings {
    /// Supports, edges in the plane, theory, units, symmetry, and the aspect ratio of the plate,
    /// which is fixed. Without `orders` as many functions are taken as the modes need.
    pub plate: RitzSettings,
    /// Poisson's ratio of the plate, fixed as well.
    pub nu: f64,
    /// The number of modes, 1 to [`MOST_MODES`]: the lowest ones, of those that share the symmetry.
    pub modes: usize,
    /// Which projection.
    pub projection: Projection,
    /// The relative error allowed in each mode's `ω²`, 1e-12 to 0.1.
    pub mode_accuracy: f64,
}

impl ModalSettings {
    /// Eight modes of a square plate with `ν = 0.3`, in the direct projection, accurate to 1e-8, or
    /// to 1e-4 if some edge is free: where it meets a clamped one, or another free one, the modes
    /// have singularities that polynomials approach slowly.
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
