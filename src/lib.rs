//! Numerical continuation: branches of solutions, their bifurcations, and curves of bifurcations.
//!
//! # The mathematics
//!
//! A **zero problem** is a smooth map `F: ℝⁿ × ℝᵐ → ℝⁿ` of unknowns `z` and parameters `p`. If one
//! parameter varies and `F_x = [F_z  F_p]` has full rank, the solutions of
//!
//! ```text
//!     F(z, p) = 0
//! ```
//!
//! form a curve, a **branch**. Continuation follows the branch by its arclength; in this
//! parametrisation, a fold is a regular point. A **monitor** is a scalar function of the solution.
//! A **special point** is a solution that satisfies one more condition: a monitor has a given
//! value, or a matrix is singular. A **defining system** is a set of equations that states such a
//! condition. The equations of the branch together with the defining system determine the special
//! point. If the equations of the defining system are kept and a second parameter is varied, the
//! special points form a curve, which is followed like a branch.
//!
//! A **boundary-value problem** becomes a zero problem by collocation or by shooting. **Periodic
//! orbits** are boundary-value problems with `x(1) = x(0)`: their Floquet multipliers decide
//! stability, and period doublings and torus points are special points. A **hybrid orbit** is a
//! sequence of smooth legs (parts of the orbit between two events), with events and resets between
//! them.
//!
//! # Three examples
//!
//! The first example is a zero problem: the parallel-plate actuator `u = load/(1 − u)²` pulls in at
//! `u = 1/3`, `load = 4/27`. The residual is written once: [`zero_problem!`] implements
//! [`ZeroProblem`](core::problem::ZeroProblem) for any [`Scalar`](core::scalar::Scalar) type, and
//! dual numbers give derivatives of every order.
//!
//! ```
//! use tangency::prelude::*;
//!
//! zero_problem! {
//!     struct ParallelPlate [u; load] { 0 = load / (T::one() - u).powi(2) - u; }
//! }
//!
//! let mut plate = Dense::new(ParallelPlate);
//! let branch = Continuation::new(&mut plate).along("load", 0.0..=1.0).trace()?;
//! let fold = branch.of_kind(Kind::LP).next().expect("a fold");
//! assert!((fold.parameters[0] - 4.0 / 27.0).abs() < 1e-14 && fold.error < 1e-13);
//! assert!((fold.state[0] - 1.0 / 3.0).abs() < 1e-12);
//! # Ok::<(), tangency::core::continuation::TraceError>(())
//! ```
//!
//! The second example computes periodic orbits of a vector field: the equilibrium `x = 1`, `y = b`
//! of the Brusselator has a Hopf point at `b = 2`, at which cycles of period 2π emanate.
//!
//! ```
//! use tangency::prelude::*;
//!
//! vector_field! {
//!     struct Brusselator [x, y; b] {
//!         let reaction = x * x * y;
//!         d/dt x = reaction - (b + 1.0) * x + 1.0;
//!         d/dt y = b * x - reaction;
//!     }
//! }
//!
//! let mut rest = Dense::new(Equilibria::new(Brusselator));
//! let rest =
//!     Continuation::new(&mut rest).from(&[1.0, 1.5]).at("b", 1.5).along("b", 1.5..=4.0).trace()?;
//! let hopf = rest.of_kind(Kind::HB).next().ok_or("no Hopf point")?;
//! assert!((hopf.parameters[0] - 2.0).abs() < 1e-12);
//!
//! let mut orbits = periodic_orbits(Brusselator, 20, Collocation::new(4)?)?;
//! let orbits = Continuation::new(&mut orbits)
//!     .restart(&rest, hopf.label)
//!     .along("b", 1.5..=4.0)
//!     .mark("b", 3.0)
//!     .trace()?;
//! let mark = orbits.of_kind(Kind::UZ).next().ok_or("no orbit at b = 3")?;
//! let period = mark.value(orbits.column("period").ok_or("no period")?).ok_or("no value")?;
//! assert!((period - 7.15691992118).abs() < 1e-10 && mark.unstable == Some(0));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! The third example is a model given as text, with its request, as on the command line: the fold
//! of `x' = a − x²` at `a = 0`.
//!
//! ```
//! use tangency::core::system::Kind;
//! use tangency::scene::{Scene, execute};
//! let scene = Scene::parse("Scene(
//!     title: \"A fold\",
//!     problem: Equations(
//!         states: [(\"x\", \"a - x^2\")], initial: [(\"x\", 1)], solution: equilibrium,
//!     ),
//!     parameters: [(\"a\", 1)],
//!     runs: [(name: \"rest\", along: [(name: \"a\", low: -1, high: 1)])],
//! )")?;
//! let document = execute(&scene, None, &mut ()).document;
//! let fold = document.branches[0].of_kind(Kind::LP).next().expect("a fold");
//! assert!(fold.parameters[0].abs() < 1e-12 && fold.converged);
//! # Ok::<(), tangency::scene::SceneError>(())
//! ```
//!
//! # The map
//!
//! | module | content |
//! |---|---|
//! | [`prelude`] | the imports for a crate that defines problems and computes their branches, including the macros [`zero_problem!`], [`vector_field!`] and [`hybrid_system!`] |
//! | [`core::problem`], [`core::scalar`] | the traits by which users define problems ([`ZeroProblem`](core::problem::ZeroProblem), [`VectorField`](core::problem::VectorField)), measures and names; the scalar types on which equations are evaluated |
//! | [`core::system`], [`core::linalg`] | the form in which continuation uses a problem ([`System`](core::system::System), with the implementations [`Dense`](core::system::Dense) and [`Sparse`](core::system::Sparse)); bordered matrices |
//! | [`core::bifurcation`] | defining systems and normal forms of special points; stability of solutions |
//! | [`core::continuation`] | [`Continuation`](core::continuation::Continuation) with steps, location of special points and branch switching; [`Branch`](core::continuation::Branch)es as data |
//! | [`core::ode`], [`core::hybrid`] | integration of vector fields in any scalar type; [`HybridSystem`](core::hybrid::HybridSystem)s with modes, guards and resets, and their simulation |
//! | [`core::bvp`] | boundary-value problems ([`BoundaryProblem`](core::bvp::BoundaryProblem)), solved by collocation or by shooting |
//! | [`core::orbit`], [`core::equilibrium`] | periodic orbits of vector fields, periodic orbits of hybrid systems, and cycles of maps; equilibria of hybrid and Filippov systems |
//! | [`core::local_map`] | local maps near grazing orbits: their coefficients, scenarios and fixed points |
//! | [`core::manifold`] | stable and unstable manifolds of saddles of maps |
//! | [`core::attractor`], [`core::sweep`] | attractors, with cycles, Lyapunov exponents and crises; sweeps over grids of parameters on all cores |
//! | [`problems`] | models of devices: the electrically actuated microplate ([`plate`](problems::plate)) and the impact actuator ([`mita`](problems::mita)); [`classic`](problems::classic) examples |
//! | [`language`] | equations given as text, and the conversion of XPPAUT files |
//! | [`output`] | [`Document`](output::Document)s in RON format, tables and figures |
//! | [`scene`] | [`Scene`](scene::Scene)s: RON files that state runs and sweeps |
//! | [`live`] | a web server whose page shows diagrams that follow changes of a scene |
//! | [`cli`] | the command line: [`cli::run`] is the whole program for any catalogue of problems |
//!
//! The module `core` does not depend on any device, and the module `output` does not depend on any
//! problem; `scene` combines `core`, `problems` and `output`, and `cli` adds the command line. The
//! project's book (`docs` in the repository) contains tutorials, the reference of scenes and
//! commands, the mathematics (`docs/concepts`), and measurements (`docs/evidence`).

#![cfg_attr(docsrs, feature(doc_cfg))]

#[cfg(feature = "cli")]
pub mod cli;
pub mod core;
#[cfg(feature = "scene")]
pub mod language;
#[cfg(feature = "live")]
pub mod live;
#[cfg(feature = "scene")]
mod misread;
#[cfg(feature = "scene")]
pub mod output;
pub mod prelude;
pub mod problems;
#[cfg(feature = "scene")]
pub mod scene;

pub use miette::Diagnostic;
pub use num_dual;
#[cfg(feature = "scene")]
pub use scene::Catalogue;

/// Pages whose code examples are tested together with the documentation.
#[cfg(doctest)]
mod pages {
    #[doc = include_str!("../README.md")]
    pub struct Readme;

    #[doc = include_str!("../docs/concepts/core.md")]
    pub struct Core;

    #[doc = include_str!("../docs/concepts/orbits.md")]
    pub struct Orbits;

    #[doc = include_str!("../docs/tutorials/device.md")]
    pub struct Device;

    #[doc = include_str!("../docs/how-to/regression.md")]
    pub struct Regression;

    #[doc = include_str!("../docs/how-to/plug-in.md")]
    pub struct PlugIn;
}
