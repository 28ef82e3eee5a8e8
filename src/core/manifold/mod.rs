//! Stable and unstable manifolds of saddles of maps in the plane.
//!
//! A saddle of a map `f`, a fixed point or a cycle of `K` iterates, has a multiplier `λ` outside
//! the unit circle and a multiplier `μ` inside. The unstable manifold `W^u` of the saddle contains
//! the points whose preimages converge to the saddle; the stable manifold `W^s` contains the points
//! whose images converge to the saddle. Both manifolds are curves. With `g = f^K`, each manifold is
//! parametrised by a function `W` that conjugates `g` with a linear map:
//!
//! ```text
//!     g(W(s)) = W(λ s),      W(0) = the saddle,      W'(0) = an eigenvector
//! ```
//!
//! The equation for `W^s` contains `μ` instead of `λ` (X. Cabré, E. Fontich and R. de la Llave, *J.
//! Differential Equations* 218:444, 2005). Near the saddle, `W` is approximated by its Taylor
//! polynomial of order 8, computed with jets. Farther away, points of `W^u` are computed as `W(s) =
//! g^m(W(s/λ^m))`, and points of `W^s` as `m`-th preimages, which Newton's method finds near the
//! preimages of the preceding point. Every point is computed from the polynomial; no point is
//! interpolated. If the curve bends or stretches, points are inserted as in the algorithm of D.
//! Hobson (*J. Comput. Phys.* 104:14, 1993; also Z. You, E. J. Kostelich and J. A. Yorke, *Int. J.
//! Bifurcation and Chaos* 1:605, 1991, and B. Krauskopf and H. M. Osinga, *J. Comput. Phys.*
//! 146:404, 1998), with tangents from automatic differentiation instead of chords.
//!
//! Each half ends for one of these reasons, which is reported: the maximal arclength or number of
//! points, a bound of a state, a point to which the curve converges, a fold of the map (on `W^s`),
//! or an image that is not finite.

mod curve;
mod error;
mod growth;
mod invariance;
mod local;
mod planar;
mod preimage;
mod saddle;
mod settling;
mod statement;

pub use curve::Side;
pub use error::ManifoldError;
pub use growth::ARCLENGTH;
pub use statement::{Half, Manifold, ManifoldPoint, ManifoldSettings, manifold};
