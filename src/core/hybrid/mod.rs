//! Hybrid systems: smooth motion in modes, interrupted by events.
//!
//! In each **mode** a state of the mode's own dimension follows a vector field, `x' = f_m(t, x, p)`. The mode
//! lasts while its **guards** are positive and ends where the first of them vanishes,
//!
//! ```text
//!     h_g(t, x, p) = 0,    falling,
//! ```
//!
//! at an **event**: a **reset** `x⁺ = r_g(t, x, p)` takes the state to that of the next mode. An impact is a
//! reset of velocity, sticking is a mode, and the end of sticking is a guard.
//!
//! A [`HybridFlow`] follows such motions from event to event. Guards are searched inside steps, so that a motion
//! that touches a surface and turns away is told from one that falls through it; of guards that vanish together
//! the one stated first counts, and the others at once after it, if they still fall. Where the events of one
//! guard accumulate (complete chatter), the motion goes on from their accumulation.

mod beyond;
mod chatter;
mod cycle_search;
mod erased;
mod error;
mod event;
mod fleet;
mod landing;
mod leg;
mod measured;
mod passage;
mod repetition;
mod scales;
mod settling;
mod simulation;
mod system;

pub use beyond::virtual_point;
pub use cycle_search::{Cycle, CycleLeg, CycleSearch, CycleSearchError};
pub use erased::{
    EventNumber, FieldNumber, GuardNumber, Guards, HybridEquations, MeasureNumber, Measures, Resets,
};
pub use error::{After, HybridError};
pub use event::{Event, History, HybridObserver, Piece};
pub use fleet::{Fleet, FleetObserver, Member};
pub use leg::{GuardOf, InMode, ScalarOf};
pub(in crate::core) use leg::{along, rate};
pub(crate) use measured::check_measures;
pub use passage::Passage;
pub(in crate::core) use repetition::{Repetition, distance, size};
pub use scales::Scales;
pub(crate) use scales::{guard_scale, time_scale};
pub use simulation::{HybridFlow, HybridSettings, HybridState, HybridStatistics};
pub use system::{Guard, HybridSystem, Mode};
