//! Sweeps: what motions settle on, over parameters and starts, on all cores.
//!
//! A [`Plan`] lists **runs**: one for each start and each point of a grid over parameters, or over
//! the states in which motion begins. Each run is followed until it is known what it settles on
//! ([`AttractorSearch`](crate::core::attractor::AttractorSearch)). Runs may begin anew, or go on
//! where the run before ended, up or down the parameter: **strands** of runs, which need not wait
//! for each other.
//!
//! What a run finds depends on its strand only: it is the same to the last bit whatever the number
//! of threads, whether or not the sweep was interrupted and resumed, and whether it was done at
//! once or in [`Part`]s.

mod execute;
mod part;
mod plan;

pub use execute::{Found, Make, Visit, execute};
pub use part::Part;
pub(crate) use plan::MOST_RUNS;
pub(crate) use plan::spaced;
pub use plan::{Axis, Order, Plan, PlanError, Quantity};
