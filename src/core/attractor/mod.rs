//! Attractors: what motions settle on, by brute force.
//!
//! A motion that is sampled once in every period is a map from state to state, `x ↦ F(x, p)`: the
//! motion of a hybrid system under a forcing ([`PeriodMap`]), or a map in itself; without forcing a
//! motion is sampled at an event ([`ReturnMap`]). All are a [`StroboscopicMap`].
//!
//! [`AttractorSearch`] follows it through a transient and records what comes then. Where motion
//! comes back, `F^q(x) ≈ x` with the same events, the periodic point is improved by Newton's method
//! with `M = ∂F^q/∂x`, whose eigenvalues are the multipliers `μ`. The largest Lyapunov exponent,
//! per period, is `ln max|μ| / q`, or of a motion that is not periodic the mean growth of a tangent
//! vector. All derivatives are those of the motion itself on dual numbers: at events they are
//! carried over as the saltation matrix would.

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
