//! Local maps near grazing orbits: discontinuity maps of any order.
//!
//! A periodic orbit grazes where it touches the surface `h = 0` of a guard without crossing it. On
//! the section `Π` where motion is closest to the surface, `dh/dt = 0`, motion near the orbit is
//! described by the map
//!
//! ```text
//!     P = P_smooth ∘ D
//! ```
//!
//! (A. B. Nordmark, *J. Sound Vib.* 145:279, 1991; M. di Bernardo et al., *Piecewise-smooth
//! Dynamical Systems*, 2008, chapter 6): `P_smooth` follows the orbit for one turn, ignoring the
//! surface, and the discontinuity map `D` takes the **virtual** point of `Π`, which motion would
//! reach through the surface, to the point from which the actual motion continues. With the
//! **penetration** `−h` at a virtual point, `D` depends on the square root `y = √(−h)` only, and is
//! analytic in it. Both maps are computed as Taylor polynomials in coordinates, parameters and `y`
//! on [jets](crate::core::scalar::Jet), from the equations of the system itself;
//! `docs/concepts/grazing.md` explains the method.
//!
//! A [`GrazingPoint`] is the point at which an orbit grazes a guard; [`LocalMap`] is `P`, which can
//! be iterated, differentiated and printed, and gives the scenario of the grazing
//! ([`LocalMap::classified`]). A [`LocalOrbit`] is the problem of its fixed and periodic points,
//! for continuation, and [`Iterated`] gives the attractors by brute force.

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
