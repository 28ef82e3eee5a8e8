//! Admissibility of solutions, and branch switching at the limits of admissible solutions. No other
//! module of continuation uses the interface of systems for orbits with events.

use super::event::Event;
use crate::core::bifurcation::Quantity;
use crate::core::failure::Failure;
use crate::core::system::{Emanating, Kind, Limit, System};

/// The kind of special points at limits of admissible solutions: points at which a monitor vanishes
/// that is positive at admissible solutions.
pub(super) const AT_LIMIT: Kind = Kind::G;

/// Discretisation: the monitor that vanishes at a limit of admissible solutions counts as zero at
/// the start of a branch if it is smaller than this threshold, in units of its scale. A saved point
/// at a limit of admissible solutions is accurate to rounding on its own mesh; after interpolation
/// to another mesh, the point is only accurate to the discretisation error of the coarser mesh.
const VANISHES: f64 = 1e-6;

/// Rounding: a solution is not admissible if it gives a negative value to a monitor that vanishes
/// at a limit of admissible solutions, and if the absolute value exceeds this threshold, in units
/// of the monitor's scale; computed points have an error of 1e-10.
const BEYOND: f64 = 1e-9;

/// Returns the limits of the admissible solutions at the parameters `p`; empty if the solutions of
/// the system have no events.
pub(super) fn limits(system: &mut dyn System, p: &[f64]) -> Vec<Limit> {
    system.events().map_or_else(Vec::new, |events| events.limits(p))
}

/// Returns the threshold below which the monitor that vanishes at a limit of admissible solutions
/// counts as zero.
pub(super) fn zero(system: &mut dyn System, p: &[f64], monitor: usize) -> f64 {
    let limit = limits(system, p).into_iter().find(|limit| limit.monitor == monitor);
    VANISHES * limit.map_or(1.0, |limit| limit.scale)
}

/// Divides the monitors that vanish at limits of admissible solutions into two lists: the monitors
/// that vanish at the given solution, and all other monitors. The monitors of several limits of
/// admissible solutions vanish at the same solution if an event of an orbit coincides with a
/// segment of zero length.
pub(super) fn divided(
    system: &mut dyn System,
    x: &[f64],
) -> Result<(Vec<usize>, Vec<usize>), Failure> {
    let (n, count) = (system.names().dimension(), system.names().monitors.len());
    let mut values = vec![0.0; count];
    system.monitors(x, 0, &mut values)?;
    let limits = limits(system, &x[n..]).into_iter();
    let (vanishing, others): (Vec<Limit>, Vec<Limit>) =
        limits.partition(|limit| values[limit.monitor].abs() < VANISHES * limit.scale);
    let monitors = |limits: Vec<Limit>| limits.iter().map(|limit| limit.monitor).collect();
    Ok((monitors(vanishing), monitors(others)))
}

/// Whether all monitors that vanish at limits of admissible solutions are larger than a given
/// fraction of their scales.
fn are_above(limits: &[Limit], monitors: &[f64], part: f64) -> bool {
    !limits.iter().any(|limit| monitors[limit.monitor] < part * limit.scale)
}

/// Whether a solution is admissible, up to the numerical error of computed points: no monitor that
/// vanishes at a limit of admissible solutions is negative.
pub(super) fn is_within(system: &mut dyn System, p: &[f64], monitors: &[f64]) -> bool {
    are_above(&limits(system, p), monitors, -BEYOND)
}

/// Whether the solution at an end of a branch is admissible. Where a branch ends at a limit of
/// admissible solutions, a symmetric orbit also reaches a second limit. The monitor of the second
/// limit has a double root there, so that the error of the monitor is the square root of the
/// rounding error.
pub(super) fn is_within_at_end(
    system: &mut dyn System,
    kind: Kind,
    p: &[f64],
    monitors: &[f64],
) -> bool {
    let beyond = if kind == AT_LIMIT { VANISHES } else { BEYOND };
    are_above(&limits(system, p), monitors, -beyond)
}

/// Whether an event marks a limit of admissible solutions and its monitor vanishes at both of two
/// given solutions, up to the numerical error of computed points. The signs of the monitor at these
/// solutions are then random.
pub(super) fn stays_at_limit(
    system: &mut dyn System,
    p: &[f64],
    event: &Event,
    values: [Option<f64>; 2],
) -> bool {
    let (AT_LIMIT, Some((Quantity::Monitor(monitor), _))) = (event.kind, event.test.level()) else {
        return false;
    };
    let limit = limits(system, p).into_iter().find(|limit| limit.monitor == monitor);
    let vanishes = |value: &f64| limit.is_some_and(|limit| value.abs() <= BEYOND * limit.scale);
    values.iter().all(|value| value.as_ref().is_some_and(vanishes))
}

/// Checks the order of events of a solution `x = (z, p)`. At a limit of admissible solutions, the
/// order of events is undetermined and is not checked.
///
/// # Errors
/// [`Failure::Mismatch`] with the name of an event, if this event of the solution leads to another
/// mode than the itinerary prescribes.
pub(super) fn check(system: &mut dyn System, x: &[f64], monitors: &[f64]) -> Result<(), Failure> {
    let p = &x[system.names().dimension()..];
    match system.events() {
        Some(events) if are_above(&events.limits(p), monitors, VANISHES) => events.check(x),
        _ => Ok(()),
    }
}

/// Returns the branch with the index `which`, counted from 0, among the branches that emanate at a
/// limit of admissible solutions; `None` for systems without events.
pub(super) fn emanating(
    system: &mut dyn System,
    x: &[f64],
    which: usize,
) -> Result<Option<Emanating>, Failure> {
    system.events().map(|events| events.emanating(x, which)).transpose()
}

/// Returns the standard name of a solution `x = (z, p)` at an event, if the event is a limit of
/// admissible solutions.
pub(super) fn subkind(event: &Event, system: &mut dyn System, x: &[f64]) -> Option<String> {
    match (event.kind, event.test.level()?) {
        (AT_LIMIT, (Quantity::Monitor(monitor), _)) => {
            Some(system.events()?.name_of_limit(monitor, x)?.into())
        }
        _ => None,
    }
}
