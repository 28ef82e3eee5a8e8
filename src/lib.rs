//! Numerical continuation: curves of zeros, the special points on them, and curves of those.
//!
//! # The mathematics
//!
//! A **zero problem** is a smooth map `F: ℝⁿ × ℝᵐ → ℝⁿ` of unknowns `z` and parameters `p`. With
//! all parameters held but one, and with `F_x = [F_z  F_p]` of full rank, the solutions of
//!
//! ```text
//!     F(z, p) = 0
//! ```
//!
//! form a curve, a **branch**. It is followed by its arclength, so that folds are points like
//! others. A **monitor** is a scalar of the solution. A **condition** is what holds at a **special
//! point**: that a monitor is at a level, or that a matrix is singular. A branch with its condition
//! determines the point; the condition alone, held while a second parameter is released, is a curve
//! of such points, traced like any other.
//!
//! A **boundary-value problem**, trajectories of vector fields with conditions at their ends,
//! becomes a zero problem by collocation or by shooting. **Periodic orbits** are the case
//! `x(1) = x(0)`; their multipliers decide stability, and period doublings and torus points are
//! conditions like the others.
//!
//! # The shortest example
//!
//! The parallel-plate actuator `u = load/(1 − u)²` pulls in at `u = 1/3`, `load = 4/27`. The
//! residual is stated once ([`zero_problem!`] writes a [`ZeroProblem`](core::problem::ZeroProblem)
//! over [`Scalar`](core::scalar::Scalar)s); derivatives of any order come from dual numbers.
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
//! # The map
//!
//! | module | holds |
//! |---|---|
//! | [`prelude`] | what a crate needs to state problems and follow their branches; [`zero_problem!`], [`vector_field!`] and [`hybrid_system!`] |
//! | [`core::problem`], [`core::scalar`] | what a user states: [`ZeroProblem`](core::problem::ZeroProblem)s, [`VectorField`](core::problem::VectorField)s, measures, names; the numbers that equations are evaluated on |
//! | [`core::system`], [`core::linalg`] | what continuation sees of a problem: [`System`](core::system::System), for any residual [`Dense`](core::system::Dense); bordered LU |
//! | [`core::bifurcation`] | conditions: levels, folds, branch points, Hopf points, cusps, Bogdanov–Takens points; stability |
//! | [`core::continuation`] | [`Continuation`](core::continuation::Continuation): steps, events, switching; [`Branch`](core::continuation::Branch)es as data |
//! | [`core::ode`], [`core::hybrid`] | flows in any scalar; [`HybridSystem`](core::hybrid::HybridSystem)s: modes, guards, resets, and their simulation |
//! | [`core::bvp`] | boundary-value problems ([`BoundaryProblem`](core::bvp::BoundaryProblem)) by collocation or shooting, as systems |
//! | [`core::orbit`], [`core::equilibrium`] | periodic orbits of a field, hybrid orbits by their itineraries, cycles of maps; equilibria of hybrid and Filippov systems |
//! | [`core::local_map`] | local maps near grazing orbits, their coefficients, scenarios and fixed points |
//! | [`core::attractor`], [`core::sweep`] | what motions settle on: cycles, exponents, crises; over grids, on all cores |
//! | [`problems`] | devices: [`plate`](problems::plate), the electrically actuated microplate, and [`mita`](problems::mita), the impact actuator; the literature's examples: [`classic`](problems::classic) |
//! | [`language`] | equations as text, and XPPAUT's files |
//! | [`output`] | [`Document`](output::Document)s in RON, tables, diagrams in SVG |
//! | [`scene`] | [`Scene`](scene::Scene)s: RON files that say what is traced and swept |
//! | [`spelling`] | the known name that was probably meant, in messages about unknown names |
//! | [`cli`] | the command line: [`cli::run`] is a whole program for any catalogue of problems |
//!
//! `core` knows no device and `output` no problem; `scene` joins them, and `cli` adds the command
//! line. How the core is put together, with pictures, is described in `docs/concepts/core.md`; periodic
//! orbits and boundary-value problems in `docs/concepts/orbits.md`; impacts in `docs/concepts/hybrid.md` and
//! `docs/concepts/grazing.md`; what motions settle on in `docs/concepts/sweeps.md`; equations as text in
//! `docs/reference/language.md`; what is done with files in `docs/reference/files.md`; which method to choose in
//! `docs/evidence/speed-and-accuracy.md`. The way in for users is the README.

#[cfg(feature = "cli")]
pub mod cli;
pub mod core;
#[cfg(feature = "scene")]
pub mod language;
#[cfg(feature = "scene")]
mod misread;
#[cfg(feature = "scene")]
pub mod output;
pub mod prelude;
pub mod problems;
#[cfg(feature = "scene")]
pub mod scene;
#[cfg(feature = "scene")]
pub mod spelling;

pub use num_dual;
#[cfg(feature = "scene")]
pub use scene::Catalogue;

/// The README's code, as documentation tests.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
pub struct Readme;

/// The code of `docs/concepts/core.md`, as documentation tests.
#[cfg(doctest)]
#[doc = include_str!("../docs/concepts/core.md")]
pub struct CoreNotes;

/// The code of `docs/concepts/orbits.md`, as documentation tests.
#[cfg(doctest)]
#[doc = include_str!("../docs/concepts/orbits.md")]
pub struct OrbitNotes;
