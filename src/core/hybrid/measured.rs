//! Whether the measures of a system name its scalars.

use super::erased::HybridEquations;
use crate::core::names::{UnknownName, distinct, position};

/// Refuses measures of scalars that a system does not have.
pub(crate) fn check_measures(system: &dyn HybridEquations) -> Result<(), UnknownName> {
    let (modes, monitors) = (system.modes(), system.monitors());
    let scalars = distinct(modes.iter().flat_map(|mode| &mode.states).chain(&monitors));
    for (name, measure) in system.measures() {
        let what = format!("state or monitor of the measure `{name}`");
        for scalar in measure.scalars() {
            position(&what, scalar, &scalars)?;
        }
    }
    Ok(())
}
