//! The monitors that all models of a plate share, with the same order and the same definitions. See
//! [the list](super#monitors).

use super::parameters::Units;
use crate::core::problem::Names;
use crate::core::scalar::Scalar;

/// The names of the monitors that plates and strips share, in order.
pub(super) const MONITORS: [&str; 4] =
    ["deflection", "max_deflection", "frequency", "frequency_ratio"];

/// Returns the names of the unknowns, parameters and monitors of a plate with the given number of
/// unknowns `w`.
pub(super) fn names(units: Units, unknowns: usize) -> Names {
    let displacement = (units == Units::Device).then_some("displacement");
    Names::new([("w", unknowns)], units.names().iter().copied())
        .with_monitors(MONITORS.into_iter().chain(displacement))
}

/// Computes the monitors of a plate from two deflections relative to the gap (at the centre, and
/// the largest), and from the lowest dimensionless frequencies of the deflected plate and of the
/// flat plate.
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
