//! Attractors by brute-force simulation.
//!
//! A motion sampled once a period is a map from state to state, `x ↦ F(x, p)`: the motion of a
//! hybrid system under a forcing ([`PeriodMap`]), or a discrete map; without forcing a motion is
//! sampled at an event ([`ReturnMap`]). All of these maps implement [`StroboscopicMap`].
//!
//! [`AttractorSearch`] follows such a map through a transient and records the periods after it. If
//! motion repeats, `F^q(x) ≈ x` with the same events, the periodic point is refined by Newton's
//! method with `M = ∂F^q/∂x`, whose eigenvalues are the multipliers `μ`. The largest Lyapunov
//! exponent, per period, is `ln max|μ| / q`, or, for a motion that is not periodic, the mean growth
//! of a tangent vector. All derivatives are computed by simulation on dual numbers; at events this
//! is equivalent to the saltation matrix.

mod crisis;
mod cycle_search;
mod error;
mod exponent;
mod period;
mod period_map;
mod repetition;
mod return_map;
mod search;
mod section;
mod slow_cycle;
mod stable_point;
mod stroboscopic;

pub use cycle_search::{CycleSearch, CycleSearchError};

pub use crisis::{Crisis, CrisisSearch};
pub use error::{CrisisSearchError, StroboscopicError};
pub use exponent::Exponent;
pub use period::{EventRecord, Layout, Period};
pub use period_map::PeriodMap;
pub use return_map::ReturnMap;
pub use search::{Attractor, AttractorSearch};
pub use stroboscopic::{EachPeriod, EachTangent, Outcomes, StroboscopicMap};
