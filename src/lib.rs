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
//! form a curve, a **branch**. Continuation follows the branch by its arclength, so that a fold is a
//! regular point. A **monitor** is a scalar function of the solution. A **special point** is a
//! solution at which one more condition holds: a monitor has a given value, or a matrix is singular.
//! Such a condition is solved as a **defining system**. A branch with the condition determines the
//! special point; with the condition held and a second parameter released, the special points form a
//! curve, which is followed like any other.
//!
//! A **boundary-value problem** becomes a zero problem by collocation or by shooting. **Periodic
//! orbits** are boundary-value problems with `x(1) = x(0)`: their Floquet multipliers decide
//! stability, and period doublings and torus points are special points. A **hybrid orbit** is a
//! sequence of smooth legs with events and resets between them.
//!
//! # Three examples
//!
//! A zero problem: the parallel-plate actuator `u = load/(1 − u)²` pulls in at `u = 1/3`,
//! `load = 4/27`. The residual is written once ([`zero_problem!`] implements
//! [`ZeroProblem`](core::problem::ZeroProblem) for any [`Scalar`](core::scalar::Scalar)); dual
//! numbers give derivatives of every order.
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
//! Periodic orbits of a vector field: the Brusselator's equilibrium `x = 1`, `y = b` has a Hopf point
//! at `b = 2`, at which cycles of period 2π emanate.
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
//! let mut rest = Dense::new(Equilibria(Brusselator));
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
//! A model as text, with its request, as the command line has it: the fold of `x' = a − x²` at
//! `a = 0`.
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
//! | [`prelude`] | the imports of a crate that states problems and follows their branches, with [`zero_problem!`], [`vector_field!`] and [`hybrid_system!`] |
//! | [`core::problem`], [`core::scalar`] | statements by users: [`ZeroProblem`](core::problem::ZeroProblem)s, [`VectorField`](core::problem::VectorField)s, measures, names; the numbers on which equations are evaluated |
//! | [`core::system`], [`core::linalg`] | problems as continuation sees them: [`System`](core::system::System), [`Dense`](core::system::Dense) and [`Sparse`](core::system::Sparse); bordered matrices |
//! | [`core::bifurcation`] | defining systems and normal forms of special points; stability |
//! | [`core::continuation`] | [`Continuation`](core::continuation::Continuation): steps, events, switching; [`Branch`](core::continuation::Branch)es as data |
//! | [`core::ode`], [`core::hybrid`] | flows in any scalar; [`HybridSystem`](core::hybrid::HybridSystem)s with modes, guards and resets, and their simulation |
//! | [`core::bvp`] | boundary-value problems ([`BoundaryProblem`](core::bvp::BoundaryProblem)) by collocation or shooting |
//! | [`core::orbit`], [`core::equilibrium`] | periodic orbits of fields, hybrid orbits, cycles of maps; equilibria of hybrid and Filippov systems |
//! | [`core::local_map`] | local maps near grazing orbits: coefficients, scenarios, fixed points |
//! | [`core::manifold`] | stable and unstable manifolds of saddles of maps |
//! | [`core::attractor`], [`core::sweep`] | attractors: cycles, Lyapunov exponents, crises; sweeps over grids on all cores |
//! | [`problems`] | devices: [`plate`](problems::plate), the electrically actuated microplate, and [`mita`](problems::mita), the impact actuator; [`classic`](problems::classic) examples |
//! | [`language`] | equations as text, and XPPAUT's files |
//! | [`output`] | [`Document`](output::Document)s in RON, tables, figures |
//! | [`scene`] | [`Scene`](scene::Scene)s: RON files that state runs and sweeps |
//! | [`live`] | a server of a page on which diagrams follow changes of a scene |
//! | [`cli`] | the command line: [`cli::run`] is a whole program for any catalogue of problems |
//!
//! `core` does not depend on any device, nor `output` on any problem; `scene` joins them, and `cli` adds
//! the command line. The project's book (`docs` in the repository) has tutorials, the reference of
//! scenes and commands, the mathematics (`docs/concepts`), and measurements (`docs/evidence`).

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

/// Pages whose code is tested with the documentation.
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
