//! Near grazing: discontinuity maps of any order.
//!
//! A periodic orbit grazes where it touches the surface `h = 0` of a guard that it does not pass.
//! On the section `Π` where motion is nearest to the surface, `dh/dt = 0`, motion near the orbit is
//! described by the map
//!
//! ```text
//!     P = P_smooth ∘ D
//! ```
//!
//! (A. B. Nordmark, *J. Sound Vib.* 145:279, 1991; M. di Bernardo et al., *Piecewise-smooth
//! Dynamical Systems*, 2008, chapter 6): `P_smooth` follows the orbit once around, as if the
//! surface were not there, and the discontinuity map `D` takes the **virtual** point of `Π`, at
//! which motion would arrive through the surface, to the point at which it comes to be in truth. Of
//! the **penetration** `−h` at a virtual point `D` is a function of the square root `y = √(−h)`
//! only, and analytic in it. Both maps are computed as Taylor polynomials in coordinates,
//! parameters and `y` on [jets](crate::core::scalar::Jet), from the code of the system itself;
//! `docs/concepts/grazing.md` explains how.
//!
//! A [`GrazingPoint`] says where an orbit touches; [`LocalMap`] is `P`, to be iterated,
//! differentiated and printed. It tells the scenario of the grazing ([`LocalMap::classified`]). A
//! [`LocalOrbit`] is the problem of its fixed and periodic
//! points, for continuation, and [`Iterated`] tells what motions settle on, by brute force.

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
