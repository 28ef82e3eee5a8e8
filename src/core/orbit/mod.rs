//! Computes periodic orbits of vector fields and hybrid systems, and cycles of maps.
//!
//! Orbits of vector fields ([`PeriodicOrbit`]) and of hybrid systems ([`HybridOrbit`]) are
//! boundary-value problems; the cycles of maps ([`MapCycle`]) are zero problems.
//!
//! In a forced system, the period of an orbit is a multiple of the forcing period, which is a
//! function of the parameters. Without forcing the period is an unknown, and the phase condition `∫
//! ⟨ẋ_ref, x − x_ref⟩ dτ = 0` aligns the orbit with its predecessor on the branch (E. J. Doedel, H.
//! B. Keller and J. P. Kernévez, *International Journal of Bifurcation and Chaos* 1:745, 1991).
//! Branches start at Hopf points, at saved orbits, or at stable orbits found by simulation
//! ([`from_cycle`]).
//!
//! ```
//! use std::f64::consts::TAU;
//! use tangency::prelude::*;
//! vector_field! {
//!     /// A linear oscillator under a force, `x'' + 0.5 x' + x = cos ωt`.
//!     struct Oscillator [x, v; omega = 0.5; t] {
//!         d/dt x = v; d/dt v = (omega * t).cos() - x - v * 0.5;
//!         period = omega.recip() * TAU;
//!     }
//! }
//! let mut orbits = periodic_orbits(Oscillator, 10, Collocation::new(4)?)?;
//! let start = Continuation::new(&mut orbits).at("omega", 0.5);
//! let branch = start.along("omega", 0.5..=1.5).mark("omega", 1.0).trace()?;
//! let resonance = branch.of_kind(Kind::UZ).next().expect("an orbit at ω = 1");
//! let amplitude = branch.column("max_x").and_then(|column| resonance.value(column));
//! assert!((amplitude.expect("an amplitude") - 2.0).abs() < 1e-6); // 1/(0.5 ω)
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

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
mod repeated;
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
