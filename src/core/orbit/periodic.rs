//! Periodic orbits of vector fields, discretised.

use super::hybrid::{HybridOrbit, IntoHybrid};
use crate::core::bvp::{BoundaryError, BoundarySystem, Mesh, Method};
use crate::core::condition::Failure;
use crate::core::field::VectorField;
use crate::core::hybrid::Cycle;

/// The periodic orbits of a vector field on a number of intervals, over one period of its forcing.
///
/// ```
/// use tangency::core::bvp::{Collocation, Shooting};
/// use tangency::core::continuation::{Continuation, Kind};
/// use tangency::core::{dense::Dense, field::Equilibria, orbit::periodic_orbits};
/// use tangency::problems::{classic::Lure, mita::Block};
/// // A Hopf point of the equilibrium 0 …
/// let mut rest = Dense::new(Equilibria(Lure));
/// let branch = Continuation::of(&mut rest)
///     .at("alpha", 1.2)
///     .at("beta", 1.0)
///     .along("alpha", 0.5..=1.5)
///     .trace()?;
/// let hopf = branch.of_kind(Kind::HB).next().unwrap().label;
/// // … and the orbits that are born there, until they double their period.
/// let mut orbits = periodic_orbits(Lure, 20, Collocation::new(4)?)?;
/// let branch =
///     Continuation::of(&mut orbits).restart(&branch, hopf).along("alpha", 0.6..=1.5).trace()?;
/// let doubling = branch.of_kind(Kind::PD).next().unwrap();
/// assert!((doubling.parameters[0] - 0.630302006160).abs() < 1e-9);
/// assert!((doubling.monitors[0] - 6.3640713394).abs() < 1e-9);
/// // The forced block, from near rest to the fold of its vibrations.
/// let mut orbits = periodic_orbits(Block, 1, Shooting::default())?;
/// let branch = Continuation::of(&mut orbits)
///     .at("voltage", 0.01)
///     .at("frequency", 0.45)
///     .at("damping", 0.04)
///     .along("voltage", 0.01..=0.5)
///     .bound("max_displacement", 0.0..=0.5)
///     .trace()?;
/// let fold = branch.of_kind(Kind::LP).next().unwrap();
/// assert!((fold.parameters[0] - 0.235565433583).abs() < 1e-11);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`BoundaryError`] if the field has no states, or there is no interval.
pub fn periodic_orbits(
    field: impl VectorField + 'static,
    intervals: usize,
    method: impl Into<Method>,
) -> Result<BoundarySystem, BoundaryError> {
    if intervals == 0 {
        return Err(BoundaryError::NoIntervals(0));
    }
    let orbit = HybridOrbit::smooth_of(field, 1);
    BoundarySystem::new(orbit, method, vec![Mesh::uniform(intervals)])
}

/// The periodic orbits of a system with the itinerary of a simulated cycle, on a number of
/// intervals for each leg, and the unknowns `z` of that cycle, from which a branch starts.
///
/// The system is smooth or hybrid, autonomous or forced; a vector field is wrapped in
/// [`Smooth`](super::Smooth).
///
/// ```
/// use tangency::core::bvp::Collocation;
/// use tangency::core::continuation::{Continuation, Kind};
/// use tangency::core::hybrid::{CycleSearch, HybridFlow, HybridSettings, HybridState};
/// use tangency::core::orbit::{Smooth, from_cycle};
/// use tangency::problems::classic::Lure;
/// let (p, start) = ([0.8, 1.0], HybridState { mode: 0, time: 0.0, x: vec![0.1, 0.0, 0.0] });
/// let mut flow = HybridFlow::new(&Smooth(Lure), HybridSettings::default())?;
/// let cycle = CycleSearch::default().find(&mut flow, start, &p)?;
/// let (mut orbits, z) = from_cycle(Smooth(Lure), &cycle, &p, Collocation::new(4)?, 20)?;
/// let branch = Continuation::of(&mut orbits)
///     .from(&z)
///     .at("alpha", 0.8)
///     .at("beta", 1.0)
///     .along("alpha", 0.6..=0.85)
///     .trace()?;
/// // Stable orbits, as far as their period doubling.
/// let doubling = branch.of_kind(Kind::PD).next().unwrap();
/// assert!((doubling.parameters[0] - 0.630302006160).abs() < 1e-9);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`Failure`] if the cycle contains an accumulation of events, if there is no interval, or if a
/// leg leaves the domain of its field.
pub fn from_cycle(
    system: impl IntoHybrid,
    cycle: &Cycle,
    p: &[f64],
    method: impl Into<Method>,
    intervals: usize,
) -> Result<(BoundarySystem, Vec<f64>), Failure> {
    HybridOrbit::of_cycle(system, cycle)?.discretised(p, method, intervals)
}
