//! Runs that trace fixed and periodic points of a local map near a grazing.

use super::discretisation::{Discretisation, OnIntervals};
use super::expansion::{ExpansionCurve, ExpansionError, expanded};
use crate::core::bvp::{BoundarySystem, Mesh, Method};
use crate::core::continuation::{Branch, SpecialPoint};
use crate::core::failure::{Failure, one_line};
use crate::core::hybrid::{HybridEquations, guard_scale};
use crate::core::local_map::{GrazingError, GrazingPoint, LocalMap, LocalOrbit, MapSettings};
use crate::core::orbit::{HybridOrbit, Itinerary};
use crate::core::system::{Dense, Kind, System};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// The local map whose fixed or periodic points a run traces; it is the local map at a grazing that
/// an earlier run found. The order of the local map is the setting `order` of the problem.
///
/// The parameters of the local map are the parameters of the flow, so that branches of the map and
/// of the flow can be compared. For a local map, a run with the start `Rest` starts near the
/// grazing, and a run that starts from another run traces points of the same map.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Local {
    /// The name of the earlier run that found the grazing.
    pub run: String,
    /// The kind of the special point at which the map is built: a grazing on a branch, or a special
    /// point on a curve of grazings.
    pub kind: Kind,
    /// The index of this special point among the special points of its kind, in the order of the
    /// branch, counted from 0.
    #[serde(default)]
    pub nth: usize,
    /// The parameters in which the local map is expanded into a Taylor series. All other parameters
    /// of the local map have their values at the grazing.
    pub parameters: Vec<String>,
}

impl Local {
    /// Builds the local map of a hybrid system at a special point.
    pub(super) fn map(
        &self,
        system: &Arc<dyn HybridEquations>,
        discretisation: Discretisation,
        settings: MapSettings,
        (branch, special): (&Branch, &SpecialPoint),
    ) -> Result<LocalMap, GrazingError> {
        let OnIntervals { method, intervals } =
            discretisation.method().map_err(|cause| Failure::Mismatch(one_line(&cause)))?;
        let point = grazing_point(system, method, intervals, branch, special)?;
        touches(&**system, &point)?;
        let point = point.located(&**system, &self.parameters[0])?;
        let names: Vec<&str> = self.parameters.iter().map(String::as_str).collect();
        LocalMap::of(&**system, &point, &names, settings)
    }
}

/// Returns the system of equations for fixed or periodic points of a local map. Each entry of
/// `impacts` states whether one iterate passes through the surface of the impact; if `impacts` is
/// empty, the system describes fixed points without impact.
pub(super) fn points_of(map: LocalMap, impacts: &[bool]) -> Result<Box<dyn System>, GrazingError> {
    let impacts = if impacts.is_empty() { &[false] } else { impacts };
    let points = LocalOrbit::of(map, impacts).in_place().system();
    Ok(Box::new(points.map_err(Failure::from)?))
}

/// Returns the curve of special points of a given kind that emanates from the grazing of a local
/// map; the curve is a Taylor series in one of the map's two parameters.
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

/// A special point counts as a grazing if the absolute value of its guard function, in units of the
/// guard's scale, is at most this number.
const TOUCHES: f64 = 1e-6;

/// Returns an error if the guard function is not zero at a special point: the point is then not a
/// grazing, although a grazing may be near.
fn touches(system: &dyn HybridEquations, point: &GrazingPoint) -> Result<(), GrazingError> {
    let GrazingPoint { guard, mode, time, x, p, .. } = point;
    let value = system.guard(*guard, *mode, *time, x, p);
    let scale = guard_scale(system, (*guard, *mode), (*time, x), p);
    if value.abs() <= TOUCHES * scale {
        return Ok(());
    }
    let guard = system.guards().swap_remove(*guard).name;
    // The point is a minimum of the guard.
    Err(GrazingError::NoTouch { guard, time: *time, value, rate: 0.0 })
}

/// Returns the grazing orbit at a special point of a branch, or at a point of a curve of grazings.
fn grazing_point(
    system: &Arc<dyn HybridEquations>,
    method: Method,
    intervals: usize,
    branch: &Branch,
    special: &SpecialPoint,
) -> Result<GrazingPoint, GrazingError> {
    let orbit = HybridOrbit::of(system.clone(), Itinerary::smooth(0, 1))
        .map_err(|cause| Failure::Unsupported(one_line(&cause)))?;
    let mut orbits = BoundarySystem::new(orbit, method, vec![Mesh::uniform(intervals)])
        .map_err(Failure::from)?;
    GrazingPoint::at(&mut orbits, &branch.solution(special))
}
