//! The domain of the equations of a plate, which is the same for all models of plates: checks of
//! parameters and deflections.

use super::parameters::{Parameters, Units};
use crate::core::failure::{Failure, OutOfDomain};

/// Returns the parameters of the equations, after checking them. Returns an error for parameters
/// that are not finite, quantities of a device that are not positive, `α ≤ 0`, `d/h < 0`, and `ν`
/// outside of the range from −1 to ½.
pub(super) fn parameters(units: Units, p: &[f64]) -> Result<Parameters<f64>, OutOfDomain> {
    for (name, value) in units.names().iter().zip(p) {
        let positive = matches!(
            *name,
            "length" | "width" | "thickness" | "gap" | "young" | "density" | "permittivity"
        );
        if !value.is_finite() {
            return Err(OutOfDomain::new(*name, *value, "every parameter must be finite"));
        }
        if positive && *value <= 0.0 {
            return Err(OutOfDomain::new(*name, *value, "choose a positive value"));
        }
    }
    let plate = units.parameters(p);
    if !(plate.aspect > 0.0 && plate.aspect.is_finite()) {
        let remedy = "the ratio of the plate's sides must be positive and finite";
        return Err(OutOfDomain::new("aspect", plate.aspect, remedy));
    }
    not_negative("gap_ratio", plate.gap_ratio)?;
    if !(plate.nu > -1.0 && plate.nu < 0.5) {
        return Err(OutOfDomain::new("nu", plate.nu, "Poisson's ratio must be between −1 and ½"));
    }
    Ok(plate)
}

/// Returns an error if a ratio of two quantities is negative or not finite.
pub(super) fn not_negative(name: &str, ratio: f64) -> Result<(), OutOfDomain> {
    match ratio >= 0.0 && ratio.is_finite() {
        true => Ok(()),
        false => Err(OutOfDomain::new(
            name,
            ratio,
            "choose a finite positive value or 0 for this \
                                                    ratio",
        )),
    }
}

/// Returns an error if the largest deflection, relative to the gap, is NaN or at least `limit`.
pub(super) fn clear(largest: f64, limit: f64) -> Result<(), OutOfDomain> {
    if largest < limit {
        return Ok(());
    }
    let remedy = format!(
        "the largest deflection must stay below {limit} of the gap, clear of the electrode; end \
         the branch earlier"
    );
    Err(OutOfDomain::new("max_deflection", largest, remedy))
}

/// Returns an error if an entry of a list is not finite; `name` gives the name of the entry at a
/// position.
pub(super) fn finite(entries: &[f64], name: impl Fn(usize) -> String) -> Result<(), Failure> {
    match entries.iter().position(|entry| !entry.is_finite()) {
        Some(i) => {
            let remedy = "the unknowns and parameters must be small enough for the equations to \
                          have finite values";
            Err(Failure::not_finite(name(i), entries[i], remedy))
        }
        None => Ok(()),
    }
}
