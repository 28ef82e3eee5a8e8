//! Finds the attractors of motions by simulation: cycles, chaos and crises.
//!
//! A motion sampled once a period is a map from state to state, `x ↦ F(x, p)`: the period map of a
//! hybrid system under a forcing ([`PeriodMap`]), or a discrete map. Without forcing, a motion is
//! sampled at the events of one guard ([`ReturnMap`]). Period maps, return maps and discrete maps
//! implement [`StroboscopicMap`].
//!
//! [`AttractorSearch`] iterates a stroboscopic map through a transient and records the periods
//! after the transient. If motion repeats, `F^q(x) ≈ x` with the same events, the periodic point is
//! refined by Newton's method with `M = ∂F^q/∂x`, whose eigenvalues are the multipliers `μ`. The
//! largest Lyapunov exponent per period of a cycle is `ln max|μ| / q`; the exponent of a motion
//! that is not periodic is the mean growth of a tangent vector (G. Benettin, L. Galgani, A.
//! Giorgilli and J.-M. Strelcyn, *Meccanica* 15:9, 1980). All derivatives are computed by
//! simulation on dual numbers; at events the result equals the product with the saltation matrix.
//!
//! ```
//! use tangency::core::attractor::{AttractorSearch, PeriodMap};
//! use tangency::core::hybrid::{HybridSettings, HybridState};
//! use tangency::problems::classic::ImpactOscillator;
//! // A forced mass near a stop settles on a cycle with one impact per forcing period.
//! let mut map = PeriodMap::of(&ImpactOscillator, HybridSettings::default(), &[])?;
//! let start = HybridState { mode: ImpactOscillator::FLIGHT, time: 0.0, x: vec![0.0, 0.0] };
//! let found = AttractorSearch::default().follow(&mut map, start, &[5.0, 2.2, 0.8, 0.1, 1.0])?;
//! assert_eq!((found.periods, found.count("impact")), (Some(1), 1.0));
//! // Restitution 0.8 and damping 0.1 over the period 2π/2.2 give the exponent ln 0.8 − 0.1·π/2.2.
//! let exact = 0.8_f64.ln() - 0.1 * std::f64::consts::PI / 2.2;
//! assert!((found.exponent.expect("an exponent").value - exact).abs() < 1e-9);
//! # Ok::<(), tangency::core::attractor::StroboscopicError>(())
//! ```

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
