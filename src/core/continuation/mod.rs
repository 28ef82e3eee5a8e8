//! Continuation of branches of solutions, and location of the special points on them.
//!
//! A [`Continuation`] specifies a curve; [`trace`](Continuation::trace) computes the curve by
//! pseudo-arclength continuation (H. B. Keller, *Numerical solution of bifurcation and nonlinear
//! eigenvalue problems*, 1977) and returns a [`Branch`] with its points and [`SpecialPoint`]s.
//!
//! ```
//! use tangency::prelude::*;
//! use tangency::problems::classic::ParallelPlate;
//! // `load/(1 − u)² = u`: marks the load 0.1, and finds the fold at `u = 1/3`, `load = 4/27`.
//! let mut plate = Dense::new(ParallelPlate);
//! let branch = Continuation::new(&mut plate).along("load", 0.0..=1.0).mark("load", 0.1).trace()?;
//! let mark = branch.of_kind(Kind::UZ).next().expect("a mark");
//! let fold = branch.of_kind(Kind::LP).next().expect("a fold");
//! assert!((mark.state[0] * (1.0 - mark.state[0]).powi(2) - 0.1).abs() < 1e-14);
//! assert!((fold.state[0] - 1.0 / 3.0).abs() < 1e-12);
//! assert!((fold.parameters[0] - 4.0 / 27.0).abs() < 1e-14);
//! # Ok::<(), tangency::core::continuation::TraceError>(())
//! ```
//!
//! # The files
//!
//! - **Specification of a curve**: `builder` (the user interface), `quantities` and `resolve`
//!   (resolution of names), `start` and `singular_start` (correction of the start), `trace`
//!   (computation of the specified branch).
//! - **Points**: `predictor`, `corrector`, `step_control`, `curve_error` and `branch_jump` (rejection
//!   of steps), `recorder` (monitors, stability, profiles), `curve_point`, `curve` (the combination of
//!   these modules).
//! - **Events**: `event`, `detector` (test functions), `events_between`, `locate` with
//!   `defining_system`, `bracket`, `bisection` and `limit`, `describe`, `refiner` (finer
//!   discretisations), `double_crossing` (two events in one step), `separation` (several events in
//!   one step), `unexplained` (changes of stability without an event), `cluster` (several
//!   eigenvalues that pass zero together) and `conservative` with `paired_multipliers` (families of cycles at one parameter value).
//! - **Solutions without continuation**: `root_search` (all solutions at given parameters).
//! - **Branches**: `steps` (the iterator over points), `half` (one half of a branch), `bounds`, `closing`,
//!   `early_end`, `snaking`, `jump_end` and `progress` (reasons for the end of a branch), `log` (labels),
//!   `stretches` (the solutions on both sides of a curve), `branch`, `slopes` and `stretch` (data).

mod admissible;
mod arnoldi;
mod beside;
mod bisection;
mod bounds;
mod bracket;
mod branch;
mod branch_jump;
mod builder;
mod closing;
mod cluster;
mod conservative;
mod corrector;
mod crossing;
mod curve;
mod curve_error;
mod curve_point;
mod defining_system;
mod describe;
mod detector;
mod double_crossing;
mod early_end;
mod end;
mod error;
mod event;
mod events_between;
mod extended;
mod fitting;
mod function;
mod half;
mod hermite;
mod homoclinic_end;
mod jump_end;
mod limit;
mod linear_range;
mod locate;
mod located;
mod locator;
mod log;
mod meaning;
mod mesh_check;
mod mesh_share;
mod mesh_target;
mod metric;
mod newton;
mod overshoot;
mod paired_multipliers;
mod persistence;
mod predictor;
mod progress;
mod quantities;
mod recorder;
mod refiner;
mod resolve;
mod root_search;
mod separation;
mod settings;
mod singular_start;
mod slopes;
mod snaking;
mod standstill;
mod start;
mod step_control;
mod steps;
mod stretch;
mod stretches;
mod trace;
mod turns;
mod unexplained;

pub use extended::{Closing, Extended};
pub use function::TestPoint;
pub use newton::{Convergence, Newton, NewtonError, Tolerances};

pub use branch::{Branch, Number, Point, Sensitivity, SpecialPoint, Traced};
pub use builder::Continuation;
pub use end::End;
pub use error::TraceError;
pub use event::{Direction, Event};
pub use metric::{Metric, StartSizes};
pub use root_search::{Root, RootSearch, Roots};
pub use settings::{SettingError, Settings};
pub use slopes::Slopes;
pub use steps::{Observer, Steps};
pub use stretch::Stretch;
