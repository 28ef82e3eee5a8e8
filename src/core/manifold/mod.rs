//! Stable and unstable manifolds of saddles of maps in the plane.
//!
//! A saddle of a map `f`, a fixed point or a cycle of `K` iterates, has a multiplier `λ` outside
//! the unit circle and a multiplier `μ` inside. Its unstable manifold `W^u` contains the points
//! whose preimages converge to the saddle, its stable manifold `W^s` the points whose images do.
//! Both are curves. With `g = f^K`, each is parametrised by a function `W` that conjugates `g` with
//! a linear map,
//!
//! ```text
//!     g(W(s)) = W(λ s),      W(0) = the saddle,      W'(0) = an eigenvector,
//! ```
//!
//! and likewise with `μ` (X. Cabré, E. Fontich and R. de la Llave, *J. Differential Equations*
//! 218:444, 2005). Near the saddle `W` is its Taylor polynomial of order 8, computed on jets.
//! Farther away, `W(s) = g^m(W(s/λ^m))` on `W^u`, and on `W^s` the `m`-th preimage, which Newton's
//! method finds near the preimages of the preceding point: every point is computed from the
//! polynomial, none is interpolated. Where the curve bends or stretches, points are inserted as by
//! D. Hobson (*J. Comput. Phys.* 104:14, 1993; also Z. You, E. J. Kostelich and J. A. Yorke, *Int.
//! J. Bifurcation and Chaos* 1:605, 1991, and B. Krauskopf and H. M. Osinga, *J. Comput. Phys.*
//! 146:404, 1998), with tangents from automatic differentiation in place of chords.
//!
//! Each half ends for a stated reason: the maximal arclength or number of points, a bound of a
//! state, a point to which the curve converges, a fold of the map (on `W^s`), or an image that is
//! not finite.

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
