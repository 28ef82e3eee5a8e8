//! Near grazing: discontinuity maps of any order.
//!
//! A periodic orbit grazes where it touches the surface `h = 0` of a guard that it does not pass. Let
//!
//! ```text
//!     Π = { (t, x) : dh/dt = 0 },      dh/dt = h_t + h_x f,      d²h/dt² = a > 0,
//! ```
//!
//! be the section on which the motion of the touched mode `f` is nearest to the surface. Motion near the
//! orbit is told by the map from `Π` to `Π` which is the composition
//!
//! ```text
//!     P = P_smooth ∘ D
//! ```
//!
//! of two maps (A. B. Nordmark, *J. Sound Vib.* 145:279, 1991; M. di Bernardo et al., *Piecewise-smooth
//! Dynamical Systems*, 2008, chapter 6, where `D` is the Poincaré-section discontinuity map):
//!
//! - `P_smooth` follows the orbit once around, as if the surface were not there;
//! - `D` takes the **virtual** point of `Π`, at which motion would arrive through the surface, to the point
//!   at which it comes to be in truth: back from `Π` to the surface, through the event there and those that
//!   follow at once, and on, forward or backward in time, to `Π`. Where `h ≥ 0`, `D` changes nothing.
//!
//! Of the **penetration** `−h` at a virtual point the map `D` is a function of the square root only, `y =
//! √(−h)`. With `y` in place of one coordinate it is analytic: the time from the surface is `τ = y σ`, where
//! `σ` solves
//!
//! ```text
//!     G(σ) = h(φ_{−yσ})/y² = −1 + a σ²/2 + O(y) = 0,      σ = √(2/a) + O(y),
//! ```
//!
//! and all further times are those at which a guard is passed with a speed. Both maps are computed as Taylor
//! polynomials in coordinates, parameters and `y` on [jets](crate::core::jet), from the code of the system
//! itself: nothing is derived for a device.
//!
//! A [`GrazingPoint`] says where an orbit touches; [`LocalMap`] is `P`, to be iterated, differentiated and
//! printed. It tells the scenario of the grazing ([`LocalMap::classified`]), and at points of codimension two
//! the series of the curves of folds and period doublings that begin there ([`LocalMap::expanded`]). A
//! [`LocalOrbit`] is the problem of its fixed and periodic points, for continuation, and [`Iterated`] tells what
//! motions settle on, by brute force.

mod chart;
mod error;
mod expansion;
mod iterated;
mod iteration;
mod locate;
mod map;
mod maps;
mod orbit;
mod point;
mod scenario;
mod section;
mod surface;
mod table;
mod touch;

pub use chart::MapSettings;
pub use error::GrazingError;
pub use expansion::{Expansion, ExpansionCurve};
pub use iterated::Iterated;
pub use iteration::Iteration;
pub use map::LocalMap;
pub use orbit::LocalOrbit;
pub use point::GrazingPoint;
pub use scenario::{Classification, Scenario};
pub use section::Coordinate;
