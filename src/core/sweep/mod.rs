//! Parameter sweeps: computes the attractor for each combination of parameter values and initial
//! states, on all cores.
//!
//! A [`Plan`] lists **runs**: one run for each starting state and each point of a grid over
//! parameters or initial states. Each run is simulated until its attractor is known
//! ([`AttractorSearch`](crate::core::attractor::AttractorSearch)). Each run starts from the plan's
//! initial state, or from the last state of the run that precedes it in ascending or descending
//! order of the parameter; a chain of runs that depend on each other is a **strand**, and strands
//! are independent of each other.
//!
//! The result of a run depends only on the earlier runs of its strand: results are bit-identical
//! for any number of threads, whether or not the sweep was interrupted and resumed, and whether it
//! was executed as a whole or in [`Part`]s.
//!
//! [`execute`] computes the runs of a plan, as in this example:
//!
//! ```
//! use tangency::core::attractor::{AttractorSearch, PeriodMap};
//! use tangency::core::hybrid::{HybridSettings, HybridState};
//! use tangency::core::sweep::{Axis, Found, Order, Part, Plan, Quantity, execute};
//! use tangency::problems::classic::ImpactOscillator;
//! // Impacts per period under the forcing amplitudes 1, 3 and 5.
//! let starts = vec![HybridState { mode: 0, time: 0.0, x: vec![0.0, 0.0] }];
//! let axes = vec![Axis { quantity: Quantity::Parameter(0), low: 1.0, high: 5.0, count: 3 }];
//! let search = AttractorSearch::default();
//! let plan = Plan { axes, starts, order: Order::Anew, strands: 1, search, crisis: None };
//! let map = || PeriodMap::of(&ImpactOscillator, HybridSettings::default(), &[]);
//! let make = || Ok(Box::new(map()?) as _);
//! let mut impacts = [f64::NAN; 3];
//! let mut visit = |found: Found| impacts[found.run] = found.attractor.unwrap().count("impact");
//! execute(&plan, Part::WHOLE, &[1.0, 2.2, 0.8, 0.1, 1.0], &make, &|_| None, &mut visit)?;
//! assert_eq!(impacts, [0.0, 0.0, 1.0]);
//! # Ok::<(), tangency::core::sweep::PlanError>(())
//! ```

mod execute;
mod part;
mod plan;

pub use execute::{Found, Make, Visit, execute};
pub use part::Part;
pub(crate) use plan::MOST_RUNS;
pub(crate) use plan::spaced;
pub use plan::{Axis, Order, Plan, PlanError, Quantity};
