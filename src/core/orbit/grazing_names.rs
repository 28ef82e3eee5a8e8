//! Standard names of grazing bifurcations.

use super::decision_switching::decision_after;
use super::itinerary::Leg;
use super::known_orbit::KnownOrbit;
use super::measures::{APPROACH, DECISION, SHORTEST, SPACING};
use super::touch::{Touch, touches};
use super::vanished_legs::is_border_collision;
use crate::core::bvp::Monitor;
use crate::core::failure::Failure;
use crate::core::hybrid::Tangency;

/// The name of the grazing of an orbit that touches several surfaces in one period, such as a
/// symmetric orbit between two walls.
const DOUBLE: &str = "double grazing";

/// The name of the grazing at which two events are simultaneous, so that their order changes along
/// the branch.
const BORDER_COLLISION: &str = "border collision";

/// A grazing with its time and state.
type Place = (Tangency, f64, Vec<f64>);

/// Returns the standard name of the grazing at which a monitor vanishes.
pub(super) fn name_of_grazing(orbit: &KnownOrbit, monitor: &Monitor) -> Option<&'static str> {
    let mut several = false;
    let place = match *monitor {
        Monitor::Distance(_) => {
            let touches = touches(orbit).ok()?;
            several = touches.iter().any(|touch| touch.guard != touches[0].guard);
            touches.into_iter().next().map(|Touch { leg, guard, since, x, .. }| {
                let mode = orbit.legs.mode(leg);
                (Tangency::Touch { guard, mode }, orbit.begins(leg) + since, x)
            })
        }
        // Where a leg vanishes, the speed of its event is zero, and so is a decision.
        Monitor::Ends(function) => {
            vanished(orbit).or_else(|| at_event(orbit, function).ok().flatten())
        }
        _ => None,
    };
    let meets = matches!(monitor, Monitor::Ends(SHORTEST)) && is_border_collision(orbit);
    if meets || matches!(monitor, Monitor::Ends(SPACING)) {
        return Some(BORDER_COLLISION);
    }
    let (tangency, t, x) = place?;
    let kind = orbit.system().kind_of_tangency(tangency, t, &x, orbit.p());
    kind.or(several.then_some(DOUBLE))
}

/// Returns the time and state at the start of the first zero-length leg (part between two events)
/// of the orbit.
fn vanished(orbit: &KnownOrbit) -> Option<Place> {
    let (legs, count) = (orbit.legs, orbit.legs.all().len());
    let leg = (0..count).find(|leg| !orbit.lasts(*leg))?;
    let before = legs.mode((leg + count - 1) % count);
    let tangency = Tangency::Leg { before, mode: legs.mode(leg), after: legs.mode_after(leg) };
    Some((tangency, orbit.begins(leg), orbit.known[leg].start().to_vec()))
}

/// Returns the event with the smallest approach speed, or the event with the smallest decision
/// margin, depending on `function`.
fn at_event(orbit: &KnownOrbit, function: usize) -> Result<Option<Place>, Failure> {
    let mut least: Option<(f64, Place)> = None;
    for (leg, Leg { mode, exit, accumulates }) in orbit.legs.all().iter().copied().enumerate() {
        let Some(guard) = exit.filter(|_| !accumulates) else { continue };
        let (t, x) = orbit.end_of(leg)?;
        let (at, next) = (orbit.moment(leg, t, &x), orbit.legs.mode_after(leg));
        let (value, tangency) = match function {
            APPROACH => (Some(at.rate(guard)), Tangency::Slow { guard, mode, next }),
            DECISION => {
                let margin = decision_after(orbit.legs, leg).and_then(|it| it.margin(at));
                (margin, Tangency::Decision { guard, mode, next })
            }
            _ => continue,
        };
        let Some(value) = value.map(f64::abs) else { continue };
        if least.as_ref().is_none_or(|(known, _)| value < *known) {
            least = Some((value, (tangency, t, x)));
        }
    }
    Ok(least.map(|(_, place)| place))
}
