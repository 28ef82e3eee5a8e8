//! Periodic orbits of vector fields.
//!
//! A periodic orbit is the boundary-value problem
//!
//! ```text
//!     dx/dτ = T f(τT, x, p),    x(0) = x(1)
//! ```
//!
//! with `T` the period of the forcing, a function of the parameters, or, for an autonomous field, an
//! unknown, with a phase condition `∫ ⟨ẋ_ref, x − x_ref⟩ dτ = 0` that ties the orbit to its predecessor on
//! the branch. One description serves every discretisation: [`by_collocation`] and [`by_shooting`].
//!
//! Branches start at Hopf points, at saved orbits, or at stable orbits found by simulation
//! ([`from_cycle`]).

mod birth;
mod equations;
mod hybrid;
mod itinerary;
mod measures;
mod periodic;
mod smooth;

pub use hybrid::{HybridOrbit, IntoHybrid};
pub use itinerary::{Itinerary, ItineraryError, Leg};
pub use periodic::{by_collocation, by_shooting, from_cycle};
pub use smooth::Smooth;
