//! The monitors common to all models of a plate, in one order and by one convention. See [the
//! list](super#monitors).

use super::parameters::Units;
use crate::core::problem::Names;
use crate::core::scalar::Scalar;

/// The monitor names common to plates and strips, in order.
pub(super) const MONITORS: [&str; 4] =
    ["deflection", "max_deflection", "frequency", "frequency_ratio"];

/// Returns the names of a plate with the given number of unknowns `w`.
pub(super) fn names(units: Units, unknowns: usize) -> Names {
    let displacement = (units == Units::Device).then_some("displacement");
    Names::new([("w", unknowns)], units.names().iter().copied())
        .with_monitors(MONITORS.into_iter().chain(displacement))
}

/// Computes the monitors from the two deflections over the gap, and from the dimensionless lowest
/// frequencies of the plate and of the flat plate.
pub(super) fn fill<T: Scalar>(
    units: Units,
    p: &[T],
    deflections: [T; 2],
    [frequency, flat]: [T; 2],
    values: &mut [T],
) {
    values[..2].copy_from_slice(&deflections);
    values[2] = frequency * units.frequency_unit(p);
    values[3] = frequency / flat;
    if let Some(gap) = units.gap() {
        values[4] = p[gap] * deflections[0];
    }
}
