//! Periodic orbits of vector fields ([`PeriodicOrbit`]) and of hybrid systems ([`HybridOrbit`]) as
//! boundary-value problems; cycles of maps ([`MapCycle`]).
//!
//! The period of an orbit is a multiple of the forcing period, a function of the parameters.
//! Without forcing the period is an unknown, and the phase condition `∫ ⟨ẋ_ref, x − x_ref⟩ dτ = 0`
//! aligns the orbit with its predecessor on the branch. Branches start at Hopf points, at saved
//! orbits, or at stable orbits found by simulation ([`from_cycle`]).

mod accumulation;
mod decision_switching;
mod end_functions;
mod event_cascade;
mod grazing_names;
mod hybrid;
mod itinerary;
mod known_orbit;
mod legs;
mod map_cycle;
mod measures;
mod periodic;
mod reset_jumps;
mod same_surface_legs;
mod simulated;
mod smooth;
mod still;
mod switching;
mod timed_events;
mod touch;
mod touch_switching;
mod vanished_legs;

pub(in crate::core) use event_cascade::check_unmoved;
pub use hybrid::{HybridOrbit, IntoHybrid};
pub use itinerary::{Itinerary, ItineraryError, Leg};
pub(in crate::core) use known_orbit::KnownOrbit;
pub(in crate::core) use legs::OrbitLegs;
pub use map_cycle::MapCycle;
#[cfg(feature = "scene")]
pub(crate) use measures::GRAZINGS;
pub use periodic::{PeriodicOrbit, periodic_orbits};
pub use simulated::from_cycle;
pub use smooth::Smooth;
pub(in crate::core) use touch_switching::emanating_at_touch;
