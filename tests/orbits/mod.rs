//! Promises of boundary-value problems and smooth periodic orbits.

pub mod boundary;
mod boundary_curves;
mod boundary_values;
mod collocation;
mod curves;
pub mod cycles;
mod failures;
pub mod map_cycles;
mod map_manifolds;
mod measures;
mod multipliers;
mod own_discretisation;
mod periodic_orbits;
mod phase_response;
mod shapes;
mod shooting;
mod simulation;
mod slow_fast;
