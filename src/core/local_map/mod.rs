//! Local maps near grazing orbits: discontinuity maps of any order.
//!
//! A periodic orbit grazes if it touches the surface `h = 0` of a guard without crossing the
//! surface. The section `Π`, defined by `dh/dt = 0`, contains the points at which motion is closest
//! to the surface. A map `P` of the section describes the motion near the orbit:
//!
//! ```text
//!     P = P_smooth ∘ D
//! ```
//!
//! The section and the two maps are described by A. B. Nordmark (*J. Sound Vib.* 145:279, 1991) and
//! by M. di Bernardo et al. (*Piecewise-smooth Dynamical Systems*, 2008, chapter 6). The smooth map
//! `P_smooth` follows the orbit for one turn and ignores the surface. The discontinuity map `D`
//! maps the **virtual** point of `Π`, which motion would reach if the surface were absent, to the
//! point from which the actual motion continues. The **penetration** at a virtual point is `−h`;
//! `D` depends on the penetration only through its square root `y = √(−h)`, and is analytic in `y`.
//! Both maps are computed as Taylor polynomials in coordinates, parameters and `y` with
//! [jets](crate::core::scalar::Jet), from the equations of the system itself;
//! `docs/concepts/grazing.md` explains the method.
//!
//! A [`GrazingPoint`] is the point at which an orbit grazes a guard; [`LocalMap`] is the map `P`,
//! which can be iterated, differentiated and printed, and which determines the scenario of the
//! grazing ([`LocalMap::classified`]). A [`LocalOrbit`] is the continuation problem for fixed and
//! periodic points of the local map, and [`Iterated`] finds the attractors of the map by iteration.

mod chart;
mod discrete;
mod error;
mod iterated;
mod iteration;
mod locate;
mod map;
mod maps;
mod orbit;
mod point;
mod scenario;
mod section;
mod touch;

pub use chart::MapSettings;
pub use error::GrazingError;
pub use iterated::Iterated;
pub use iteration::Iteration;
pub use map::{LocalMap, PHASE};
pub use orbit::LocalOrbit;
pub use point::GrazingPoint;
pub use scenario::{Classification, Scenario};
