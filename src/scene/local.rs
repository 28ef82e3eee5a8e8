//! Runs that follow fixed and periodic points of a local map near a grazing.

use super::discretisation::Discretisation;
use super::expansion::{ExpansionCurve, ExpansionError, expanded};
use crate::core::bvp::{BoundarySystem, Mesh, Method};
use crate::core::continuation::{Branch, SpecialPoint};
use crate::core::failure::Failure;
use crate::core::hybrid::{HybridEquations, guard_scale};
use crate::core::local_map::{GrazingError, GrazingPoint, LocalMap, LocalOrbit, MapSettings};
use crate::core::orbit::{HybridOrbit, Itinerary};
use crate::core::system::{Dense, Kind, System};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// The local map of which a run follows fixed or periodic points: that at a grazing which an
/// earlier run has found. Its order is a setting of the problem, `order`.
///
/// Parameters are those of the flow, so that branches lie beside its own. A run that starts at rest
/// starts near the grazing itself, and one that starts from another run follows points of the same
/// map.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Local {
    /// The earlier run.
    pub run: String,
    /// The kind of special point: a grazing of a branch, or a point on a curve of grazings.
    pub kind: Kind,
    /// Which one of that kind, in the order of the branch, from 0.
    #[serde(default)]
    pub nth: usize,
    /// The parameters in which the map is expanded. All others are those of the grazing.
    pub parameters: Vec<String>,
}

impl Local {
    /// The map of a system at a special point.
    pub(super) fn map(
        &self,
        system: &Arc<dyn HybridEquations>,
        discretisation: Discretisation,
        settings: MapSettings,
        (branch, special): (&Branch, &SpecialPoint),
    ) -> Result<LocalMap, GrazingError> {
        let (method, intervals) =
            discretisation.method().map_err(|cause| Failure::Mismatch(cause.to_string()))?;
        let point = grazing_point(system, method, intervals, branch, special)?;
        touches(&**system, &point)?;
        let point = point.located(&**system, &self.parameters[0])?;
        let names: Vec<&str> = self.parameters.iter().map(String::as_str).collect();
        LocalMap::of(&**system, &point, &names, settings)
    }
}

/// Points of a map each iterate of which goes through the surface, or does not; fixed points before
/// the surface, if nothing is said.
pub(super) fn points_of(map: LocalMap, impacts: &[bool]) -> Result<Box<dyn System>, GrazingError> {
    let impacts = if impacts.is_empty() { &[false] } else { impacts };
    let points = LocalOrbit::of(map, impacts).in_place().system();
    Ok(Box::new(points.map_err(Failure::from)?))
}

/// The curve of a kind of special points that begins at the grazing of a map, by its series in one
/// of its two parameters.
pub(super) fn series_of(
    map: &LocalMap,
    kind: Kind,
    free: &str,
) -> Result<Box<dyn System>, ExpansionError> {
    let (names, p) = (map.parameters(), map.origin().1);
    let second = names.iter().position(|name| name == free).unwrap_or(1);
    let order = [1 - second.min(1), second];
    let names = order.map(|k| names[k].clone());
    let expansion = expanded(map, kind, [&names[0], &names[1]])?;
    Ok(Box::new(Dense::new(ExpansionCurve { expansion, origin: order.map(|k| p[k]), names })))
}

/// A grazing as branches find it touches as closely as this, in units of the guard's scale.
const TOUCHES: f64 = 1e-6;

/// Refuses a point that is no grazing yet, though one may be near.
fn touches(system: &dyn HybridEquations, point: &GrazingPoint) -> Result<(), GrazingError> {
    let GrazingPoint { guard, mode, time, x, p, .. } = point;
    let value = system.guard(*guard, *mode, *time, x, p);
    let scale = guard_scale(system, (*guard, *mode), (*time, x), p);
    if value.abs() <= TOUCHES * scale {
        return Ok(());
    }
    let guard = system.guards().swap_remove(*guard).name;
    // The point is where the guard is least.
    Err(GrazingError::NoTouch { guard, time: *time, value, rate: 0.0 })
}

/// The grazing at a special point of a branch, or of a curve of grazings.
fn grazing_point(
    system: &Arc<dyn HybridEquations>,
    method: Method,
    intervals: usize,
    branch: &Branch,
    special: &SpecialPoint,
) -> Result<GrazingPoint, GrazingError> {
    let orbit = HybridOrbit::of(system.clone(), Itinerary::smooth(0, 1))
        .map_err(|cause| Failure::Unsupported(cause.to_string()))?;
    let mut orbits = BoundarySystem::new(orbit, method, vec![Mesh::uniform(intervals)])
        .map_err(Failure::from)?;
    GrazingPoint::at(&mut orbits, &branch.solution(special))
}
