//! Simulates hybrid systems: smooth motion in modes, interrupted by events.
//!
//! In each **mode** a state of the mode's own dimension evolves along a vector field, `x' = f_m(t,
//! x, p)`, while the mode's **guards** `h_g(t, x, p)` are positive. When the first of the guards
//! falls to zero, an **event** occurs: a **reset** `x⁺ = r_g(t, x, p)` maps the state to a state of
//! the next mode. An impact is a reset of velocity; sticking is a mode (M. di Bernardo et al.,
//! *Piecewise-smooth Dynamical Systems*, 2008).
//!
//! A [`HybridFlow`] simulates the motion of a hybrid system from event to event. If several guards
//! vanish simultaneously, the event belongs to the guard that is defined first. If the events of
//! one guard accumulate (complete chatter), the motion continues from their accumulation.
//!
//! A ball that falls from a height of 1 and rebounds with 0.8 of its speed bounces first at `t = 1`
//! and comes to rest at `t = 9`, after infinitely many bounces:
//!
//! ```
//! use tangency::core::hybrid::{History, HybridFlow, HybridSettings, HybridState};
//! tangency::hybrid_system! {
//!     struct Ball [gravity] {
//!         mode flight [y, v] {
//!             d/dt y = v; d/dt v = -gravity;
//!             event bounce: y => flight { y, v: -v * 0.8 };
//!             accumulates to rest { y };
//!         }
//!         mode rest [y] { d/dt y = T::zero(); }
//!     }
//! }
//! let mut flow = HybridFlow::new(&Ball, HybridSettings::default())?;
//! let mut ball = HybridState { mode: 0, time: 0.0, x: vec![1.0, 0.0] };
//! let mut history = History::new(1);
//! flow.advance(&mut ball, 10.0, &[2.0], &mut history)?;
//! let [first, .., last] = &history.events[..] else { panic!("several events") };
//! assert!((first.time - 1.0).abs() < 1e-12 && (last.time - 9.0).abs() < 1e-9 && ball.mode == 1);
//! # Ok::<(), tangency::core::hybrid::HybridError>(())
//! ```

mod accumulated;
mod beyond;
mod chatter;
mod crowding;
mod cycle;
mod erased;
mod error;
mod event;
mod event_locator;
pub mod filippov;
mod fleet;
mod leg;
#[cfg(feature = "scene")]
mod observed;
mod passing;
mod periodicity;
mod scales;
mod simulation;
mod stated;
mod support;
mod system;
mod tangency;
mod timed;

pub(in crate::core) use accumulated::ChatterNumber;
pub use beyond::virtual_point;
pub use cycle::{Cycle, CycleLeg};
pub use erased::{EventNumber, HybridEquations};
pub(in crate::core) use erased::{FieldNumber, GuardNumber, MeasureNumber};
pub use error::HybridError;
pub use event::{Event, History, HybridObserver, Piece};
pub use fleet::{Fleet, FleetObserver, Member};
pub use leg::{GuardOf, InMode};
pub(in crate::core) use leg::{Moment, ScalarOf};
#[cfg(feature = "scene")]
pub(crate) use observed::observed_scales;
pub use periodicity::{NotPeriodic, check_period};
pub(crate) use scales::{decision_scale, guard_scale, time_scale};
pub use simulation::{HybridFlow, HybridSettings, HybridState, HybridStatistics};
#[doc(hidden)]
pub use stated::number_of;
pub use system::{Guard, HybridSystem, Mode, Passage, Scales, time_left};
pub use tangency::Tangency;
