//! The core of continuation, independent of applications: problems, flows, orbits and branches.
//!
//! | module | purpose |
//! |---|---|
//! | [`scalar`] | the numbers on which equations are evaluated: reals, dual numbers, jets |
//! | [`problem`] | models that users define: zero problems, vector fields, maps, their names and measures |
//! | [`system`] | the interface of zero problems to continuation, with dense or sparse matrices |
//! | [`linalg`] | linear algebra: bordered matrices, chains of intervals, Floquet multipliers |
//! | [`bifurcation`] | defining systems, test functions and normal forms of special points |
//! | [`continuation`] | branches: continuation steps, location of events, branch switching |
//! | [`ode`] | integration of vector fields |
//! | [`bvp`] | boundary-value problems by collocation or shooting |
//! | [`hybrid`] | hybrid and Filippov systems, and their simulation |
//! | [`orbit`] | periodic orbits of fields and hybrid systems, cycles of maps |
//! | [`equilibrium`] | equilibria of hybrid and Filippov systems |
//! | [`local_map`] | local maps near grazing orbits |
//! | [`manifold`] | stable and unstable manifolds of saddles of maps |
//! | [`attractor`] | attractors by simulation: cycles, Lyapunov exponents, crises |
//! | `sweep` (feature `scene`) | parameter sweeps: attractors over grids of parameters, on all cores |
//! | [`numerics`] | quadrature, interpolation, bracketed roots, zero sets in the plane |
//! | [`cancel`], [`failure`], [`spelling`] | cancellation of computations; errors of evaluations and solves; suggestions for unknown names |
//!
//! The comment of a numerical constant begins with the reason for its value: `Rounding` for bounds on rounding errors,
//! `Discretisation` for bounds on the errors of meshes and steps, and `Heuristic` for a choice that affects the cost or
//! the robustness of a method, but not the accuracy of its results.
//!
//! A user's problem is wrapped as a system, and branches of solutions of the system are computed:
//!
//! ```
//! use tangency::core::{continuation::Continuation, system::{Dense, Kind}};
//! tangency::zero_problem! {
//!     struct Parabola [x; a] { 0 = a - x * x; }
//! }
//! let mut system = Dense::new(Parabola);
//! let start = Continuation::new(&mut system).from(&[1.0]).at("a", 1.0);
//! let branch = start.along("a", -1.0..=1.0).trace()?;
//! let fold = branch.of_kind(Kind::LP).next().expect("the fold at a = 0");
//! assert!(fold.parameters[0].abs() < 1e-12 && fold.state[0].abs() < 1e-12);
//! # Ok::<(), tangency::core::continuation::TraceError>(())
//! ```

pub mod attractor;
pub mod bifurcation;
pub mod bvp;
pub mod cancel;
pub mod continuation;
pub mod equilibrium;
pub mod failure;
pub mod hybrid;
pub mod linalg;
pub mod local_map;
pub mod manifold;
pub mod numerics;
pub mod ode;
pub mod orbit;
pub mod problem;
pub mod scalar;
pub mod spelling;
#[cfg(feature = "scene")]
pub mod sweep;
pub mod system;
mod threads;
mod vectors;
