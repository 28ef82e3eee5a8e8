//! Continuation: stepping along curves of zeros, events on them, and branches as data.
//!
//! - **Statement**: `builder` (what a user states), `quantities` and `resolve` (names resolved),
//!   `start` (the start corrected) with `singular_start`, `trace` (from the statement to the
//!   branch).
//! - **Points**: `predictor`, `corrector`, `step_control` with `curve_error` and `branch_jump` (a step
//!   refused), `recorder` (monitors, stability, profiles), `curve_point`, `curve` (these together).
//! - **Events**: `event`, `detector` (test functions), `events_between`, `locate` with
//!   `defining_system`, `bracket`, `bisection` and `limit`, `describe`, `refiner` (finer
//!   discretisations), `double_crossing`; `separation` (the events of a step) with `unexplained`
//!   (changes of stability without an event) and `cluster` (several eigenvalues that pass).
//! - **Without a branch**: `root_search` (all solutions at given parameters).
//! - **Branches**: `steps` (the iterator), `half`, `bounds`, `closing`, `early_end`, `jump_end` and `progress`
//!   (where they end), `log` (labels), `stretches` (the solutions on both sides of a curve), `branch`,
//!   `slopes` and `stretch` (data).

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
mod metric;
mod newton;
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
mod start;
mod step_control;
mod steps;
mod stretch;
mod stretches;
mod trace;
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
