//! Parameter sweeps: the attractors of motions over parameters and starts, on all cores.
//!
//! A [`Plan`] lists **runs**: one for each start and each point of a grid over parameters, or over
//! initial states. Each run is followed until its attractor is known
//! ([`AttractorSearch`](crate::core::attractor::AttractorSearch)). Runs start anew, or in the last
//! state of the preceding run, up or down the parameter; such chains of runs are **strands**, which
//! are independent of each other.
//!
//! The result of a run depends on its strand only: it is the same to the last bit for any number of
//! threads, whether or not the sweep was interrupted and resumed, and whether it was executed as a
//! whole or in [`Part`]s.

mod execute;
mod part;
mod plan;

pub use execute::{Found, Make, Visit, execute};
pub use part::Part;
pub(crate) use plan::MOST_RUNS;
pub(crate) use plan::spaced;
pub use plan::{Axis, Order, Plan, PlanError, Quantity};
